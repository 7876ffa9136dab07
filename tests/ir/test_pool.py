"""The pool simplifies formulas, and never changes what a formula says."""

from itertools import product

from hypothesis import given
from hypothesis import strategies as st
from programs import program_of, start

from cdlc.ir.graph import size
from cdlc.ir.nodes import Level
from cdlc.ir.pool import Pool
from crow.evaluate import holds
from crow.problem import State, World
from crow.program import (
    BOOL,
    And,
    Compare,
    Conditional,
    Constant,
    Expression,
    Hierarchy,
    Not,
    Object,
    ObjectType,
    Or,
    Parameter,
    Quantified,
    Read,
    Variable,
    Xor,
)
from crow.program.types import FLOAT64, INT64
from crow.program.walk import free_variables as program_free_variables

DOMAIN = """
typedef T
typedef U: T
typedef V
feature a()
feature b()
feature c()
feature p(x: T)
feature on(x: T, y: T)
"""
HIERARCHY = Hierarchy.of(program_of(DOMAIN).types)
WORLD, _ = start(DOMAIN, "o1, o2: T; u1: U")
ATOMS = [Read(name, (), BOOL) for name in "abc"]


def assignments() -> list[State]:
    return [
        State({(name, ()): True for name, is_true in zip("abc", values, strict=True) if is_true})
        for values in product((False, True), repeat=3)
    ]


def table(formula: Expression) -> list[bool]:
    return [holds(WORLD, state, formula, {}) for state in assignments()]


def _pairs(inner: st.SearchStrategy[Expression]) -> st.SearchStrategy[tuple[Expression, ...]]:
    return st.lists(inner, min_size=2, max_size=3).map(tuple)


FORMULA: st.SearchStrategy[Expression] = st.recursive(
    st.sampled_from([*ATOMS, Constant(True, BOOL), Constant(False, BOOL)]),  # noqa: FBT003 - values
    lambda inner: st.one_of(
        st.builds(Not, inner),
        st.builds(And, _pairs(inner)),
        st.builds(Or, _pairs(inner)),
        st.builds(Xor, inner, inner),
        st.builds(Compare, st.sampled_from(["==", "!="]), inner, inner),
        st.builds(Conditional, inner, inner, inner, st.just(BOOL)),
    ),
    max_leaves=8,
)
FORMULAS = st.lists(FORMULA, max_size=4)
LEVELS = st.sampled_from([Level.NONE, Level.BASIC])


@given(FORMULAS, LEVELS)
def test_conjunction_and_disjunction(parts: list[Expression], level: Level) -> None:
    pool = Pool(HIERARCHY, level)
    pooled = [pool.rebuild(part, {}) for part in parts]
    rows = list(zip(*map(table, parts), strict=True)) or [()] * 8
    assert table(pool.conjunction(pooled)) == [all(row) for row in rows]
    assert table(pool.disjunction(pooled)) == [any(row) for row in rows]


@given(FORMULA, FORMULA, FORMULA, LEVELS)
def test_negation_choice_and_exclusive(
    test: Expression, then: Expression, otherwise: Expression, level: Level
) -> None:
    pool = Pool(HIERARCHY, level)
    c, t, o = (pool.rebuild(part, {}) for part in (test, then, otherwise))
    columns = list(zip(*map(table, (test, then, otherwise)), strict=True))
    assert table(pool.negation(c)) == [not a for a, _, _ in columns]
    assert table(pool.choice(c, t, o)) == [y if x else z for x, y, z in columns]
    assert table(pool.exclusive(t, o)) == [y != z for _, y, z in columns]


@given(FORMULA, LEVELS)
def test_building_anew_changes_nothing(formula: Expression, level: Level) -> None:
    pool = Pool(HIERARCHY, level)
    built = pool.rebuild(formula, {})
    assert table(built) == table(formula)
    assert pool.rebuild(formula, {}) is built


@given(FORMULA, FORMULAS)
def test_given_holds_where_the_facts_do(formula: Expression, facts: list[Expression]) -> None:
    pool = Pool(HIERARCHY)
    pooled = [pool.rebuild(fact, {}) for fact in facts]
    rows = list(zip(*map(table, facts), strict=True)) or [()] * 8
    simpler = table(pool.given(pool.rebuild(formula, {}), pooled))
    for row, before, after in zip(rows, table(formula), simpler, strict=True):
        assert not all(row) or before == after


def test_what_is_plainly_decided_is_folded() -> None:
    pool = Pool(HIERARCHY)
    a, b, _ = (pool.rebuild(atom, {}) for atom in ATOMS)
    not_a = pool.negation(a)
    assert pool.conjunction((a, pool.conjunction((a, b)), pool.true)) is pool.conjunction((a, b))
    assert pool.conjunction((a, not_a)) is pool.false
    assert pool.disjunction((a, not_a)) is pool.true
    assert pool.negation(not_a) is a
    assert pool.choice(a, pool.true, pool.false) is a
    assert pool.choice(a, pool.false, pool.true) is not_a
    assert pool.choice(a, b, b) is b


