"""Points of the search: where it stands, how it came there, and what it may do next."""

from collections.abc import Hashable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

from crow.evaluate import EvaluationError
from crow.search.code import Test
from crow.search.expressions import Environment
from crow.search.frames import Context, Frame
from crow.search.states import Snapshot

Trail = tuple[Any, Any, int] | None
"""What was done: the trail before, an event, and the number of events."""

Cuts = tuple[int, tuple[int, ...], Any] | None
"""For `commit`: the number of choices made before this section, which of those since stay open,
and the same for the sections around it."""


class Point(NamedTuple):
    """A state, the context of the body that runs, what is left to do, and the way here."""

    state: Snapshot
    context: Context | None
    frame: Frame | None
    trail: Trail
    cuts: Cuts

    def at(self, frame: Frame | None, context: Context | None) -> "Point":
        """The same state with other things to do."""
        return Point(self.state, context, frame, self.trail, self.cuts)

    def told(self, event: Any) -> "Point":
        """The same point with an event on its trail."""
        return Point(self.state, self.context, self.frame, extended(self.trail, event), self.cuts)

    @property
    def key(self) -> Hashable:
        """All that decides the future."""
        return self.state, self.context, self.frame


def extended(trail: Trail, event: Any) -> Trail:
    """A trail with one more event."""
    return trail, event, 1 if trail is None else trail[2] + 1


@dataclass(slots=True)
class Choice:
    """A point with several ways on, made when they are asked for."""

    point: Point
    options: Iterator[Point]


Step = Point | Choice | None
"""The next point, a choice, or a dead end."""


class Dead:
    """The dead end that came last: what failed, where, and in which state."""

    __slots__ = ("depth", "reason", "state", "test", "values")

    def __init__(self) -> None:
        self.depth = -1
        self.reason = ""
        self.test: Test | None = None
        self.values: Environment = ()
        self.state: Snapshot | None = None

    def note(self, point: Point, reason: str, test: Test, values: Environment) -> None:
        """Remember a dead end, if none was deeper."""
        depth = 0 if point.trail is None else point.trail[2]
        if depth > self.depth:
            self.depth, self.reason = depth, reason
            self.test, self.values, self.state = test, values, point.state


def holds(test: Test, state: Snapshot, values: Environment) -> bool:
    """Whether a condition is true; what has no value is not."""
    try:
        return bool(test.holds(state, values))
    except EvaluationError:
        return False
