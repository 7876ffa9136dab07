"""The values under which a triple leads from one state to another and makes some calls.

Values are the state's own: what a precondition says is the value of a read is looked up, and only
what nothing says is tried out, object by object.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from cdlc.backends.pddl.actions import Action, Source
from crow.evaluate import EvaluationError, assignments_of, evaluate_shared
from crow.problem import Cell, State, World
from crow.program import Compare, Parameter, Variable
from crow.program.triples import Triple
from crow.program.walk import free_variables
from crow.trace import DoItem
from crow.values import Value, default_value, stored

Values = dict[str, Value]
Known = Mapping[str, Value]


@dataclass(frozen=True, slots=True)
class Stretch:
    """What a transition is to do: from a state, make some calls, and leave the cells of `after`.

    `world` has the features of the emitted task, `own` are the names of the program's; only cells
    of those have to be as in `after`.
    """

    world: World
    own: frozenset[str]
    before: State
    made: Sequence[DoItem]
    after: State


def instances(
    source: Source, action: Action, known: Known, stretch: Stretch
) -> Iterator[tuple[Values, dict[Cell, Value]]]:
    """The values of the triple's variables, with what it writes besides the program's own features.

    `known` are variables of the behavior.
    """
    triple = source.triple
    if [call.controller for call in triple.calls] != [item.controller for item in stretch.made]:
        return
    values = given(source, action, known)
    if values is None:
        return
    for call, item in zip(triple.calls, stretch.made, strict=True):
        for argument, value in zip(call.arguments, item.arguments, strict=True):
            if isinstance(argument, Variable):
                values.setdefault(argument.name, value)
    _solve(triple, values, stretch)
    unknown = tuple(p for p in triple.parameters if p.name not in values)
    for candidate in assignments_of(stretch.world, unknown, values):
        try:
            written = _led(triple, candidate, stretch)
        except (EvaluationError, ArithmeticError):
            continue
        if written is not None:
            yield candidate, written


def given(source: Source, action: Action, known: Known) -> Values | None:
    """What is known of a triple's variables; None if that contradicts the triple."""
    places = dict(zip((p.name for p in action.parameters), source.order, strict=True))
    values: Values = {}
    for chosen in source.variables:
        if chosen.variable.name in known:
            value = known[chosen.variable.name]
            if chosen.object is not None and chosen.object != value:
                return None
            if chosen.parameter is None:
                continue
            if values.setdefault(places[chosen.parameter], value) != value:
                return None
    return values


def _solve(triple: Triple, values: Values, stretch: Stretch) -> None:
    """Add the variables that the precondition says are the value of something known."""
    equations = [
        (side, other)
        for part in triple.pre
        if isinstance(part, Compare) and part.operator == "=="
        for side, other in ((part.left, part.right), (part.right, part.left))
        if isinstance(side, Variable)
    ]
    own = {p.name for p in triple.parameters}
    while True:
        ready = [
            (variable.name, value)
            for variable, value in equations
            if variable.name in own - values.keys() and free_variables(value) <= values.keys()
        ]
        if not ready:
            return
        for name, value in ready:
            try:
                values[name] = evaluate_shared(stretch.world, stretch.before, value, values)
            except EvaluationError:
                values[name] = None


def _led(triple: Triple, values: Values, stretch: Stretch) -> dict[Cell, Value] | None:
    """What a triple writes besides the program's own features; None if it leads elsewhere."""
    world, before = stretch.world, stretch.before
    if not all(world.is_of(values[p.name], p.type) for p in triple.parameters):
        return None
    for call, item in zip(triple.calls, stretch.made, strict=True):
        arguments = (evaluate_shared(world, before, a, values) for a in call.arguments)
        if tuple(arguments) != item.arguments:
            return None
    if not all(evaluate_shared(world, before, part, values) for part in triple.pre):
        return None
    others: dict[Cell, Value] = {}
    for cell, value in _written(triple, values, stretch).items():
        if cell[0] not in stretch.own:
            others[cell] = value
        elif stretch.after.cells.get(cell, _default(world, cell)) != value:
            return None
    return others


def _default(world: World, cell: Cell) -> Value:
    return default_value(world.features[cell[0]].type)


def _written(triple: Triple, values: Values, stretch: Stretch) -> dict[Cell, Value]:
    """What a triple writes: all of it reads the state before, and later updates win."""
    world, before = stretch.world, stretch.before
    written: dict[Cell, Value] = {}
    for update in triple.post:
        own = [v for v in update.variables if isinstance(v, Variable)]
        bound = tuple(Parameter(v.name, v.type) for v in own)
        for inner in assignments_of(world, bound, values):
            if evaluate_shared(world, before, update.guard, inner):
                where = tuple(evaluate_shared(world, before, a, inner) for a in update.arguments)
                now = evaluate_shared(world, before, update.value, inner)
                written[update.feature, where] = stored(now, world.features[update.feature].type)
    return written
