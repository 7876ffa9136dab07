"""Why a search found nothing: what failed farthest on the way to the goal."""

from typing import Any

from crow.evaluate import shown_cell
from crow.program import Read, Variable
from crow.program.expressions import Expression, Object
from crow.program.walk import subexpressions
from crow.search.expressions import names_of
from crow.search.machine import Machine
from crow.text import expression_text

_MOST_FACTS = 8


def explanation(machine: Machine) -> str | None:
    """The condition that failed farthest on the way, and the facts it reads.

    The goal, where nothing had failed yet; None where nothing was begun.
    """
    dead = machine.dead
    if dead.test is None or dead.state is None:
        goal = machine.programs.goal(machine.problem.goal)[1]
        dead.note(machine.start(), "it has not become true so far", goal, ())
    if dead.test is None or dead.state is None:
        return None
    condition = dead.test.condition
    names = names_of(dead.test.slots, dead.values)
    where = f" at {dead.test.location}" if dead.test.location is not None else ""
    used = {p.name: names[p.name] for p in subexpressions(condition)
            if isinstance(p, Variable) and p.name in names}  # fmt: skip
    given = ", ".join(f"{name} = {value}" for name, value in used.items())
    with_ = f" with {given}" if given else ""
    text = f"`{expression_text(condition)}`{where}{with_}: {dead.reason}"
    facts = _facts(machine, condition, names)
    return f"{text}; there, {facts}" if facts else text


def _facts(machine: Machine, condition: Expression, names: dict[str, Any]) -> str:
    """The values of the cells that a condition reads by name."""
    state = machine.dead.state
    assert state is not None
    facts: dict[str, None] = {}
    for part in subexpressions(condition):
        if isinstance(part, Read):
            known = [_known(a, names) for a in part.arguments]
            if None not in known:
                cell = (part.feature, tuple(known))
                value = state.cells.get(cell, machine.store.defaults[part.feature])
                facts[f"{shown_cell(cell)} is {value}"] = None
    return ", ".join(list(facts)[:_MOST_FACTS])


def _known(argument: Expression, names: dict[str, Any]) -> Any:
    match argument:
        case Object(name=name):
            return name
        case Variable(name=name):
            return names.get(name)
        case _:
            return None
