"""What level `full` makes of a formula has the same value in every state in which it has one."""

from collections.abc import Mapping

import pytest
from hypothesis import HealthCheck, event, given, settings
from hypothesis import strategies as st
from properties.effects import PARAMETERS, conditions, numbers, program
from properties.worlds import WORLD, states

from cdlc.ir.graph import written_size
from cdlc.ir.nodes import Level
from cdlc.ir.pool import Pool
from cdlc.ir.simplify import Work, simplest
from cdlc.ir.symbolic import Executor
from cdlc.ir.updates import Layer
from crow.evaluate import EvaluationError, assignments_of, evaluate_shared
from crow.problem import State
from crow.program import (
    BOOL,
    INT64,
    And,
    Arithmetic,
    Compare,
    Conditional,
    Constant,
    Expression,
    Hierarchy,
    Negative,
    Not,
    Or,
    Read,
    Variable,
    Xor,
)

PROGRAM = program(())
P, Q = (Variable(parameter.name, parameter.type) for parameter in PARAMETERS[:2])
TOTALS = [Read("count", (P,), INT64), Read("count", (Q,), INT64), Read("total", (), INT64)]
FLAGS = [Read("red", (P,), BOOL), Read("flag", (), BOOL), Compare("==", P, Q)]


@st.composite
def dense_numbers(draw: st.DrawFn, depth: int) -> Expression:
    """A whole number over few cells, so that much of it can be folded."""
    if not depth:
        constants = st.integers(-2, 3).map(lambda value: Constant(value, INT64))
        return draw(st.one_of(st.sampled_from(TOTALS), constants))
    operator = draw(st.sampled_from(["+", "-", "+", "-", "*", "//", "%", "if", "if", "minus"]))
    left, right = draw(dense_numbers(depth - 1)), draw(dense_numbers(depth - 1))
    if operator == "if":
        return Conditional(draw(dense_conditions(depth - 1)), left, right, INT64)
    if operator == "minus":
        return Negative(left, INT64)
    return Arithmetic(operator, left, right, INT64)  # type: ignore[arg-type]


@st.composite
def dense_conditions(draw: st.DrawFn, depth: int) -> Expression:
    """A condition over few cells."""
    if not depth:
        return draw(st.sampled_from(FLAGS))
    kind = draw(st.sampled_from(["and", "or", "xor", "not", "if", "<", "compare", "compare"]))
    if kind in ("compare", "<"):
        operator = draw(st.sampled_from(["==", "!=", "<", "<=", ">", ">="]))
        sides = draw(dense_numbers(depth - 1)), draw(dense_numbers(depth - 1))
        return Compare(operator, *sides)  # type: ignore[arg-type]
    left, right = draw(dense_conditions(depth - 1)), draw(dense_conditions(depth - 1))
    match kind:
        case "and":
            return And((left, right))
        case "or":
            return Or((left, right))
        case "xor":
            return Xor(left, right)
        case "not":
            return Not(left)
        case _:
            return Conditional(draw(dense_conditions(depth - 1)), left, right, BOOL)


RELAXED = (HealthCheck.too_slow, HealthCheck.data_too_large)
FORMULAS = st.one_of(
    dense_conditions(4), dense_numbers(4), conditions(PARAMETERS, 5), numbers(PARAMETERS, 5)
)


def value(formula: Expression, state: State, variables: Mapping[str, object]) -> object:
    """The value of a formula, or None where it has none."""
    try:
        return evaluate_shared(WORLD, state, formula, variables)
    except EvaluationError:
        return None


def check_same(formula: Expression, tried: list[State]) -> Expression | None:
    """The simplified formula, if it is within the limits."""
    pool = Pool(Hierarchy.of(PROGRAM.types), Level.FULL)
    variables = {p.name: pool.variable(p.name, p.type) for p in PARAMETERS}
    basic = Executor(PROGRAM, pool).value(formula, Layer(), variables)
    full = simplest(basic, pool, Work())
    if full is None:
        return None
    for state in tried:
        for arguments in assignments_of(WORLD, PARAMETERS, {}):
            expected = value(basic, state, arguments)
            if expected is not None:
                assert value(full, state, arguments) == expected, (basic, full, arguments)
    return full


@given(FORMULAS, st.lists(states(), min_size=1, max_size=3))
@settings(max_examples=150, deadline=None, suppress_health_check=RELAXED)
def test_full_is_equal_to_basic(formula: Expression, tried: list[State]) -> None:
    event(str(type(check_same(formula, tried)).__name__))


@pytest.mark.slow
@given(FORMULAS, st.lists(states(), min_size=1, max_size=3))
@settings(max_examples=10_000, deadline=None, suppress_health_check=RELAXED)
def test_full_is_equal_to_basic_on_many_formulas(formula: Expression, tried: list[State]) -> None:
    check_same(formula, tried)


@given(conditions(PARAMETERS, 5), st.integers(1, 400))
@settings(max_examples=50, deadline=None, suppress_health_check=RELAXED)
def test_work_is_bounded(formula: Expression, limit: int) -> None:
    pool = Pool(Hierarchy.of(PROGRAM.types), Level.FULL)
    variables = {p.name: pool.variable(p.name, p.type) for p in PARAMETERS}
    basic = Executor(PROGRAM, pool).value(formula, Layer(), variables)
    work = Work(limit)
    if written_size(basic) > limit:
        assert simplest(basic, pool, work) is None
        assert work.left == limit
    else:
        simplest(basic, pool, work)
        assert work.left == limit - written_size(basic)


def test_a_part_without_value_is_not_evaluated_earlier() -> None:
    total = TOTALS[2]
    quotient = Arithmetic("//", Constant(6, INT64), total, INT64)
    guarded = Compare(">", quotient, Constant(1, INT64))
    either = Or((guarded, And((FLAGS[1], guarded))))
    formula = And((Compare("!=", total, Constant(0, INT64)), either))
    assert check_same(formula, [State({("total", ()): number}) for number in (0, 2, 6)])


def test_minimising_is_bounded_for_all_formulas_together() -> None:
    pool = Pool(Hierarchy.of(PROGRAM.types), Level.FULL)
    variables = {p.name: pool.variable(p.name, p.type) for p in PARAMETERS}
    either = Or((And((FLAGS[0], FLAGS[1])), And((FLAGS[0], Not(FLAGS[1])))))
    basic = Executor(PROGRAM, pool).value(either, Layer(), variables)
    work = Work(minimisations=2)
    found = [simplest(basic, pool, work) for _ in range(3)]
    assert found == [FLAGS[0], FLAGS[0], None]
