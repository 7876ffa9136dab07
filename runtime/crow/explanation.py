"""What kept a plan from being found, in words: a condition, where it stands, and what it reads."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from crow.evaluate import shown_cell
from crow.problem import Cell, Problem
from crow.program import Expression, Location, Object, Read, Variable
from crow.program.walk import subexpressions
from crow.text import expression_text
from crow.unknowns import has_unknown
from crow.values import Value, default_value

NOT_YET: Final = "it has not become true so far"
"""What is wrong with the goal, where nothing else is known to have failed."""

_MOST_FACTS = 8


@dataclass(frozen=True, slots=True)
class Obstacle:
    """A condition that failed, the values of its variables, and the cells as they were there."""

    condition: Expression
    variables: Mapping[str, Value]
    location: Location | None
    reason: str
    cells: Mapping[Cell, object]

    def text(self, problem: Problem) -> str:
        """`on(x, y)` at blocks.cdl:3:4 with x = a, y = b: it is false here; there, …"""
        where = "" if self.location is None else f" at {self.location}"
        used = [f"{name} = {value}" for name, value in self.used().items()]
        given = f" with {', '.join(used)}" if used else ""
        told = f"`{expression_text(self.condition)}`{where}{given}: {self.reason}"
        facts = self.facts(problem)
        return f"{told}; there, {', '.join(facts)}" if facts else told

    def used(self) -> dict[str, Value]:
        """The variables that the condition reads and that have a value."""
        names = (p.name for p in subexpressions(self.condition) if isinstance(p, Variable))
        values = ((n, self.variables[n]) for n in names if n in self.variables)
        return {name: value for name, value in values if not has_unknown(value)}

    def facts(self, problem: Problem) -> list[str]:
        """The values of the cells that the condition reads by name; not too many."""
        facts: dict[str, None] = {}
        for part in subexpressions(self.condition):
            if isinstance(part, Read):
                known = [self._known(argument) for argument in part.arguments]
                if None not in known:
                    cell = (part.feature, tuple(map(str, known)))
                    unset = default_value(problem.world.features[part.feature].type)
                    value = self.cells.get(cell, unset)
                    shown = "not set" if value is None else value
                    facts[f"{shown_cell(cell)} is {shown}"] = None
        return list(facts)[:_MOST_FACTS]

    def _known(self, argument: Expression) -> Value | None:
        match argument:
            case Object(name=name):
                return name
            case Variable(name=name):
                return self.variables.get(name)
            case _:
                return None


def at_the_start(problem: Problem) -> Obstacle:
    """The goal, where nothing else is known to have failed."""
    goal = problem.goal
    return Obstacle(goal, {}, goal.location, NOT_YET, problem.initial.cells)
