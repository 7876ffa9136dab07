"""The replayer: a state and a trace, item by item, to ok or the first failing item (§2.2).

It is kept apart from every search so that it cannot share a mistake with one.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from crow.evaluate import EvaluationError, changes, holds
from crow.plan import call_text
from crow.problem import Cell, Problem, State, World
from crow.program import Expression, Location
from crow.text import expression_text
from crow.trace import AssertItem, DoItem, EffItem, Trace, TraceItem
from crow.values import Value


@dataclass(frozen=True, slots=True)
class Failure:
    """The first item that does not hold: its position in the trace, and why."""

    index: int
    condition: str
    reason: str
    location: Location | None


@dataclass(frozen=True, slots=True)
class Replay:
    """The projected state after each item that was reached, and the failure, if there was one."""

    states: tuple[State, ...]
    failure: Failure | None

    @property
    def is_sound(self) -> bool:
        """Whether every item held."""
        return self.failure is None

    @property
    def final(self) -> State:
        """The last projected state."""
        return self.states[-1]


def replay(world: World, initial: State, trace: Trace, *, keeps_states: bool = True) -> Replay:
    """Run a trace from a state.

    Returns the projected states, the initial one first, up to the first item that fails; unless it
    `keeps_states`, the first and the last, in time linear in the trace, however large a state is.
    """
    states, cells = [initial], dict(initial.cells)
    now, failure = State(cells), None
    for index, item in enumerate(trace):
        try:
            changed = _changed(world, now, item, trace[index + 1 : index + 2])
        except _Failed as failed:
            failure = Failure(index, _item_text(item), failed.reason, failed.location)
            break
        for cell, value in changed.items():
            if value == world.defaults[cell[0]]:
                cells.pop(cell, None)
            else:
                cells[cell] = value
        if keeps_states:
            states.append(State(dict(cells)) if changed else states[-1])
    if not keeps_states:
        states.append(now)
    return Replay(tuple(states), failure)


class _Failed(Exception):  # noqa: N818 - ends the walk over the trace
    def __init__(self, reason: str, location: Location | None) -> None:
        super().__init__()
        self.reason = reason
        self.location = location


def _changed(
    world: World, state: State, item: TraceItem, following: Trace
) -> Mapping[Cell, object]:
    """What an item changes; a controller with an effect needs it right after its `do`."""
    try:
        match item:
            case AssertItem(condition=condition, variables=variables):
                if not holds(world, state, condition, variables):
                    raise _Failed("it is false here", item.location)
                return {}
            case EffItem(statements=statements, variables=variables):
                return changes(world, state.cells, statements, variables)
            case DoItem():
                if not _has_its_effect(world, item, following):
                    raise _Failed("its effect does not follow", item.location)
                return {}
    except EvaluationError as error:
        raise _Failed(str(error), error.location or item.location) from None


def _has_its_effect(world: World, item: DoItem, following: Trace) -> bool:
    controller = world.controllers[item.controller]
    if controller.effect is None:
        return True
    match following:
        case (EffItem(owner=controller.name, variables=variables),):
            names = [parameter.name for parameter in controller.parameters]
            return [variables.get(name) for name in names] == list(item.arguments)
        case _:
            return False


def _item_text(item: TraceItem) -> str:
    match item:
        case AssertItem(text=text):
            return text
        case DoItem(controller=name, arguments=arguments):
            return f"do {call_text(name, arguments, {})}"
        case EffItem(owner=owner):
            return f"eff of {owner}"


def replay_to_goal(problem: Problem, trace: Trace, *, keeps_states: bool = True) -> Replay:
    """Run a trace from the initial state, as `replay` does, and test the goal after it."""
    items = (*trace, goal_item(problem.goal))
    return replay(problem.world, problem.initial, items, keeps_states=keeps_states)


def goal_item(goal: Expression, variables: dict[str, Value] | None = None) -> AssertItem:
    """The assertion of the goal that ends every trace."""
    return AssertItem(goal, variables or {}, expression_text(goal), location=goal.location)
