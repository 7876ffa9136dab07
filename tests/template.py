"""A process that has imported `cdlc`, and runs it in copies of itself: `support.cdlc` starts it.

A run is asked for with a line of JSON on standard input, and answered with a line: the exit status,
or null if it took too long. A copy ends as `python -m cdlc` does, with all that happens at exit.
"""

import gc
import json
import os
import sys
import time
from typing import Any

import cdlc.__main__ as command_line
import cdlc.cli  # noqa: F401 - this and the next are what commands import first
import crow.search.strategies
import crow.search.tree  # noqa: F401

FILES = (("stdin", os.O_RDONLY), ("stdout", os.O_WRONLY), ("stderr", os.O_WRONLY))
"""What the standard streams of a run are: files that are there."""


def main() -> int:
    """Answer requests until there are none; in a copy, the status of its run."""
    gc.freeze()
    for line in sys.stdin:
        request = json.loads(line)
        child = os.fork()
        if not child:
            return run(request)
        sys.stdout.write(json.dumps(status_of(child, request["timeout"])) + "\n")
        sys.stdout.flush()
    return 0


def run(request: dict[str, Any]) -> int:
    """Become `python -m cdlc` with the arguments, files, folder and environment of a request."""
    for number, (name, flags) in enumerate(FILES):
        file = os.open(request[name], flags)
        os.dup2(file, number)
        os.close(file)
    sys.stdin = open(0, encoding="utf-8", closefd=False)  # noqa: SIM115 - with a buffer of its own
    os.environ.clear()
    os.environ.update(request["environment"])
    os.chdir(request["cwd"])
    sys.path[0] = request["cwd"]
    sys.argv = [str(command_line.__file__), *request["arguments"]]
    sys.modules["__main__"] = command_line  # which processes that are started afresh import
    return command_line.main()


def status_of(child: int, seconds: float) -> int | None:
    """The exit status of a copy, which is killed if it takes too long."""
    deadline, pause = time.monotonic() + seconds, 0.001
    while time.monotonic() < deadline:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            return os.waitstatus_to_exitcode(status)
        time.sleep(pause)
        pause = min(0.02, pause * 1.5)
    os.kill(child, 9)
    os.waitpid(child, 0)
    return None


if __name__ == "__main__":
    sys.exit(main())
