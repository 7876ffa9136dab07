"""CDL names to PDDL names: kept, unless PDDL does not take them, and back."""

import re
from collections.abc import Iterable
from dataclasses import dataclass, field

from crow.program.definitions import DefinitionNode

# What readers take for a connective, an effect or a built-in where a name is meant. Other words of
# PDDL, `at` and `over` among them, are ordinary names to every reader tried.
_WORDS = """
    and or not imply forall exists when either preference assign increase decrease object number
    define undefined oneof always sometime within total-cost
"""
_RESERVED = frozenset(_WORDS.split())


@dataclass(slots=True)
class Names:
    """The names of one task. PDDL ignores case, so names that differ only in it are kept apart.

    Types, predicates, actions and objects share one space here, because some readers demand it.
    """

    _by_origin: dict[tuple[str, str], str] = field(default_factory=dict)
    _origins: dict[str, tuple[str, str]] = field(default_factory=dict)

    def add(self, kind: str, name: str, wanted: str | None = None) -> str:
        """The PDDL name of a thing of some kind, chosen when it is first asked for.

        `wanted` is what it was called in the PDDL it was imported from.
        """
        key = (kind, name)
        if key not in self._by_origin:
            chosen = _free(legal_name(wanted or name), {*self._origins, *_RESERVED})
            self._by_origin[key] = chosen
            self._origins[chosen.lower()] = key
        return self._by_origin[key]

    def get(self, kind: str, name: str) -> str:
        """The PDDL name of a thing that was added."""
        return self._by_origin[kind, name]

    def has(self, kind: str, name: str | None = None) -> bool:
        """Whether a thing, or any thing of that kind, was added."""
        return any(k == kind and name in (None, n) for k, n in self._by_origin)

    def is_free(self, name: str) -> bool:
        """Whether a name stands for nothing yet."""
        return name.lower() not in self._origins

    def origin(self, kind: str, name: str) -> str | None:
        """The CDL name behind the PDDL name, in any case, of a thing of some kind."""
        found, origin = self._origins.get(name.lower(), ("", None))
        return origin if found == kind else None

    def changed(self) -> list[tuple[str, str]]:
        """Pairs of CDL name and PDDL name that differ, in order of their appearance."""
        # Names that CDL cannot write are ours.
        pairs = ((name, pddl) for (_, name), pddl in self._by_origin.items())
        return [(name, pddl) for name, pddl in pairs if name != pddl and "'" not in name]


def variable_name(name: str, taken: Iterable[str]) -> str:
    """The PDDL name, without its question mark, of a variable beside others."""
    return _free(legal_name(name), {other.lower() for other in taken})


def _free(name: str, taken: set[str]) -> str:
    """The name, or with the first number from 2 that makes it free; `taken` are in lower case."""
    candidate, number = name, 1
    while candidate.lower() in taken:
        number += 1
        candidate = f"{name}-{number}"
    return candidate


def legal_name(name: str) -> str:
    """The nearest name that PDDL allows: a letter, then letters, digits, `-` and `_`."""
    plain = re.sub(r"[^A-Za-z0-9_-]+", "-", name).strip("-")
    return plain if plain[:1].isalpha() else f"n{plain}"


def imported_name(definition: DefinitionNode) -> str | None:
    """What a definition was called in PDDL, `[[pddl="on-table"]]`, if it was imported."""
    for annotation in definition.annotations:
        if annotation.name == "pddl" and isinstance(annotation.value, str):
            return annotation.value
    return None
