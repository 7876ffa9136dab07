"""Constraints: conditions of a program with their variables and the state of their time step."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from crow.problem import State
from crow.program import Expression, Location
from crow.text import expression_text
from crow.unknowns import Unknown
from crow.values import Value


@dataclass(frozen=True, slots=True, eq=False)
class Constraint:
    """A condition that has to be true, or false where it is not wanted (App. B).

    `state` is the snapshot of its own time step, whose cells may hold unknowns, as `variables` may.
    `defined` makes it a definition, `f_t(o) = g(…)` of App. B: `condition` is then a value, and the
    unknown has it as a cell of its type would.
    """

    condition: Expression
    variables: Mapping[str, Value]
    state: State
    is_wanted: bool = True
    location: Location | None = None
    defined: Unknown | None = None

    @property
    def place(self) -> Location | None:
        """Where it stands in the source."""
        return self.location or self.condition.location

    @property
    def text(self) -> str:
        """What it says, in CDL."""
        text = expression_text(self.condition)
        if self.defined is not None:
            return f"{self.defined.name} == {text}"
        return text if self.is_wanted else f"not ({text})"

    def __str__(self) -> str:
        return f"`{self.text}`" if self.place is None else f"{self.place}: `{self.text}`"


Core = tuple[tuple[Constraint, ...], Mapping[Unknown, Value]]
"""Constraints, and values that were chosen, which do not go together."""


class Conflict:
    """Constraints that cannot be true together; `reason` says how that shows.

    Which they are is found out when it is asked: a search meets many conflicts, and tells few.
    """

    __slots__ = ("_find", "_found", "reason")

    def __init__(self, reason: str, find: Callable[[], Core]) -> None:
        self.reason = reason
        self._find: Callable[[], Core] | None = find
        self._found: Core = ((), {})

    def _core(self) -> Core:
        if self._find is not None:
            self._found = self._find()
            self._find = None
        return self._found

    @property
    def core(self) -> tuple[Constraint, ...]:
        """The constraints, in the order in which they came; each is needed, as far as was tried."""
        return self._core()[0]

    @property
    def values(self) -> Mapping[Unknown, Value]:
        """The values that were given to unknowns by choice, not computed, and that it rests on."""
        return self._core()[1]

    def __str__(self) -> str:
        lines = [self.reason, *map(str, self.core)]
        lines += [f"with {u.name} = {value!r}" for u, value in self.values.items()]
        return "\n".join(lines)
