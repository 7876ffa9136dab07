"""Why a search found nothing: what failed, and what of it farthest on the way to the goal."""

from collections.abc import Mapping

from crow.evaluate import shown_cell
from crow.program import Read, Variable
from crow.program.expressions import Expression, Object
from crow.program.walk import subexpressions
from crow.search.code import Test
from crow.search.expressions import names_of
from crow.search.machine import Machine
from crow.search.points import Point
from crow.text import expression_text
from crow.values import Value

_MOST_FACTS = 8


def explanation(machine: Machine) -> str | None:
    """The condition that failed farthest on the way, and the facts it reads.

    The goal, where nothing had failed yet; None where nothing was begun.
    """
    dead = machine.dead
    if dead.test is None and machine.goals:  # not compiled again: that may take its time
        start = Point(machine.store.initial, None, None, None, None)
        dead.note(start, "it has not become true so far", machine.goals[-1].test, ())
    if dead.test is None or dead.point is None:
        return None
    condition = dead.test.condition
    names = names_of(dead.test.slots, dead.values)
    where = f" at {dead.test.location}" if dead.test.location is not None else ""
    given = ", ".join(f"{name} = {value}" for name, value in variables_in(condition, names).items())
    with_ = f" with {given}" if given else ""
    text = f"`{expression_text(condition)}`{where}{with_}: {dead.reason}"
    facts = ", ".join(facts_at(machine, dead.point, dead.test, names))
    return f"{text}; there, {facts}" if facts else text


def variables_in(condition: Expression, names: Mapping[str, Value]) -> dict[str, Value]:
    """The variables that a condition reads and that have a value."""
    return {p.name: names[p.name] for p in subexpressions(condition)
            if isinstance(p, Variable) and p.name in names}  # fmt: skip


def facts_at(
    machine: Machine, point: Point, test: Test, names: Mapping[str, Value]
) -> tuple[str, ...]:
    """The values of the cells that a condition reads by name, at a point; not too many."""
    facts: dict[str, None] = {}
    for part in subexpressions(test.condition):
        if isinstance(part, Read):
            known = [_known(a, names) for a in part.arguments]
            if None not in known:
                cell = (part.feature, tuple(str(argument) for argument in known))
                value = point.state.cells.get(cell, machine.store.defaults[part.feature])
                facts[f"{shown_cell(cell)} is {value}"] = None
    return tuple(facts)[:_MOST_FACTS]


def _known(argument: Expression, names: Mapping[str, Value]) -> Value:
    match argument:
        case Object(name=name):
            return name
        case Variable(name=name):
            return names.get(name)
        case _:
            return None
