"""Many candidates in one call: what is let pass is what would pass one by one (semantics.md §4)."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from posed import Posed, posed

from crow.calls import FunctionError
from crow.constraints import Store
from crow.constraints.batches import survivors
from crow.functions import function, generator

DOMAIN = """
typedef pose: vector[float64, 2]
typedef path: pyobject
def free(p: pose, r: float64) -> bool
def slow(p: pose) -> bool
def road() -> path
def off(p: pose, t: path) -> bool
def cost(p: pose) -> float64
generator gen_free(p, r):
  goal: free(p, r)
  in: r
  out: p
"""
CALLS: list[int] = []


@function(vectorized=True)
def free(p: Any, r: Any) -> Any:
    CALLS.append(len(p))
    return np.hypot(p[:, 0], p[:, 1]) > r


@function(vectorized=True)
def cost(p: Any) -> Any:
    return p.sum(axis=1)


def batches(size: int) -> Any:
    @generator(batch=True)
    def gen_free(r: float, *, rng: np.random.Generator) -> Iterator[Any]:
        while True:
            yield rng.uniform(-10, 10, (size, 2))

    return gen_free


def problem(conditions: str, size: int = 1_000, **functions: Any) -> Posed:
    python = {"free": free, "cost": cost, "gen_free": batches(size),
              "slow": lambda p: p[0] < p[1], **functions}  # fmt: skip
    return posed("p: pose; r: float64; b: bool", conditions, DOMAIN, functions=python)


def test_a_thousand_candidates_are_tested_in_one_call() -> None:
    CALLS.clear()
    own = problem("cost(p) > 14\nfree(p, r)\nr == 9\nslow(p)\np - [1, 1] != [2, 3]")
    solver = own.solver(limit=100_000)
    solution = own.checked(next(solver.solutions(own.store)))
    assert sum(solution["p"]) > 14
    assert CALLS[0] < 1_000  # those that `cost` lets pass
    told = solver.source.statistics()["gen_free"]
    assert told["yielded"] >= 1_000
    assert sum(told["rejected"].values()) > 900


@pytest.mark.parametrize("road", [(1.0, 2.0), ((0.0, 1.0), (2.0, 3.0)), [4.0]])
def test_opaque_values_are_columns_of_what_they_are(road: Any) -> None:
    seen = []

    @function(vectorized=True)
    def off(p: Any, t: Any) -> Any:
        seen.append(len(p))
        assert t.shape == (len(p),)
        assert all(one == road for one in t)
        return p[:, 0] > 0

    own = problem("free(p, r)\nr == 0\noff(p, road())", 100, off=off, road=lambda: road)
    solution = own.checked(next(own.solver().solutions(own.store)))
    assert solution["p"][0] > 0
    assert seen[0] == 100


def test_the_limit_counts_candidates() -> None:
    own = problem("free(p, r)\nr == 1\ncost(p) > 100")
    solver = own.solver(limit=2_500)
    solutions = solver.solutions(own.store)
    assert next(solutions, None) is None
    assert solver.source.statistics()["gen_free"]["yielded"] == 2_500
    assert {cut.kind for cut in solutions.cuts} == {"limit"}


def test_each_survivor_is_found_once_in_some_round() -> None:
    @generator(batch=True, complete=True)
    def grid(r: float) -> Iterator[Any]:
        for x in range(8):
            yield np.array([[x, y] for y in range(8)])

    own = problem("free(p, r)\nr == 5\ncost(p) < 9", gen_free=grid)
    solutions = own.solutions()
    found = [own.checked(s)["p"] for s in solutions]
    expected = [(float(x), float(y)) for x in range(8) for y in range(8)
                if np.hypot(x, y) > 5 and x + y < 9]  # fmt: skip
    assert sorted(found) == expected
    assert solutions.is_proved


@pytest.mark.parametrize(
    "wrong",
    [
        np.array([[1.0, np.nan]]),
        np.array([[1.0, 2.0, 3.0]]),
        np.array([1.0, 2.0]),
        np.array([["a", "b"]]),
        (np.zeros((2, 2)), np.zeros((2, 2))),
        3.0,
    ],
)
def test_arrays_of_the_wrong_kind_are_errors_that_name_the_generator(wrong: Any) -> None:
    own = problem("free(p, r)\nr == 0", gen_free=generator(batch=True)(lambda r: iter([wrong])))
    with pytest.raises(FunctionError, match="gen_free"):
        own.found()


@pytest.mark.parametrize("wrong", [True, np.zeros(3), np.array([[True]])])
def test_results_of_the_wrong_number_are_errors_that_name_the_function(wrong: Any) -> None:
    own = problem("free(p, r)\nr == 0", 10, free=function(vectorized=True)(lambda p, r: wrong))
    with pytest.raises(FunctionError, match="free"):
        own.found()


# ------------------------------------------------------------------- the same as one by one

TERMS = (
    "x + y > {k}", "x * y <= {k}", "x - {k} != y", "x / y < {k}", "-x >= y - {k}", "x == y",
    "abs(x) > {k} and not (y > 1)", "x > {k} or y < 0", "(x > 0) ^ (y > {k})", "n * 2 > {k}",
    "n // 2 == {k}", "n % 3 == {k}", "min(x, y) < {k} < max(x, y, n)", "(x if n > 1 else y) > {k}",
    "v == [x, y]", "v + [1, {k}] != [x, 0]", "v * n == [{k}, 2]", "x + n == {k}", "n * n == {k}",
    "x ** 2 > {k}", "n > {k} and v != [1, 1]", "v / y != [0, {k}]", "(v if x > y else [x, x]) == v",
)  # fmt: skip
integers = st.integers(-3, 3) | st.just(2**62)
numbers = st.sampled_from([0.0, 1.0, -1.0, 2.0, 0.5, -2.5, 1e308, 3.0])


@given(
    st.lists(st.tuples(st.sampled_from(TERMS), st.integers(-1, 3)), min_size=1, max_size=3),
    st.lists(st.tuples(numbers, numbers, numbers, integers), min_size=1, max_size=8),
    st.booleans(),
)
def test_rows_that_pass_one_by_one_are_let_pass(
    texts: list[tuple[str, int]], rows: list[tuple[float, float, float, int]], negate: bool
) -> None:
    lines = [text.format(k=k) for text, k in texts]
    lines = [f"not wanted: {line}" if negate else line for line in lines]
    own = posed("x, y: float64; n: int64; v: vector[float64, 2]", lines)
    store = Store.of(own.world).having(*own.constraints)
    if not isinstance(store, Store):
        return
    x, y, n, v = (own.unknowns[name] for name in "xynv")
    table = np.array([row[:3] for row in rows])
    columns = {x: table[:, 0], y: table[:, 1], v: table[:, 1:], n: np.array([r[3] for r in rows])}
    passing = survivors(store, columns)
    for index, row in enumerate(rows):
        values = {x: row[0], y: row[1], n: row[3], v: (row[1], row[2])}
        after: Any = store
        for unknown, value in values.items():
            after = after.assigned(unknown, value) if isinstance(after, Store) else after
        if isinstance(after, Store):
            assert index in passing.rows
    assert len(rows) == len(passing.rows) + sum(passing.rejected.values())
