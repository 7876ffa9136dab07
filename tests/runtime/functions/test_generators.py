"""Generators in Python: what they are called with, and what they yield."""

import inspect
from collections.abc import Iterator
from dataclasses import replace
from itertools import count, islice
from typing import Any

import numpy as np
import pytest
from small_program import problem

import crow
from crow.problem import State
from crow.program import Apply
from crow.unknowns import Touched, Unknown

A, B = (0.0, 1.0), (2.0, 1.0)


def generator(name: str, python: Any) -> Any:
    return problem({name: python}).world.externals.generators[name]


def drawn(name: str, python: Any, *inputs: Any) -> list[Any]:
    return list(generator(name, python).draw(problem(None).initial, inputs))


def yields(*values: Any) -> Any:
    """A generator function for some values, whatever it is called with."""

    def python(*_: Any) -> Iterator[Any]:
        yield from values

    return python


def test_what_it_is_stands_beside_it() -> None:
    marked = crow.generator(complete=True, limit=4)(lambda state, b: [])
    found = generator("reach", marked)
    assert isinstance(found.goal, Apply)
    assert [p.name for p in found.inputs] == ["b"]
    assert [p.name for p in found.outputs] == ["s"]
    assert (found.is_complete, found.limit, found.is_batch) == (True, 4, False)
    assert found.reads == {"at"}
    assert generator("paths", lambda a, b: []).reads is None
    assert generator("pairs", lambda state, b: []).reads == {"held"}


def test_the_state_comes_first_where_it_is_read() -> None:
    def reach(state: Any, b: str) -> Iterator[Any]:
        x, y = state.at(b)
        yield x + 1, y

    assert drawn("reach", reach, "a") == [((1.0, 1.0),)]
    assert drawn("pairs", lambda state, b: [((0, 0), state.held(b))], "b") == [((0.0, 0.0), True)]


def test_a_random_generator_comes_by_name() -> None:
    def reach(state: Any, b: str, *, rng: np.random.Generator) -> Iterator[Any]:
        while True:
            yield rng.random(2)

    found = generator("reach", reach)
    assert found.takes_random
    state = problem(None).initial
    first, second = (
        list(islice(found.draw(state, ("a",), np.random.default_rng(3)), 3)) for _ in range(2)
    )
    assert first == second
    assert all(type(x) is float for (spot,) in first for x in spot)


@pytest.mark.parametrize(
    ("yielded", "spot"),
    [
        ((1, 2), (1.0, 2.0)),
        ([1, 2], (1.0, 2.0)),
        (((1, 2),), (1.0, 2.0)),
        (([1, 2],), (1.0, 2.0)),
        (np.array([1, 2]), (1.0, 2.0)),
        ((np.array([1, 2]),), (1.0, 2.0)),
    ],
)
def test_one_output_is_a_value_or_a_tuple_of_it(yielded: Any, spot: Any) -> None:
    assert drawn("reach", yields(yielded), "a") == [(spot,)]


def test_an_opaque_output_that_is_a_tuple_is_yielded_in_one() -> None:
    cells = ((0, 0), (0, 1))
    assert drawn("paths", yields((cells,), (cells[:1],)), A, B) == [(cells,), (cells[:1],)]
    array = np.zeros(2)
    ((found,),) = drawn("paths", yields(array), A, B)
    assert found.value is array
    with pytest.raises(crow.FunctionError, match=r"yielded as `\(value,\)`"):
        drawn("paths", yields(cells), A, B)


@pytest.mark.parametrize(
    ("name", "python", "said"),
    [
        ("reach", yields((1, 2, 3)), "a vector of 3 elements"),
        ("reach", yields((1, float("nan"))), "`nan` is no value"),
        ("reach", yields(None), "`None` is no value of type `Spot`"),
        ("reach", yields(3), "`3` is no value"),
        ("reach", yields((np.ones((2, 2)),)), "an array of shape (2, 2)"),
        ("pairs", yields((1, 2)), "`1` is no value of type `Spot`"),
        ("pairs", yields(((1, 2),)), "a tuple of 2 (s, q) is wanted"),
        ("pairs", yields(((1, 2), 1, 2)), "a tuple of 2 (s, q) is wanted"),
        ("pairs", yields(None), "yielded `None`"),
        ("reach", lambda state, b: None, "returned `None`, where a generator yields"),
        ("reach", lambda state, b: 1 / 0, "raised ZeroDivisionError"),
        ("reach", lambda state, b: (1 / (1 - i) for i in range(2)), "`1.0` is no value"),
    ],
)
def test_what_is_no_tuple_of_outputs_is_an_error(name: str, python: Any, said: str) -> None:
    with pytest.raises(crow.FunctionError) as raised:
        drawn(name, python, "a")
    assert said in raised.value.reason
    assert raised.value.call == f"{name}(a)"
    assert raised.value.location is not None


