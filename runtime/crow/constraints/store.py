"""What is known of unknowns and what is still asked of them, never changed in place.

A store made from another one shares what both have. What an unknown occurs in is found by the
unknown, so that a value given to it costs what it leads to.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from crow.constraints.constraint import Conflict, Constraint
from crow.constraints.knowledge import Knowledge
from crow.constraints.layered import Layered
from crow.constraints.pairing import Pairing
from crow.constraints.terms import Open
from crow.program import ObjectType
from crow.program.types import BOOL, underlying
from crow.unknowns import Unknown
from crow.values import Value

if TYPE_CHECKING:
    from crow.constraints.python import Python
    from crow.problem import World

_STRUCTURED = frozenset(("and", "or", "not", "xor", "if"))


@dataclass(frozen=True, slots=True, eq=False)
class Requirement:
    """A term that has to be true, or false where it is not wanted: a part of a constraint.

    `parents` are unknowns whose values have made it a part that is required.
    """

    number: int
    term: Open
    is_wanted: bool
    unknowns: tuple[Unknown, ...]
    source: Constraint
    parents: tuple[Unknown, ...] = ()
    pairings: tuple[Pairing, ...] = ()

    @property
    def is_structured(self) -> bool:
        """Whether one value may decide it, or a part of it."""
        term = self.term
        return term.operator in _STRUCTURED or any(
            type(o) is Open and o.operator == "vector" for o in term.operands
        )

    @property
    def is_discrete(self) -> bool:
        """Whether all that it depends on has few values."""
        return all(is_discrete(unknown) for unknown in self.unknowns)


@dataclass(frozen=True, slots=True, eq=False)
class Bounds:
    """What is required of an integer: where it lies, and the requirements that say so."""

    low: int | None = None
    high: int | None = None
    low_by: Requirement | None = None
    high_by: Requirement | None = None

    @property
    def by(self) -> tuple[Requirement, ...]:
        """The requirements behind it."""
        return tuple(r for r in (self.low_by, self.high_by) if r is not None)


def is_discrete(unknown: Unknown) -> bool:
    """Whether an unknown is a truth value or an object."""
    return isinstance(unknown.type, ObjectType) or underlying(unknown.type) == BOOL


@dataclass(frozen=True, slots=True, eq=False)
class Store:
    """Values of unknowns, and the constraints that are open (App. B).

    `values` has what was given and what follows from it. `pending` are requirements with how many
    of their unknowns have no value; `ready` are those for which a generator can be asked; `given`
    are all constraints there ever were, `mentioned` all unknowns in them.
    """

    knowledge: Knowledge
    values: Layered[Unknown, Value] = field(default_factory=Layered)
    origins: Layered[Unknown, tuple[Requirement, ...]] = field(default_factory=Layered)
    masks: Layered[Unknown, int] = field(default_factory=Layered)
    pending: Layered[Requirement, int] = field(default_factory=Layered)
    structured: Layered[Requirement, None] = field(default_factory=Layered)
    discrete: Layered[Requirement, None] = field(default_factory=Layered)
    ready: Layered[Requirement, None] = field(default_factory=Layered)
    occurrences: Layered[Unknown, tuple[Requirement, ...]] = field(default_factory=Layered)
    bounds: Layered[Unknown, Bounds] = field(default_factory=Layered)
    given: Layered[Constraint, None] = field(default_factory=Layered)
    mentioned: Layered[Unknown, None] = field(default_factory=Layered)
    count: int = 0

    @staticmethod
    def of(world: "World", python: "Python | None" = None) -> "Store":
        """The store in which nothing is known; `python` is that of the world, if not given."""
        return Store(Knowledge(world, python))

    @property
    def open(self) -> tuple[Constraint, ...]:
        """The constraints that are not decided yet, in the order in which they came."""
        requirements = sorted(self.pending, key=lambda r: r.number)
        return tuple({r.source: None for r in requirements})

    def having(self, *constraints: Constraint) -> "Store | Conflict":
        """The store with some more constraints, and what follows from them.

        Raises crow.FunctionError for Python that fails.
        """
        return self._after(constraints, {})

    def assigned(self, unknown: Unknown, value: Value) -> "Store | Conflict":
        """The store with a value for an unknown, and what follows from it; errors as `having`."""
        return self._after((), {unknown: value})

    def _after(
        self, constraints: tuple[Constraint, ...], values: Mapping[Unknown, Value]
    ) -> "Store | Conflict":
        from crow.constraints.core import conflict_of
        from crow.constraints.propagation import Clash, Propagation

        run = Propagation(self)
        try:
            for constraint in constraints:
                run.take(constraint)
            for unknown, value in values.items():
                run.choose(unknown, value)
            return run.finished()
        except Clash as clash:
            return conflict_of(clash)
