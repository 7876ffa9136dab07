"""What a program needs that the planner does not have: named with its place, before any search."""

from collections.abc import Collection
from dataclasses import dataclass
from typing import Final

from crow.conditions import plain
from crow.program import (
    Apply,
    Behavior,
    Bind,
    Location,
    ObjectType,
    Parameter,
    Program,
    Variable,
)
from crow.program.walk import expressions_of, statements_within, subexpressions

OF_OBJECTS: Final = ("best", "reference")
"""Engines that choose objects alone, and no values."""


@dataclass(frozen=True, slots=True)
class Unsupported:
    """A construct that planning over objects does not cover.

    `function` is the external function whose Python is not given, if it is that.
    """

    construct: str
    location: Location | None
    function: str | None = None


def unsupported(program: Program, given: Collection[str] = ()) -> Unsupported | None:
    """The first construct of a program that no engine covers.

    Of the external functions, those are covered whose Python is `given`.
    """
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
                        part.function,
                    )
    return None


def chosen_value(program: Program) -> Unsupported | None:
    """The first place where a value has to be chosen, which only engines that draw values cover."""
    for behavior in program.behaviors:
        for parameter in open_parameters(behavior):
            construct = f"the parameter `{parameter.name}`, a value that the goal does not mention"
            return Unsupported(construct, parameter.location)
        for statement in statements_within(behavior.body):
            if isinstance(statement, Bind):
                for variable in statement.variables:
                    if not isinstance(variable.type, ObjectType):
                        construct = f"`bind {variable.name}` of type `{variable.type}`"
                        return Unsupported(construct, statement.location)
    return None


def open_parameters(behavior: Behavior) -> tuple[Parameter, ...]:
    """The value parameters that the goal of a behavior does not mention: its body binds them."""
    if behavior.goal is None:
        return ()
    parts = subexpressions(plain(behavior.goal))
    mentioned = {part.name for part in parts if isinstance(part, Variable)}
    return tuple(
        p
        for p in behavior.parameters
        if not isinstance(p.type, ObjectType) and p.name not in mentioned
    )