def test_what_it_raises_after_some_values_comes_after_these() -> None:
    def reach(state: Any, b: str) -> Iterator[Any]:
        yield 1, 1
        raise LookupError("no more")

    solutions = generator("reach", reach).draw(problem(None).initial, ("a",))
    assert next(solutions) == ((1.0, 1.0),)
    with pytest.raises(crow.FunctionError) as raised:
        next(solutions)
    assert raised.value.traceback.count("File ") == 1
    assert "in reach" in raised.value.traceback


def test_it_is_called_as_far_as_it_is_asked() -> None:
    asked: list[int] = []
    endless = lambda state, b: ((asked.append(i) or i, 0) for i in count())  # noqa: E731
    solutions = generator("reach", endless).draw(problem(None).initial, ("a",))
    assert asked == []
    assert [spot for (spot,) in islice(solutions, 2)] == [(0.0, 0.0), (1.0, 0.0)]
    assert asked == [0, 1]
    solutions.close()


def test_one_may_yield_nothing() -> None:
    assert drawn("reach", yields(), "a") == []
    assert drawn("paths", lambda a, b: [], A, B) == []


def test_a_function_that_returns_a_list_is_no_generator_function_and_does() -> None:
    python = lambda state, b: [(1, 1), (2, 2)]  # noqa: E731
    assert not inspect.isgeneratorfunction(python)
    assert drawn("reach", python, "a") == [((1.0, 1.0),), ((2.0, 2.0),)]


# ------------------------------------------------------------------------------------------- batch


def batch(python: Any) -> Any:
    return crow.generator(batch=True)(python)


def test_batches_have_a_row_for_each_solution() -> None:
    state = problem(None).initial
    found = generator("reach", batch(yields(np.arange(6.0).reshape(3, 2), (np.ones((1, 2)),))))
    assert [len(rows) for rows in found.batches(state, ("a",))] == [3, 1]
    assert list(found.draw(state, ("a",))) == [
        ((0.0, 1.0),), ((2.0, 3.0),), ((4.0, 5.0),), ((1.0, 1.0),),
    ]  # fmt: skip
    pairs = generator("pairs", batch(yields((np.ones((2, 2)), ["x", "y"]))))
    assert list(pairs.draw(state, ("a",))) == [((1.0, 1.0), "x"), ((1.0, 1.0), "y")]


@pytest.mark.parametrize(
    ("yielded", "said"),
    [
        ((np.ones((2, 2)),), "yielded 1 arrays, where a tuple of 2"),
        ((np.ones((2, 2)), [1]), "do not have as many rows"),
        ((np.ones((2, 2)), 1), "do not have as many rows"),
        ((np.ones((2, 3)), [1, 1]), "an array of shape (3,)"),
        ((np.full((2, 2), np.nan), [1, 1]), "an array of shape (2,) is no value"),
    ],
)
def test_batches_of_the_wrong_shape_are_told(yielded: Any, said: str) -> None:
    with pytest.raises(crow.FunctionError) as raised:
        drawn("pairs", batch(yields(yielded)), "a")
    assert said in raised.value.reason


# ---------------------------------------------------------------------------------------- unknowns


def test_unknown_inputs_and_cells_keep_it_from_being_called() -> None:
    unknown = Unknown("s", problem(None).world.features["at"].type)

    def never(*_: Any) -> Any:
        raise AssertionError("called")

    initial = problem(None).initial
    blurred = replace(initial, cells={**initial.cells, ("at", ("b",)): unknown})
    for name, state, inputs in (
        ("paths", initial, (A, unknown)),
        ("reach", blurred, ("a",)),
    ):
        with pytest.raises(Touched):
            next(generator(name, never).draw(state, inputs))


def test_values_of_parameters_are_as_they_are_declared() -> None:
    seen: list[Any] = []
    python = lambda a, b: seen.append((a, b)) or []  # noqa: E731
    list(generator("paths", python).draw(State(), ((0, 1), (2, 3))))
    assert seen == [((0.0, 1.0), (2.0, 3.0))]
    assert type(seen[0][0][0]) is float
