"""What several tests need: the repository's files, and `cdlc` run as a user runs it."""

import atexit
import json
import os
import subprocess
import sys
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).resolve().parent.parent
EXAMPLES = ROOT / "examples"
BLOCKS = EXAMPLES / "blocks"
_SECONDS = 120
"""The most that a command may take."""


@dataclass(frozen=True)
class Ran:
    """What a command left: its exit status and what it printed."""

    status: int
    out: str
    err: str


def cdlc(*arguments: str | Path, stdin: str | bytes = "", cwd: Path = ROOT) -> Ran:
    """Run the command line in a process of its own, a copy of one that has imported it."""
    data = stdin.encode() if isinstance(stdin, str) else stdin
    with TemporaryDirectory() as folder:
        files = {name: Path(folder, name) for name in ("stdin", "stdout", "stderr")}
        for file in files.values():
            file.write_bytes(data if file.name == "stdin" else b"")
        request = {
            "arguments": [*map(str, arguments)],
            "cwd": str(cwd),
            "environment": {**os.environ, "NO_COLOR": "1"},
            "timeout": _SECONDS,
            **{name: str(file) for name, file in files.items()},
        }
        template = _template()
        assert template.stdin is not None
        assert template.stdout is not None
        template.stdin.write(json.dumps(request) + "\n")
        template.stdin.flush()
        status: int | None = json.loads(template.stdout.readline())
        assert status is not None, f"more than {_SECONDS} s"
        out, err = (files[name].read_bytes().decode() for name in ("stdout", "stderr"))
        return Ran(status, out, err)


@cache
def _template() -> "subprocess.Popen[str]":
    command = [sys.executable, str(ROOT / "tests" / "template.py")]
    pipe = subprocess.PIPE
    process = subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True, encoding="utf-8")
    atexit.register(_end, process)
    return process


def _end(process: "subprocess.Popen[str]") -> None:
    assert process.stdout is not None
    process.stdout.close()
    process.communicate()
