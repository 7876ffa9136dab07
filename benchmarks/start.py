"""How long a command takes to start: CPU of whole processes, beside what it cannot do without."""

import os
import resource
import statistics
import subprocess
import sys
from pathlib import Path

from benchmarks.table import Table

_ROOT = Path(__file__).resolve().parent.parent
_BLOCKS = _ROOT / "examples" / "blocks" / "blocks.cdl"
_COMMANDS = {
    "import argparse, lark": [sys.executable, "-c", "import argparse, lark"],
    "cdlc check blocks.cdl": [sys.executable, "-m", "cdlc", "check", str(_BLOCKS)],
    "cdlc compile --emit pddl": [
        sys.executable, "-m", "cdlc", "compile", str(_BLOCKS), "--emit", "pddl",
    ],
}  # fmt: skip


def run(quick: bool) -> Table:
    """Median CPU seconds of each command, their runs interleaved, and the ratio to the first."""
    runs = 5 if quick else 21
    for command in _COMMANDS.values():  # fill the caches of bytecode and grammar tables
        _cpu_seconds(command)
    seconds: dict[str, list[float]] = {name: [] for name in _COMMANDS}
    for _ in range(runs):
        for name, command in _COMMANDS.items():
            seconds[name].append(_cpu_seconds(command))
    base = statistics.median(next(iter(seconds.values())))
    rows = tuple(
        (name, statistics.median(s), min(s), max(s), statistics.median(s) / base)
        for name, s in seconds.items()
    )
    columns = ("process", "median CPU s", "min", "max", "ratio")
    return Table("start", columns, rows, "target: check at most 3 times the first")


def _cpu_seconds(command: list[str]) -> float:
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    # An installed package has its bytecode, as lark does here; a checkout gets it by running once.
    env = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    subprocess.run(command, check=True, cwd=_ROOT, env=env, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return (after.ru_utime - before.ru_utime) + (after.ru_stime - before.ru_stime)
