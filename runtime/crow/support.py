"""What a program needs that the planner does not have: named with its place, before any search."""

from collections.abc import Collection
from dataclasses import dataclass

from crow.conditions import plain
from crow.program import (
    Apply,
    Behavior,
    Bind,
    Location,
    ObjectType,
    Program,
    Variable,
)
from crow.program.walk import expressions_of, statements_within, subexpressions


@dataclass(frozen=True, slots=True)
class Unsupported:
    """A construct that planning over objects does not cover."""

    construct: str
    location: Location | None


def unsupported(program: Program, given: Collection[str] = ()) -> Unsupported | None:
    """The first construct of a program that its planner would have to choose values for.

    Of the external functions, those are covered whose Python is `given`.
    """
    for behavior in program.behaviors:
        if (found := _value_parameter(behavior) or _value_bind(behavior)) is not None:
            return found
    external = {f.name for f in program.functions if f.body is None and f.name not in given}
    bodies = [s for b in program.behaviors for s in (*b.body, *(b.effect or ()))]
    bodies += [s for c in program.controllers for s in c.effect or ()]
    bodies += [s for f in program.functions for s in f.body or ()]
    for statement in statements_within(bodies):
        for expression in expressions_of(statement):
            for part in subexpressions(expression):
                if isinstance(part, Apply) and part.function in external:
                    return Unsupported(
                        f"the external function `{part.function}`, whose Python is not given",
                        part.location,
                    )
    return None


def _value_parameter(behavior: Behavior) -> Unsupported | None:
    """A parameter that only a solver of constraints could choose."""
    if behavior.goal is None:
        return None
    parts = subexpressions(plain(behavior.goal))
    mentioned = {part.name for part in parts if isinstance(part, Variable)}
    for parameter in behavior.parameters:
        if not isinstance(parameter.type, ObjectType) and parameter.name not in mentioned:
            construct = f"the parameter `{parameter.name}`, a value that the goal does not mention"
            return Unsupported(construct, parameter.location)
    return None


def _value_bind(behavior: Behavior) -> Unsupported | None:
    for statement in statements_within(behavior.body):
        if isinstance(statement, Bind):
            for variable in statement.variables:
                if not isinstance(variable.type, ObjectType):
                    construct = f"`bind {variable.name}` of type `{variable.type}`"
                    return Unsupported(construct, statement.location)
    return None
