"""Limits of this process: what a search cannot notice by itself, it is made to notice."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Final

from crow.budget import resident_mb

_SECONDS_A_LOOK: Final = 0.05
_SLACK_MB: Final = 32
"""A search that looks at its memory now and then is to find out first."""


@contextmanager
def limited_memory(most_mb: int) -> Iterator[None]:
    """Let the data of this process grow to so many MiB of resident memory, and not far beyond.

    Nothing is limited where the system has no such limit.
    """
    try:
        import resource
    except ImportError:
        yield
        return
    before = resource.getrlimit(resource.RLIMIT_DATA)
    most = _data_bytes() + int((max(0.0, most_mb - resident_mb()) + _SLACK_MB) * (1 << 20))
    if before[1] != resource.RLIM_INFINITY:
        most = min(most, before[1])
    with suppress(OSError, ValueError):
        resource.setrlimit(resource.RLIMIT_DATA, (most, before[1]))
    try:
        yield
    finally:
        with suppress(OSError, ValueError):
            resource.setrlimit(resource.RLIMIT_DATA, before)


@contextmanager
def timer(look: Callable[[], None]) -> Iterator[None]:
    """Look at limits many times a second, whatever runs: what `look` raises is raised there.

    Nothing happens where the system has no timers, or off the main thread.
    """
    is_main = threading.current_thread() is threading.main_thread()
    if not is_main or not hasattr(signal, "setitimer"):
        yield
        return
    before = signal.signal(signal.SIGALRM, lambda *_: look())
    signal.setitimer(signal.ITIMER_REAL, _SECONDS_A_LOOK, _SECONDS_A_LOOK)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def _data_bytes() -> int:
    """How much data this process has by now, touched or not; 0 where the system does not say."""
    try:
        with open("/proc/self/statm", encoding="ascii") as file:  # noqa: PTH123 - read often
            pages = int(file.read().split()[5])
    except (OSError, IndexError, ValueError):
        return 0
    import resource

    return pages * resource.getpagesize()
