"""Truth values alone, against a SAT solver: the same answers, and models that satisfy."""

from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st
from posed import Posed

from benchmarks.sat import Translation
from crow.constraints import Conflict, Constraint, Store
from crow.problem import State, World
from crow.program import BOOL, And, Conditional, Expression, Not, Or, Program, Variable, Xor
from crow.unknowns import Unknown

solvers = pytest.importorskip("pysat.solvers", reason="python-sat is not installed")

WORLD = World(Program("booleans"), {})


def variable(number: int) -> Variable:
    return Variable(f"x{abs(number)}", BOOL)


def literal(number: int) -> Expression:
    return variable(number) if number > 0 else Not(variable(number))


def compare(formulas: Sequence[Expression], count: int, *, has_core: bool = True) -> bool:
    """Whether formulas can be true together: ours, checked, is theirs; with a core, if wanted."""
    unknowns = {f"x{i}": Unknown(f"x{i}", BOOL) for i in range(1, count + 1)}
    constraints = tuple(Constraint(f, unknowns, State()) for f in formulas)
    problem = Posed(WORLD, State(), unknowns, constraints)
    translation = Translation(count)
    roots = [[translation.literal(formula)] for formula in formulas]
    with solvers.Cadical153(bootstrap_with=translation.clauses + roots) as sat:
        expected = bool(sat.solve())
    store = Store.of(WORLD).having(*constraints)
    if isinstance(store, Conflict):
        found = None
        core = store.core
    else:
        solutions = problem.solver().solutions(store)
        found = next(solutions, None)
        if found is not None:
            problem.checked(found)
        else:
            assert solutions.is_proved
        core = solutions.core().core if found is None and has_core else ()
    assert (found is not None) == expected
    if core:
        check_core(core, translation, constraints)
    return expected


def check_core(
    core: Sequence[Constraint], translation: Translation, constraints: Sequence[Constraint]
) -> None:
    """A core is part of the constraints, and cannot be met by itself."""
    assert set(core) <= set(constraints)
    roots = [[translation.literal(c.condition)] for c in core]
    with solvers.Cadical153(bootstrap_with=translation.clauses + roots) as sat:
        assert not sat.solve()


numbers = st.integers(1, 9).flatmap(lambda n: st.sampled_from((n, -n)))
clauses = st.lists(numbers, min_size=3, max_size=3).map(lambda c: Or(tuple(map(literal, c))))
formulas = st.recursive(
    numbers.map(literal),
    lambda inner: st.one_of(
        st.builds(Not, inner),
        st.lists(inner, min_size=2, max_size=4).map(lambda parts: And(tuple(parts))),
        st.lists(inner, min_size=2, max_size=4).map(lambda parts: Or(tuple(parts))),
        st.builds(Xor, inner, inner),
        st.builds(Conditional, inner, inner, inner, st.just(BOOL)),
    ),
    max_leaves=12,
)


@given(st.lists(clauses, min_size=20, max_size=50))
def test_random_3_sat_has_the_answers_of_a_sat_solver(found: list[Expression]) -> None:
    compare(found, 9, has_core=False)


@given(st.lists(formulas, min_size=1, max_size=9))
def test_nested_formulas_have_the_answers_of_a_sat_solver(found: list[Expression]) -> None:
    compare(found, 9)


def test_pigeons_do_not_fit_into_fewer_holes() -> None:
    pigeons, holes = 5, 4
    number = {(p, h): p * holes + h + 1 for p in range(pigeons) for h in range(holes)}
    sits = [Or(tuple(variable(number[p, h]) for h in range(holes))) for p in range(pigeons)]
    apart = [
        Or((literal(-number[p, h]), literal(-number[q, h])))
        for h in range(holes)
        for p in range(pigeons)
        for q in range(p)
    ]
    assert not compare([*sits, *apart], pigeons * holes)
    assert compare([*sits[1:], *apart], pigeons * holes)
