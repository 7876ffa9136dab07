"""Unknowns stand where values would, and stop what needs their value."""

import operator
from collections.abc import Callable

import numpy as np
import pytest
from programs import expression_of, start

from crow.evaluate import evaluate, execute
from crow.problem import State
from crow.program import BOOL, FLOAT32, FLOAT64, INT32, INT64, Type
from crow.program.types import ListType, NamedType, ObjectType, VectorType
from crow.unknowns import Touched, Unknown, has_unknown, is_same, resolved, unknowns_in
from crow.values import converted, stored

X, Y = Unknown("x", FLOAT64), Unknown("y", FLOAT64)


@pytest.mark.parametrize(
    "use",
    [
        lambda x: x + 1, lambda x: 1 + x, lambda x: x - 1.5, lambda x: 2 - x, lambda x: x * 2,
        lambda x: 2 / x, lambda x: x // 2, lambda x: 2 % x, lambda x: x**2, lambda x: 2**x,
        operator.neg, abs, bool, int, float, len, list, operator.not_,
        lambda x: x[0], lambda x: 1 in x, lambda x: x < 1, lambda x: x >= 1, lambda x: x == 1,
        lambda x: x == "a", lambda x: x == Y, lambda x: (x, 1) == (2, 1), lambda x: [3, x].index(4),
        lambda x: max([x, 1]), lambda x: x(), lambda x: range(x),
        lambda x: np.float64(1) + x, lambda x: np.ones(2) * x, lambda x: np.asarray(x),
    ],
)  # fmt: skip
def test_what_needs_the_value_says_so(use: Callable[[Unknown], object]) -> None:
    with pytest.raises(Touched) as caught:
        use(X)
    assert caught.value.unknown is X


def test_what_does_not_need_it_goes_on() -> None:
    assert X == X
    assert not X != X  # noqa: SIM202
    assert {X: 1, Y: 2}[X] == 1
    assert (X, 1) == (X, 1)
    assert repr((X, 1)) == "(?x, 1)"
    assert is_same((X, 1), (X, 1))
    assert not is_same((X, 1), (Y, 1))
    assert not is_same(X, 1)
    assert is_same(1, 1.0)


def test_unknowns_within_vectors() -> None:
    assert list(unknowns_in(((X, 1), Y))) == [X, Y]
    assert has_unknown((1, (2, X)))
    assert not has_unknown((1, (2, 3)))
    assert resolved((X, (Y, 2)), {X: 5}) == (5, (Y, 2))


PAIR = VectorType(FLOAT64, 2)


@pytest.mark.parametrize(
    ("own", "wanted", "is_converted", "is_stored"),
    [
        (FLOAT64, FLOAT64, True, True),
        (FLOAT64, FLOAT32, True, False),
        (FLOAT32, FLOAT32, True, False),
        (FLOAT32, FLOAT64, True, True),
        (INT64, INT32, False, False),
        (INT32, INT64, True, True),
        (INT64, FLOAT64, False, False),
        (BOOL, BOOL, True, True),
        (ObjectType("a"), ObjectType("b"), True, True),
        (PAIR, NamedType("pose", PAIR), True, True),
        (PAIR, VectorType(FLOAT64, None), True, True),
        (VectorType(FLOAT64, None), PAIR, False, False),
        (PAIR, VectorType(FLOAT32, 2), True, False),
        (ListType(INT32), ListType(INT64), True, True),
    ],
)
def test_an_unknown_is_kept_where_its_value_would_be(
    own: Type, wanted: Type, is_converted: bool, is_stored: bool
) -> None:
    unknown = Unknown("u", own)
    for convert, is_kept in ((converted, is_converted), (stored, is_stored)):
        if is_kept:
            assert convert(unknown, wanted) is unknown
        else:
            with pytest.raises(Touched):
                convert(unknown, wanted)


def test_elements_of_a_vector_may_be_unknown() -> None:
    assert is_same(stored((X, 1), PAIR), (X, 1.0))
    with pytest.raises(Touched):
        stored((X, 1), VectorType(FLOAT32, 2))


DOMAIN = """
typedef item
typedef pose: vector[float64, 2]
feature at(x: item) -> pose
feature near(x: item)
feature holder() -> item
"""


def test_a_state_holds_them_and_evaluation_stops_at_them() -> None:
    world, state = start(DOMAIN, "a, b: item", "at[a] = [0, 1]")
    pose, thing = Unknown("p", NamedType("pose", PAIR)), Unknown("o", ObjectType("item"))
    state = world.updated(state, {("at", ("b",)): pose, ("holder", ()): thing})
    assert isinstance(state, State)

    def value(text: str) -> object:
        expression = expression_of(DOMAIN, text, "a, b: item", value=True)
        return evaluate(world, state, expression, {})

    assert value("at(b)") is pose
    assert value("at(b) == at(b)") is True
    assert value("near(a) and at(b) == at(a)") is False
    for text, touched in (
        ("at(b) == at(a)", pose),
        ("at(holder())", thing),
        ("near(holder())", thing),
    ):
        with pytest.raises(Touched) as caught:
            value(text)
        assert caught.value.unknown is touched


def test_effects_carry_them_on_and_do_not_write_to_a_cell_of_an_unknown_object() -> None:
    effect = (
        "controller c(x: item, y: item):\n  eff:\n    at[x] = at(y)\n    near[holder()] = True\n"
    )
    domain = DOMAIN + effect
    world, state = start(domain, "a, b: item", "pass")
    pose, thing = Unknown("p", NamedType("pose", PAIR)), Unknown("o", ObjectType("item"))
    state = world.updated(state, {("at", ("b",)): pose})
    statements = world.controllers["c"].effect or ()
    names = {"x": "a", "y": "b"}
    after = execute(world, state, statements[:1], names)
    assert after.cells["at", ("a",)] is pose
    with pytest.raises(Touched) as caught:
        execute(world, world.updated(state, {("holder", ()): thing}), statements, names)
    assert caught.value.unknown is thing
