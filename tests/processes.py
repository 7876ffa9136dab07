"""Processes as Linux shows them: which there are below one, and whether they have gone."""

import time
from collections.abc import Collection
from pathlib import Path


def below(process: int) -> set[int]:
    """The processes below one."""
    found: set[int] = set()
    waiting = [process]
    while waiting:
        for tasks in Path(f"/proc/{waiting.pop()}/task").glob("*/children"):
            own = {int(pid) for pid in tasks.read_text().split()}
            found |= own
            waiting += own
    return found


def is_running(process: int) -> bool:
    try:
        status = Path(f"/proc/{process}/stat").read_text()
    except OSError:
        return False
    return status.rsplit(")", 1)[1].split()[0] != "Z"


def assert_gone(processes: Collection[int], seconds: float = 10) -> None:
    """Fails unless processes have ended, or do so soon."""
    deadline = time.monotonic() + seconds
    while any(map(is_running, processes)):
        assert time.monotonic() < deadline
        time.sleep(0.05)
