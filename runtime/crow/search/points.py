"""Points of the search: where it stands, how it came there, and what it may do next."""

from collections.abc import Hashable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

from crow.constraints import Constraint, Store
from crow.evaluate import EvaluationError
from crow.problem import State
from crow.search.code import Test
from crow.search.expressions import Environment, names_of
from crow.search.frames import Context, Frame
from crow.search.states import Snapshot
from crow.unknowns import Touched

DRAWS: Final = 32
"""A generator may yield more values."""
GENERATOR: Final = 64
"""A generator ended that may leave values out."""
SOLVER: Final = 128
"""A branch was cut because the solver of constraints does not cover it."""


@dataclass(frozen=True, slots=True, eq=False)
class Known:
    """What is known on a way of values that have to be found: constraints, and what was decided."""

    store: Store
    decided: Mapping[Hashable, bool]

    @property
    def open(self) -> bool:
        """Whether any value is still to be found."""
        return bool(self.store.pending)


Trail = tuple[Any, Any, int] | None
"""What was done: the trail before, an event, and the number of events."""

Cuts = tuple[int, tuple[int, ...], Any] | None
"""For `commit`: the number of choices made before this section, which of those since stay open,
and the same for the sections around it."""


class Point(NamedTuple):
    """A state, the context of the body that runs, what is left to do, and the way here.

    `constraints` are what is known of the variables that have no value yet, if there were any.
    """

    state: Snapshot
    context: Context | None
    frame: Frame | None
    trail: Trail
    cuts: Cuts
    constraints: "Known | None" = None

    def at(self, frame: Frame | None, context: Context | None) -> "Point":
        """The same state with other things to do."""
        return Point(self.state, context, frame, self.trail, self.cuts, self.constraints)

    def told(self, event: Any) -> "Point":
        """The same point with an event on its trail."""
        return self.with_trail(extended(self.trail, event))

    def noted(self, event: Any) -> "Point":
        """The same point with an event on its trail that does not count: nothing was done."""
        return self.with_trail((self.trail, event, 0 if self.trail is None else self.trail[2]))

    def with_trail(self, trail: Trail) -> "Point":
        """The same point, reached in another way."""
        return Point(self.state, self.context, self.frame, trail, self.cuts, self.constraints)

    @property
    def key(self) -> Hashable:
        """All that decides the future."""
        if self.constraints is None or not self.constraints.open:
            return self.state, self.context, self.frame
        return self.state, self.context, self.frame, self.constraints


def extended(trail: Trail, event: Any) -> Trail:
    """A trail with one more event."""
    return trail, event, 1 if trail is None else trail[2] + 1


@dataclass(slots=True)
class Choice:
    """A point with several ways on, made when they are asked for."""

    point: Point
    options: Iterator[Point]


Cause = tuple[Any, Environment]
"""What a behavior is applied for, a condition or a call, and the values of its variables."""

Step = Point | Choice | None
"""The next point, a choice, or a dead end."""


@dataclass(slots=True)
class Failures:
    """How often a condition failed for a kind of reason, and where farthest on the way."""

    count: int
    depth: int
    point: Point
    values: Environment
    reason: str


class Dead:
    """Dead ends: the one farthest on the way, and how many there were of each kind.

    As many are kept as there are conditions in the program, each with one point.
    """

    __slots__ = ("depth", "failures", "point", "reason", "test", "values")

    def __init__(self) -> None:
        self.depth = -1
        self.reason = ""
        self.test: Test | None = None
        self.values: Environment = ()
        self.point: Point | None = None
        self.failures: dict[tuple[Test, str], Failures] = {}

    def note(
        self, point: Point, reason: str, test: Test, values: Environment, kind: str = ""
    ) -> None:
        """Remember a dead end; as the farthest, if none was farther.

        Reasons that read otherwise each time have a `kind` under which they are counted.
        """
        depth = 0 if point.trail is None else point.trail[2]
        found = self.failures.get((test, kind or reason))
        if found is None:
            self.failures[test, kind or reason] = Failures(1, depth, point, values, reason)
        else:
            found.count += 1
            if depth > found.depth:
                found.depth, found.point, found.values = depth, point, values
                found.reason = reason
        if depth > self.depth:
            self.depth, self.reason = depth, reason
            self.test, self.values, self.point = test, values, point


class Undecided(Exception):  # noqa: N818 - says where the search has to choose
    """Whether a condition is true depends on values that are not known.

    `key` is what its answer is kept under.
    """

    def __init__(self, constraint: Constraint, key: Hashable) -> None:
        super().__init__()
        self.constraint = constraint
        self.key = key


def holds(test: Test, state: Snapshot, values: Environment) -> bool:
    """Whether a condition is true; what has no value is not. Raises Undecided."""
    try:
        return is_true(test, state, values)
    except EvaluationError:
        return False


def is_true(test: Test, state: Snapshot, values: Environment) -> bool:
    """Whether a condition is true. Raises EvaluationError and Undecided."""
    try:
        return bool(test.holds(state, values))
    except Touched:
        key = (test, tuple(values), state)
        known = state.store.decided.get(key)
        if known is None:
            raise Undecided(constraint_of(test, state, values), key) from None
        return known


def constraint_of(test: Test, state: Snapshot, values: Environment) -> Constraint:
    """A condition as a constraint on the values that are not known, in its own time step."""
    names = names_of(test.slots, values)
    return Constraint(test.condition, names, State(state.cells), location=test.location)
