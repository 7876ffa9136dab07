"""A finished point of the search as steps and a trace."""

from collections.abc import Sequence
from typing import Any, cast

from crow.plan import Step
from crow.problem import World
from crow.search.code import Code, DoOp, Test
from crow.search.expressions import names_of
from crow.search.frames import Application, Context
from crow.search.machine import Machine
from crow.search.points import Point
from crow.search.substitution import Substitution
from crow.trace import AssertItem, DoItem, EffItem, Trace, TraceItem
from crow.unknowns import has_unknown
from crow.values import Value

Call = tuple[int, DoOp, tuple[Value, ...]]
"""The number of a step, its controller and the arguments."""


def assert_item(test: Test, values: Sequence[Value]) -> AssertItem:
    """An assertion as it stands in a trace."""
    known = names_of(test.slots, values)
    return AssertItem(test.condition, known, test.text, test.location)


def events_of(machine: Machine, point: Point) -> list[Any]:
    """What was done on the way to a point, from the beginning, with the values that were found."""
    events, trail = [], point.trail
    while trail is not None:
        trail, event, _ = trail
        events.append(event)
    events.reverse()
    if point.constraints is None:
        return events
    found = Substitution(machine.shared, point.constraints.store.values)
    return [found.of(event) for event in events]


def plan_of(machine: Machine, point: Point) -> tuple[tuple[Step, ...], Trace]:
    """The steps and the trace that lead to a point, which its machine keeps as the last found."""
    machine.finished = point
    world, events = machine.problem.world, events_of(machine, point)
    trace = tuple(item for number in in_order(events) for item in items_of(world, events[number]))
    return _steps(events), trace


def in_order(events: list[Any]) -> list[int]:
    """The numbers of the events as a trace has them: L of members of M at the start of that M."""
    groups: list[tuple[list[int], list[int]]] = [([], [])]
    in_left = False
    for number, event in enumerate(events):
        match event:
            case ("M",):
                groups.append(([], []))
            case ("end of M",):
                _close(groups)
            case ("L",):
                in_left = True
            case ("end of L",):
                in_left = False
            case _:
                groups[-1][0 if in_left else 1].append(number)
    while len(groups) > 1:  # a way that ends in the middle
        _close(groups)
    return groups[0][1]


def _close(groups: list[tuple[list[int], list[int]]]) -> None:
    left, middle = groups.pop()
    groups[-1][1].extend((*left, *middle))


def items_of(world: World, event: Any) -> tuple[TraceItem, ...]:
    """What an event is in a trace."""
    match event:
        case ("assert", test, values):
            return (assert_item(test, values),)
        case ("do", op, arguments, _):
            return do_items(world, op, arguments)
        case ("eff", Context(application=application, values=values)):
            assert application.code is not None
            return (effect_item(application.code, values),)
        case _:
            return ()


def do_items(world: World, op: DoOp, arguments: tuple[Value, ...]) -> tuple[TraceItem, ...]:
    """A controller call in a trace, and the controller's effect if it has one."""
    controller = world.controllers[op.controller]
    item = DoItem(op.controller, arguments, op.location)
    if controller.effect is None:
        return (item,)
    own = dict(zip((p.name for p in controller.parameters), arguments, strict=True))
    effect = EffItem(op.controller, controller.effect, controller.parameters, own, op.location)
    return item, effect


def effect_item(code: Code, values: Sequence[Value]) -> EffItem:
    """The effect of a behavior in a trace."""
    behavior = code.behavior
    own = names_of(code.effect_slots, values)
    body = behavior.effect or ()
    return EffItem(behavior.name, body, behavior.parameters, own, behavior.location)


def _steps(events: list[Any]) -> tuple[Step, ...]:
    """One step a controller call, and one for an effect that came without any.

    The binds of a behavior are known in full where its R ends, those of calls in its L too.
    """
    steps: list[Step | None] = []  # None until the R of its behavior has ended
    rights: list[tuple[Application, list[Call]]] = []
    lefts: dict[Application, list[list[Call]]] = {}
    for event in events:
        match event:
            case ("left", application):
                lefts.setdefault(application, []).append([])
            case ("begin", application):
                rights.append((application, []))
            case ("do", op, arguments, context):
                call = (len(steps), op, arguments)
                steps.append(None)
                if rights and rights[-1][0] is context.application:
                    rights[-1][1].append(call)
                else:
                    lefts[context.application][-1].append(call)
            case ("end", context):
                application, own = rights.pop()
                # Of equal applications in one M, the one whose L came last ends first.
                own = lefts[application].pop() + own if lefts.get(application) else own
                for index, op, arguments in own:
                    steps[index] = _step(context, op, arguments)
                if not own and application.code is not None and application.code.has_effect:
                    steps.append(_step(context, None, ()))
            case _:
                pass
    assert all(step is not None for step in steps)
    return cast("tuple[Step, ...]", tuple(steps))


def _step(context: Context, op: DoOp | None, arguments: tuple[Value, ...]) -> Step:
    application = context.application
    code = application.code
    assert code is not None
    bindings = {
        name: value
        for name, slot in code.bound
        if (value := context.values[slot]) is not None and not has_unknown(value)
    }
    given = zip(application.arguments, context.values, strict=False)
    own = tuple(value if argument is None else argument for argument, value in given)
    controller = None if op is None else op.controller
    return Step(code.behavior.name, own, bindings, controller, arguments)
