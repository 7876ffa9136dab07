"""The constructors of formulas fold, and never change what a formula says."""

from itertools import product

from hypothesis import given, settings
from hypothesis import strategies as st
from programs import program_of, start

from cdlc.ir.logic import (
    FALSE,
    TRUE,
    choice,
    conjunction,
    conjuncts,
    disjunction,
    equality,
    folded,
    follows,
    negation,
)
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
from crow.program.rewrite import rename_quantified, rewrite, substitute
from crow.program.types import FLOAT64, INT64
from crow.program.walk import free_variables

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
    st.sampled_from([*ATOMS, TRUE, FALSE]),
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


@given(FORMULAS)
@settings(deadline=None)
def test_conjunction_and_disjunction(parts: list[Expression]) -> None:
    rows = list(zip(*map(table, parts), strict=True)) or [()] * 8
    assert table(conjunction(parts)) == [all(row) for row in rows]
    assert table(disjunction(parts)) == [any(row) for row in rows]
    assert table(conjunction(conjuncts(conjunction(parts)))) == [all(row) for row in rows]


@given(FORMULA, FORMULA, FORMULA)
@settings(deadline=None)
def test_negation_and_choice(test: Expression, then: Expression, otherwise: Expression) -> None:
    assert table(negation(test)) == [not value for value in table(test)]
    assert table(negation(negation(test))) == table(test)
    columns = zip(*map(table, (test, then, otherwise)), strict=True)
    assert table(choice(test, then, otherwise)) == [t if c else o for c, t, o in columns]


@given(FORMULA)
@settings(deadline=None)
def test_folding(formula: Expression) -> None:
    built = rewrite(formula, lambda node: folded(node, HIERARCHY))
    assert table(built) == table(formula)


@given(FORMULAS, FORMULA)
@settings(deadline=None)
def test_following(premises: list[Expression], conclusion: Expression) -> None:
    rows = [all(row) for row in zip(*map(table, premises), strict=True)] or [True] * 8
    truth = all(value for row, value in zip(rows, table(conclusion), strict=True) if row)
    assert follows(premises, conclusion, HIERARCHY) is truth


def _parts(formulas: list[Expression]) -> list[Expression]:
    parts: list[Expression] = []
    for formula in formulas:
        rewrite(formula, lambda node: parts.append(node) or node)
    return parts


def test_what_is_plainly_decided_is_folded() -> None:
    a, b, _ = ATOMS
    assert conjunction((a, And((a, b)), TRUE)) == And((a, b))
    assert conjunction((a, Not(a))) == FALSE
    assert disjunction((a, Or((a, b)), FALSE)) == Or((a, b))
    assert disjunction((a, Not(a))) == TRUE
    assert negation(Not(a)) == a
    assert choice(a, TRUE, FALSE) == a
    assert choice(a, FALSE, TRUE) == Not(a)
    assert choice(a, b, b) == b
    empty = Quantified("forall", (Parameter("x", ObjectType("T")),), TRUE)
    assert folded(empty, HIERARCHY) == TRUE


def test_following_treats_equality_alike_in_both_directions() -> None:
    x, y = (Variable(name, ObjectType("T")) for name in "xy")
    assert follows([Compare("!=", x, y)], Not(Compare("==", y, x)), HIERARCHY) is True
    assert follows([Compare("==", x, y)], Compare("==", y, x), HIERARCHY) is True
    assert follows([], Compare("==", x, y), HIERARCHY) is False
    assert follows([], Compare("==", x, x), HIERARCHY) is True


def test_what_is_not_boolean_is_not_judged() -> None:
    one = Constant(1, INT64)
    value = Compare(">", Read("n", (), INT64), one)
    assert follows([], value, HIERARCHY) is None
    assert follows([value], value, HIERARCHY) is True
    assert follows([FALSE], value, HIERARCHY) is True
    a = ATOMS[0]
    assert follows([], And((a, value)), HIERARCHY) is None


# ---------------------------------------------------------------------------------------- equality

T, U, V = (ObjectType(name) for name in "TUV")


def test_equality_is_decided_where_it_can_be() -> None:
    x, u, v = Variable("x", T), Variable("u", U), Variable("v", V)
    assert equality(x, x, HIERARCHY) == TRUE
    assert equality(x, v, HIERARCHY) == FALSE
    assert equality(x, u, HIERARCHY) == Compare("==", x, u)
    assert equality(Object("o1", T), Object("o2", T), HIERARCHY) == FALSE
    assert equality(Object("u1", U), Object("u1", T), HIERARCHY) == TRUE
    assert equality(Object("o1", T), v, HIERARCHY) == FALSE
    assert equality(Constant(1, INT64), Constant(1.0, FLOAT64), HIERARCHY) == TRUE
    assert equality(Constant(1, INT64), Constant(2, INT64), HIERARCHY) == FALSE
    flags = Variable("f", BOOL), Variable("g", BOOL)
    assert equality(*flags, HIERARCHY) == Compare("==", *flags)


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
@settings(deadline=None)
def test_substitution_captures_no_variable(
    formula: Expression, values: dict[str, Expression], state: State, outer: dict[str, str]
) -> None:
    def value(term: Expression) -> str:
        return outer[term.name] if isinstance(term, Variable) else str(term.name)

    inner = {**outer, **{name: value(term) for name, term in values.items()}}
    expected = holds(WORLD, state, formula, inner)
    assert holds(WORLD, state, substitute(formula, values), outer) is expected


@given(QUANTIFIED, st.sets(st.sampled_from([*NAMES, "x_2"])), RELATION, VALUES)
@settings(deadline=None)
def test_renaming_quantified_variables_changes_nothing_else(
    formula: Expression, taken: set[str], state: State, outer: dict[str, str]
) -> None:
    renamed = rename_quantified(formula, taken)
    assert holds(WORLD, state, renamed, outer) is holds(WORLD, state, formula, outer)
    assert free_variables(renamed) == free_variables(formula)
    bound = {
        v.name for part in _parts([renamed]) if isinstance(part, Quantified) for v in part.variables
    }
    assert not bound & taken


def test_the_world_is_as_the_tests_assume() -> None:
    assert isinstance(WORLD, World)
    assert OBJECTS == ["o1", "o2", "u1"]
