"""A limit of memory for this process, so that even one huge allocation fails as MemoryError."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Final

from crow.budget import resident_mb

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


def _data_bytes() -> int:
    """How much data this process has by now, touched or not; 0 where the system does not say."""
    try:
        with open("/proc/self/statm", encoding="ascii") as file:  # noqa: PTH123 - read often
            pages = int(file.read().split()[5])
    except (OSError, IndexError, ValueError):
        return 0
    import resource

    return pages * resource.getpagesize()
