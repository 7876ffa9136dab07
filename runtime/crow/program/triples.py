"""The Hoare model of a program: what its behaviors need and change, as formulas (App. D.5).

The compiler computes it; a compiled program carries it, so that a planner can go from goals back to
behaviors and look at what a behavior reads and writes without running it. Its formulas share parts:
walk over them as graphs.
"""

from dataclasses import dataclass

from crow.program.expressions import Expression, Parameter
from crow.program.location import Location
from crow.program.statements import Do


@dataclass(frozen=True, slots=True, eq=False)
class Update:
    """`feature[arguments] := value` where `guard` holds, for all `variables`.

    Everything reads the state before. `variables` are variables of the formulas, unlike any other
    name. `sources` are the statements that wrote the value, and those whose writes they changed.
    `is_limited` says that simplifying it was given up for its size.
    """

    feature: str
    arguments: tuple[Expression, ...]
    value: Expression
    guard: Expression
    variables: tuple[Expression, ...] = ()
    location: Location | None = None
    sources: tuple[Location, ...] = ()
    is_limited: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Conflict:
    """Two iterations of a `foreach` that may write one cell: when, and where both stand.

    `condition` is over the state before and over the variables of both iterations, `variables`;
    where it holds, the values differ.
    """

    condition: Expression
    variables: tuple[Expression, ...]
    first: Update
    second: Update


@dataclass(frozen=True, slots=True, eq=False)
class Triple:
    """A transition: `parameters` are the behavior's followed by its object binds.

    `pre` is a list of conjuncts. In `post`, everything reads the state before, and where two
    updates meet in one cell the later one wins. `conflicts` are what a `foreach` may do wrong.
    `reasons` are the statements behind each conjunct of `pre`; `limited` are the positions of those
    whose simplification was given up for their size.
    """

    behavior: str
    parameters: tuple[Parameter, ...]
    goal: Expression | None
    calls: tuple[Do, ...]
    pre: tuple[Expression, ...]
    post: tuple[Update, ...]
    conflicts: tuple[Conflict, ...] = ()
    location: Location | None = None
    reasons: tuple[tuple[Location, ...], ...] = ()
    limited: frozenset[int] = frozenset()


@dataclass(frozen=True, slots=True, eq=False)
class Unmodelled:
    """A behavior with an effect that is no single transition, and the construct that keeps it."""

    behavior: str
    construct: str
    location: Location | None = None


@dataclass(frozen=True, slots=True, eq=False)
class HoareModel:
    """The triples of a program in source order; `level` is how far they are simplified."""

    level: str
    triples: tuple[Triple, ...]
    unmodelled: tuple[Unmodelled, ...] = ()
