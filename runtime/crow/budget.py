"""What a search may use: nodes, time and memory."""

import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from math import inf
from typing import Any, Final, TypeVar

Progress = Callable[[dict[str, Any]], None]
"""Called about ten times a second with statistics so far; what it raises ends the search."""

_SECONDS_A_LOOK: Final = 0.01
_SECONDS_A_MEMORY_LOOK: Final = 0.05
_SECONDS_A_REPORT: Final = 0.1


class Stopped(Exception):  # noqa: N818 - ends the search
    """A limit was reached: `reason` is nodes, time or memory."""

    def __init__(self, reason: str) -> None:
        super().__init__(reason)
        self.reason = reason


@dataclass(slots=True)
class Budget:
    """Limits, None for none: seconds of wall time, nodes, MiB of resident memory."""

    time_limit: float | None = None
    node_limit: int | None = None
    memory_limit_mb: int | None = None
    on_progress: Progress | None = None
    started: float = field(default_factory=time.monotonic)
    _most_nodes: float = inf
    _next_look: float = 0.0
    _next_memory_look: float = 0.0
    _reported: float = 0.0

    def __post_init__(self) -> None:
        if self.node_limit is not None:
            self._most_nodes = self.node_limit

    @property
    def seconds(self) -> float:
        """How long the search has run."""
        return time.monotonic() - self.started

    def check(self, nodes: int, statistics: Callable[[], dict[str, Any]]) -> None:
        """Raise Stopped if a limit is reached; report progress when it is due."""
        if nodes >= self._most_nodes:
            raise Stopped("nodes")
        if time.monotonic() < self._next_look:
            return
        self.look()
        seconds = self.seconds
        if self.on_progress is not None and seconds - self._reported >= _SECONDS_A_REPORT:
            self._reported = seconds
            self.on_progress(statistics())

    def look(self) -> None:
        """Raise Stopped if time or memory is used up; for what takes long within one node."""
        now = time.monotonic()
        if now < self._next_look:
            return
        self._next_look = now + _SECONDS_A_LOOK
        if self.time_limit is not None and now - self.started >= self.time_limit:
            self._stop("time", now)
        if self.memory_limit_mb is not None and now >= self._next_memory_look:
            self._next_memory_look = now + _SECONDS_A_MEMORY_LOOK
            if resident_mb() > self.memory_limit_mb:
                self._stop("memory", now)

    def _stop(self, reason: str, now: float) -> None:
        # Not again while this is on its way out: a timer may look at any time.
        self._next_look = now + 1
        raise Stopped(reason)

    def end(self) -> None:
        """Raise nothing any more: the search is over, and is only asked what it did."""
        self._next_look = self._most_nodes = inf

    @contextmanager
    def running(self) -> Iterator[None]:
        """Let `looking` look at this budget in what is called within."""
        token = _RUNNING.set(self)
        try:
            yield
        finally:
            _RUNNING.reset(token)


_RUNNING: ContextVar[Budget | None] = ContextVar("running", default=None)
_T = TypeVar("_T")


def looking(items: Iterable[_T], every: int = 1024) -> Iterator[_T]:
    """The items, with a look at the limits of the search that runs, if one does, now and then.

    For loops over products of objects, which may take longer than all the rest.
    """
    budget = _RUNNING.get()
    if budget is None:
        yield from items
        return
    for index, item in enumerate(items):
        if not index % every:
            budget.look()
        yield item


def look() -> None:
    """Look at the limits of the search that runs, if one does; raises Stopped as it would."""
    budget = _RUNNING.get()
    if budget is not None:
        budget.look()


def resident_mb() -> float:
    """How many MiB this process has resident; 0 where the system does not say.

    What the process has now: the most it ever had may be that of the process it came from.
    """
    try:
        with open("/proc/self/statm", encoding="ascii") as file:  # noqa: PTH123 - read often
            return int(file.read().split()[1]) * _page_mb()
    except (OSError, ValueError, IndexError):
        return _most_resident_mb()


def _page_mb() -> float:
    import resource

    return resource.getpagesize() / (1 << 20)


def _most_resident_mb() -> float:
    """The most that was resident, where there is no /proc."""
    import sys

    try:
        import resource
    except ImportError:
        return 0.0
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return most / (1 << 20) if sys.platform == "darwin" else most / 1024
