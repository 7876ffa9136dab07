"""CDL names for PDDL names: kept where CDL has them, else changed as little as possible."""

import re
from collections.abc import Iterable
from dataclasses import dataclass, field

from cdlc.frontend.facts import NOT_NAMES
from cdlc.frontend.scope import BUILTIN_FUNCTIONS
from cdlc.frontend.syntax import Annotation, Literal, Name
from cdlc.source import Span

NOWHERE = Span(0, 0)
_TYPES = frozenset(
    ("object", "bool", "int32", "int64", "float32", "float64", "string", "vector", "pyobject")
)


@dataclass(slots=True)
class Naming:
    """Types have names of their own; all other definitions and objects share one space."""

    _types: dict[str, str] = field(default_factory=dict)
    _values: dict[tuple[str, str], str] = field(default_factory=dict)
    _taken: set[str] = field(default_factory=lambda: {*NOT_NAMES, *BUILTIN_FUNCTIONS, "range"})

    def type(self, name: str) -> str:
        """The CDL name of a type."""
        if name == "object":
            return name
        if name not in self._types:
            taken = {*self._types.values(), *_TYPES, *NOT_NAMES}
            self._types[name] = _free(_legal(name), taken)
        return self._types[name]

    def value(self, kind: str, name: str) -> str:
        """The CDL name of a predicate, function, action or object."""
        key = (kind, name)
        if key not in self._values:
            self._values[key] = self.claim(name)
        return self._values[key]

    def claim(self, name: str) -> str:
        """A name that nothing else has."""
        chosen = _free(_legal(name), self._taken)
        self._taken.add(chosen)
        return chosen

    def variables(self, names: Iterable[str]) -> dict[str, str]:
        """Names for the variables of one action, which hide no definition.

        What follows an apostrophe only tells variables apart.
        """
        chosen: dict[str, str] = {}
        for name in names:
            taken = {*self._taken, *chosen.values()}
            chosen[name] = _free(_legal(name.removeprefix("?").partition("'")[0]), taken)
        return chosen


def annotations(pddl: str, name: str, *, always: bool = False) -> tuple[Annotation, ...]:
    """`[[pddl="on-table"]]` for a name that was changed, or always."""
    if pddl == name and not always:
        return ()
    key = Name("pddl", span=NOWHERE)
    return (Annotation(key, Literal(pddl, span=NOWHERE), span=NOWHERE),)


def _legal(name: str) -> str:
    plain = re.sub(r"[^A-Za-z0-9_]", "_", name)
    return plain if re.match(r"[A-Za-z_]", plain) else f"n{plain}"


def _free(name: str, taken: Iterable[str]) -> str:
    candidate, number = name, 1
    while candidate in taken:
        number += 1
        candidate = f"{name}_{number}"
    return candidate
