"""Running an effect statement by statement, and applying its triple at once, is the same."""

from collections.abc import Mapping
from itertools import product

import pytest
from hypothesis import HealthCheck, event, given, settings
from hypothesis import strategies as st
from properties.effects import PARAMETERS, blocks, program
from properties.worlds import WORLD, states

from cdlc.ir.hoare import Model
from cdlc.ir.nodes import Level
from cdlc.ir.updates import NotModelled
from crow.evaluate import EvaluationError, assignments_of, evaluate_shared, execute
from crow.problem import State, World
from crow.program import Parameter, Statement, Variable
from crow.program.triples import Update


def updates_of(effect: tuple[Statement, ...], level: Level) -> tuple[Update, ...]:
    made = program(effect)
    (triple,) = Model(made, level).triples(made.behaviors[0])
    return triple.post


def applied(
    world: World, state: State, updates: tuple[Update, ...], variables: Mapping[str, object]
) -> State:
    """All updates at once: everything reads the state before, later ones win."""
    changes = {}
    for update in updates:
        bound = tuple(
            Parameter(v.name, v.type) for v in update.variables if isinstance(v, Variable)
        )
        for values in assignments_of(world, bound, variables):
            if evaluate_shared(world, state, update.guard, values):
                cell = tuple(evaluate_shared(world, state, a, values) for a in update.arguments)
                changes[update.feature, cell] = evaluate_shared(world, state, update.value, values)
    return world.updated(state, changes)


def compare(effect: tuple[Statement, ...], state: State, world: World, level: Level) -> None:
    try:
        updates = updates_of(effect, level)
    except NotModelled as missing:
        event(f"not modelled: {missing.construct}")
        return
    for arguments in product(*(world.objects_of(p.type) for p in PARAMETERS)):
        variables = dict(zip((p.name for p in PARAMETERS), arguments, strict=True))
        try:
            ran = execute(world, state, effect, variables)
        except EvaluationError as error:
            event("no value: " + str(error).split("`")[0])
            continue
        event("compared")
        at_once = applied(world, state, updates, variables)
        assert dict(at_once.cells) == dict(ran.cells), (arguments, effect)


LEVELS = st.sampled_from(Level)
RELAXED = (HealthCheck.too_slow, HealthCheck.data_too_large)


@given(blocks(PARAMETERS, 3), states(), LEVELS)
@settings(max_examples=300, deadline=None, suppress_health_check=RELAXED)
def test_effects_equal_triples(effect: tuple[Statement, ...], state: State, level: Level) -> None:
    compare(effect, state, WORLD, level)


@pytest.mark.slow
@given(blocks(PARAMETERS, 4), states(), LEVELS)
@settings(max_examples=20_000, deadline=None, suppress_health_check=RELAXED)
def test_many_effects_equal_triples(
    effect: tuple[Statement, ...], state: State, level: Level
) -> None:
    compare(effect, state, WORLD, level)
