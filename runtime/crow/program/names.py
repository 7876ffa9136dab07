"""Names that are not taken, and the names by which plans choose the values of `bind`s."""

from collections.abc import Collection

from crow.program.definitions import Behavior
from crow.program.statements import Bind
from crow.program.walk import statements_within


def fresh_name(name: str, taken: Collection[str]) -> str:
    """The name itself, or with the first number from 2 that makes it free: `y`, `y_2`, …"""
    candidate, number = name, 1
    while candidate in taken:
        number += 1
        candidate = f"{name}_{number}"
    return candidate


def named_binds(behavior: Behavior) -> tuple[tuple[Bind, tuple[str, ...]], ...]:
    """Each `bind` of a behavior in source order, with one name a variable.

    A variable that shadows a parameter or an earlier bind of the body gets a number, so that no two
    of one behavior have one name.
    """
    taken = {parameter.name for parameter in behavior.parameters}
    named = []
    for statement in statements_within(behavior.body):
        if isinstance(statement, Bind):
            names = []
            for variable in statement.variables:
                names.append(fresh_name(variable.name, taken))
                taken.add(names[-1])
            named.append((statement, tuple(names)))
    return tuple(named)
