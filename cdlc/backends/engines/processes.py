"""Finds and ends the processes of one run, wherever the engine put them.

unified-planning starts a planner in a new session and planners start processes of their own, so
neither process groups nor the tree under the worker hold them all once one in the middle has died.
They all inherit the environment, though, and so a variable in it that only this run has.
"""

import os
import time
from contextlib import suppress
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator

    import psutil

MARK: Final = "CDLC_ENGINE_RUN"


def kill_run(mark: str, *, seconds: float = 2.0) -> None:
    """Kill every process whose environment has `MARK` set to `mark`, and its descendants.

    Returns when none is left (zombies do not count) or after `seconds`; never kills the caller.
    """
    import psutil  # an optional dependency, and slow to import

    deadline = time.monotonic() + seconds
    while (found := set(_processes(mark))) and time.monotonic() < deadline:
        for process in found:
            with suppress(psutil.Error):
                process.kill()
        time.sleep(0.01)


def _processes(mark: str) -> "Iterator[psutil.Process]":
    import psutil

    for pid in psutil.pids():
        with suppress(psutil.Error, OSError):
            process = psutil.Process(pid)
            if pid != os.getpid() and process.environ().get(MARK) == mark:
                yield process
                yield from process.children(recursive=True)
