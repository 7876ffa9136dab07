"""CDL names to PDDL names: kept, unless PDDL does not take them, and back."""

import re
from dataclasses import dataclass, field

_KEYWORDS = """
    define domain problem requirements types constants predicates functions action parameters
    precondition effect objects init goal metric minimize maximize total-cost total-time
    and or not imply forall exists when either assign increase decrease scale-up scale-down
    object number derived axiom durative-action preference
"""
_RESERVED = frozenset(_KEYWORDS.split())


@dataclass(slots=True)
class Names:
    """The names of one task. PDDL ignores case, so names that differ only in it are kept apart.

    Types, predicates, actions and objects share one space here, because some readers demand it.
    """

    _by_origin: dict[tuple[str, str], str] = field(default_factory=dict)
    _origins: dict[str, str] = field(default_factory=dict)

    def add(self, kind: str, name: str) -> str:
        """The PDDL name of a thing of some kind, chosen when it is first asked for."""
        key = (kind, name)
        if key not in self._by_origin:
            chosen = self._choose(name)
            self._by_origin[key] = chosen
            self._origins[chosen.lower()] = name
        return self._by_origin[key]

    def get(self, kind: str, name: str) -> str:
        """The PDDL name of a thing that was added."""
        return self._by_origin[kind, name]

    def has(self, kind: str, name: str) -> bool:
        """Whether a thing was added."""
        return (kind, name) in self._by_origin

    def origin(self, name: str) -> str | None:
        """The CDL name behind a PDDL name in any case."""
        return self._origins.get(name.lower())

    def changed(self) -> list[tuple[str, str]]:
        """Pairs of CDL name and PDDL name that differ, in order of their appearance."""
        return [(name, pddl) for (_, name), pddl in self._by_origin.items() if name != pddl]

    def _choose(self, name: str) -> str:
        legal = legal_name(name)
        candidate, number = legal, 1
        while candidate.lower() in self._origins or candidate.lower() in _RESERVED:
            number += 1
            candidate = f"{legal}-{number}"
        return candidate


def legal_name(name: str) -> str:
    """The nearest name that PDDL allows: a letter, then letters, digits, `-` and `_`."""
    plain = re.sub(r"[^A-Za-z0-9_-]+", "-", name).strip("-")
    return plain if plain[:1].isalpha() else f"n{plain}"
