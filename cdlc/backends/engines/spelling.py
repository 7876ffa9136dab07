"""Gives a plan back the spelling of the task: PDDL readers and planners lower every name."""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from cdlc.backends.engines.result import PddlStep

_COMMENT = re.compile(r";[^\n]*")
_ACTION = re.compile(r"\(\s*:action\s+([^\s()]+)", re.IGNORECASE)
_OBJECTS = re.compile(r"\(\s*:(?:objects|constants)\b((?:[^()]|\([^()]*\))*)\)", re.IGNORECASE)
_TYPE = re.compile(r"\s-\s*(?:\([^()]*\)|[^\s()]+)")


@dataclass(frozen=True, slots=True)
class Spelling:
    """The declared spelling of each action's and each object's lower-case name."""

    actions: Mapping[str, str]
    objects: Mapping[str, str]

    @classmethod
    def of(cls, domain: str, problem: str) -> "Spelling":
        """Read the declarations of a task's two PDDL texts."""
        texts = [_COMMENT.sub("", text) for text in (domain, problem)]
        return cls(
            _by_lower_case(name for text in texts for name in _ACTION.findall(text)),
            _by_lower_case(name for text in texts for name in _declared_objects(text)),
        )

    def step(self, action: str, arguments: Iterable[str]) -> PddlStep:
        """Spell one step as the task does; a name that the task does not declare stays."""
        return PddlStep(
            self.actions.get(action.lower(), action),
            tuple(self.objects.get(argument.lower(), argument) for argument in arguments),
        )


def _declared_objects(text: str) -> Iterator[str]:
    for section in _OBJECTS.findall(text):
        yield from _TYPE.sub(" ", section).split()


def _by_lower_case(names: Iterable[str]) -> dict[str, str]:
    return {name.lower(): name for name in names}