# ------------------------------------------------------------------------------------- comparisons

T, U, V = (ObjectType(name) for name in "TUV")


def test_equality_is_decided_where_it_can_be() -> None:
    pool = Pool(HIERARCHY)
    x, u, v = pool.variable("x", T), pool.variable("u", U), pool.variable("v", V)
    assert pool.equal(x, x) is pool.true
    assert pool.equal(x, v) is pool.false
    assert isinstance(pool.equal(x, u), Compare)
    assert pool.equal(pool.named_object("o1", T), pool.named_object("o2", T)) is pool.false
    assert pool.equal(pool.named_object("o1", T), pool.named_object("o1", T)) is pool.true
    assert pool.equal(pool.constant(1, INT64), pool.constant(1.0, FLOAT64)) is pool.true
    assert pool.equal(pool.constant(1, INT64), pool.constant(2, INT64)) is pool.false


def test_chains_of_whole_numbers_are_summed() -> None:
    pool = Pool(HIERARCHY)
    n, one, two = pool.variable("n", INT64), pool.constant(1, INT64), pool.constant(2, INT64)
    less = pool.arithmetic("-", pool.arithmetic("-", n, one, INT64), one, INT64)
    assert less is pool.arithmetic("-", n, two, INT64)
    assert pool.arithmetic("+", less, two, INT64) is n
    zero = pool.constant(0, INT64)
    assert pool.compare(">", less, zero) is pool.compare(">", n, two)
    assert pool.compare("<", zero, less) is pool.compare(">", n, two)
    x, tenth = pool.variable("x", FLOAT64), pool.constant(0.1, FLOAT64)
    twice = pool.arithmetic("-", pool.arithmetic("-", x, tenth, FLOAT64), tenth, FLOAT64)
    assert size(twice) == 4  # floats are never reordered


def test_level_none_keeps_the_shape() -> None:
    pool = Pool(HIERARCHY, Level.NONE)
    n, one = pool.variable("n", INT64), pool.constant(1, INT64)
    less = pool.arithmetic("-", pool.arithmetic("-", n, one, INT64), one, INT64)
    assert size(less) == 4


# ------------------------------------------------------------------------------------ substitution

NAMES = ["x", "y", "z"]
VARIABLES = st.sampled_from(NAMES).map(lambda name: Variable(name, T))
TERM = st.one_of(VARIABLES, st.sampled_from([Object("o1", T), Object("u1", U)]))
QUANTIFIED: st.SearchStrategy[Expression] = st.recursive(
    st.builds(lambda a, b: Read("on", (a, b), BOOL), TERM, TERM),
    lambda inner: st.one_of(
        st.builds(Not, inner),
        st.builds(And, _pairs(inner)),
        st.builds(
            Quantified,
            st.sampled_from(["forall", "exists"]),
            st.lists(st.sampled_from(NAMES), min_size=1, max_size=2, unique=True).map(
                lambda names: tuple(Parameter(name, T) for name in names)
            ),
            inner,
        ),
    ),
    max_leaves=6,
)
OBJECTS = list(WORLD.objects)
RELATION = st.sets(st.tuples(st.sampled_from(OBJECTS), st.sampled_from(OBJECTS))).map(
    lambda pairs: State({("on", pair): True for pair in sorted(pairs)})
)
VALUES = st.fixed_dictionaries({name: st.sampled_from(OBJECTS) for name in NAMES})


@given(QUANTIFIED, st.dictionaries(st.sampled_from(NAMES), TERM), RELATION, VALUES)
def test_substitution_captures_no_variable(
    formula: Expression, values: dict[str, Expression], state: State, outer: dict[str, str]
) -> None:
    def value(term: Expression) -> str:
        return outer[term.name] if isinstance(term, Variable) else str(term.name)

    pool = Pool(HIERARCHY)
    pooled = pool.rebuild(formula, {})
    replaced = {name: pool.rebuild(term, {}) for name, term in values.items()}
    inner = {**outer, **{name: value(term) for name, term in values.items()}}
    expected = holds(WORLD, state, formula, inner)
    assert holds(WORLD, state, pool.substitute(pooled, replaced), outer) is expected
    assert pool.rebuild(pooled, {}) is pooled
    assert pool.free_variables(pooled) <= program_free_variables(formula)


def test_the_world_is_as_the_tests_assume() -> None:
    assert isinstance(WORLD, World)
    assert OBJECTS == ["o1", "o2", "u1"]
