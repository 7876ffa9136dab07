"""What a search may use: nodes, time and memory."""

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

Progress = Callable[[dict[str, Any]], None]
"""Called about ten times a second with statistics so far; what it raises ends the search."""

_CHECKS_A_LOOK = 128
_SECONDS_A_REPORT = 0.1


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
    _checks: int = 0
    _reported: float = 0.0

    @property
    def seconds(self) -> float:
        """How long the search has run."""
        return time.monotonic() - self.started

    def check(self, nodes: int, statistics: Callable[[], dict[str, Any]]) -> None:
        """Raise Stopped if a limit is reached; report progress when it is due."""
        if self.node_limit is not None and nodes >= self.node_limit:
            raise Stopped("nodes")
        self._checks += 1
        if self._checks % _CHECKS_A_LOOK:
            return
        seconds = self.seconds
        if self.time_limit is not None and seconds >= self.time_limit:
            raise Stopped("time")
        if self.memory_limit_mb is not None and _resident_mb() > self.memory_limit_mb:
            raise Stopped("memory")
        if self.on_progress is not None and seconds - self._reported >= _SECONDS_A_REPORT:
            self._reported = seconds
            self.on_progress(statistics())


def _resident_mb() -> float:
    """The most memory that the process has had resident; 0 where the system does not say."""
    try:
        import resource
    except ImportError:
        return 0.0
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return most / (1 << 20) if sys.platform == "darwin" else most / 1024
