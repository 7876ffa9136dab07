"""A weakest precondition holds in exactly the states from which running the effect reaches."""

from collections.abc import Iterator
from itertools import product

import pytest
from hypothesis import HealthCheck, assume, event, given, settings
from hypothesis import strategies as st
from properties.effects import FEATURES, FUNCTIONS, PARAMETERS, blocks, conditions, program

from cdlc.ir.hoare import Model
from cdlc.ir.nodes import Level
from cdlc.ir.updates import NotModelled
from crow.evaluate import EvaluationError, assignments_of, execute, holds
from crow.problem import Cell, State, World
from crow.program import BOOL, INT64, Apply, Expression, Parameter, Read, Statement
from crow.program.walk import expressions_of, statements_within, subexpressions

# The constant `k`, a thing, and a box: parameters of both types may be one object.
WORLD = World.of(program(()), (Parameter("c", PARAMETERS[2].type),))
MOST_STATES = 1_000
RELAXED = (HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.filter_too_much)


def mentioned(effect: tuple[Statement, ...], condition: Expression) -> set[str]:
    """The features that an effect or condition reads or writes."""
    functions = {f.name: f for f in FUNCTIONS}
    pending: list[Expression] = [condition]
    names = set()
    statements = list(statements_within(effect))
    while statements or pending:
        for statement in statements:
            names.add(getattr(statement, "feature", ""))
            pending += expressions_of(statement)
        statements = []
        for part in subexpressions(pending.pop()) if pending else ():
            if isinstance(part, Read):
                names.add(part.feature)
            if isinstance(part, Apply) and part.function in functions:
                body = functions.pop(part.function).body
                statements += statements_within(body or ())
    return names


def every_state(features: set[str]) -> Iterator[State]:
    """Every state in which only these features differ from one that is fixed."""
    cells: dict[Cell, list[object]] = {}
    for feature in FEATURES:
        for arguments in WORLD.cells(feature):
            values: list[object] = list(WORLD.objects_of(feature.type))
            values = [False, True] if feature.type == BOOL else values
            values = [0, 1, 2] if feature.type == INT64 else values
            cells[feature.name, arguments] = values if feature.name in features else values[:1]
    for chosen in product(*cells.values()):
        yield WORLD.updated(State(), dict(zip(cells, chosen, strict=True)))


def number_of_states(features: set[str]) -> int:
    count = 1
    for feature in FEATURES:
        values = {BOOL: 2, INT64: 3}.get(feature.type, 2)
        count *= values ** len(list(WORLD.cells(feature))) if feature.name in features else 1
    return count


def check(effect: tuple[Statement, ...], condition: Expression, level: Level) -> None:
    features = mentioned(effect, condition)
    assume(number_of_states(features) <= MOST_STATES)
    made = program(effect)
    model = Model(made, level)
    try:
        (triple,) = model.triples(made.behaviors[0])
        wanted = model.formula(condition, PARAMETERS)
        weakest = model.weakest_precondition(wanted, triple)
    except NotModelled as missing:
        event(f"not modelled: {missing.construct}")
        return
    event("compared")
    for state in every_state(features):
        for arguments in assignments_of(WORLD, PARAMETERS, {}):
            try:
                after = execute(WORLD, state, effect, arguments)
                expected = holds(WORLD, after, condition, arguments)
            except EvaluationError:
                continue
            assert holds(WORLD, state, weakest, arguments) is expected, (effect, condition)


def check_instance(
    effect: tuple[Statement, ...], condition: Expression, names: tuple[str, ...]
) -> None:
    """The variables of the condition are its own where the behavior is given arguments."""
    features = mentioned(effect, condition)
    assume(number_of_states(features) <= MOST_STATES)
    made = program(effect)
    model = Model(made)
    given_ = [(n, model.pool.named_object(n, WORLD.objects[n])) for n in names]
    try:
        (triple,) = model.triples(made.behaviors[0])
        wanted = model.formula(condition, PARAMETERS)
        weakest = model.weakest_precondition(wanted, triple, tuple(o for _, o in given_))
    except NotModelled:
        return
    variables = dict(zip((p.name for p in PARAMETERS), names, strict=True))
    for state in every_state(features):
        for own in assignments_of(WORLD, PARAMETERS, {}):
            try:
                after = execute(WORLD, state, effect, variables)
                expected = holds(WORLD, after, condition, own)
            except EvaluationError:
                continue
            assert holds(WORLD, state, weakest, own) is expected, (effect, condition, names)


ARGUMENTS = st.sampled_from(
    [tuple(map(str, a.values())) for a in assignments_of(WORLD, PARAMETERS, {})]
)


@given(blocks(PARAMETERS, 2), conditions(PARAMETERS, 2), ARGUMENTS)
@settings(max_examples=10, deadline=None, suppress_health_check=RELAXED)
def test_of_given_arguments(
    effect: tuple[Statement, ...], condition: Expression, names: tuple[str, ...]
) -> None:
    check_instance(effect, condition, names)


@pytest.mark.slow
@given(blocks(PARAMETERS, 2), conditions(PARAMETERS, 2), ARGUMENTS)
@settings(max_examples=500, deadline=None, suppress_health_check=RELAXED)
def test_of_given_arguments_for_many_programs(
    effect: tuple[Statement, ...], condition: Expression, names: tuple[str, ...]
) -> None:
    check_instance(effect, condition, names)


CASES = (blocks(PARAMETERS, 2), conditions(PARAMETERS, 2), st.sampled_from(Level))


@given(*CASES)
@settings(max_examples=20, deadline=None, suppress_health_check=RELAXED)
def test_it_holds_where_running_reaches_the_condition(
    effect: tuple[Statement, ...], condition: Expression, level: Level
) -> None:
    check(effect, condition, level)


@pytest.mark.slow
@given(*CASES)
@settings(max_examples=2_000, deadline=None, suppress_health_check=RELAXED)
def test_it_holds_where_running_reaches_the_condition_for_many_programs(
    effect: tuple[Statement, ...], condition: Expression, level: Level
) -> None:
    check(effect, condition, level)


def test_the_features_of_functions_count() -> None:
    odd = Apply("odd", (Read("at", (), PARAMETERS[0].type),), BOOL)
    assert mentioned((), odd) == {"at", "red", "count", ""}
