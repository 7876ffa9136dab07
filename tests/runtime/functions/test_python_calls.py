"""Calls of external functions: what goes out, what comes back, and what goes wrong."""

from typing import Any

import numpy as np
import pytest
from small_program import problem

import crow
from crow.calls import part_read
from crow.evaluate import EvaluationError, evaluate
from crow.program import INT32, Apply, Constant
from crow.unknowns import Touched, Unknown
from crow.values import Opaque

PATHS = {"path": lambda a, b: (a, b), "middle": lambda a, b: a}
CELLS = problem(None).initial.cells


def call(name: str, python: Any, *arguments: Any, cells: Any = CELLS) -> Any:
    return problem({name: python}).world.externals.functions[name].value(cells, arguments)


class Curve:
    """A value that only Python knows."""


@pytest.mark.parametrize(
    ("name", "arguments", "given", "value"),
    [
        ("heavy", ("a",), True, True),
        ("heavy", ("a",), np.True_, True),
        ("weight", ("a", 1), 2, 2.0),
        ("weight", ("a", 1), np.float32(0.5), 0.5),
        ("weight", ("a", 1), np.array(7), 7.0),
        ("middle", ((0.0, 0.0), (2.0, 2.0)), (1, 1.5), (1.0, 1.5)),
        ("middle", ((0.0, 0.0), (2.0, 2.0)), [np.int64(1), 1], (1.0, 1.0)),
        ("middle", ((0.0, 0.0), (2.0, 2.0)), np.array([1.0, 2.0]), (1.0, 2.0)),
        ("name_of", ("a",), "x", "x"),
        ("nearest", ("a",), "table", "table"),
    ],
)
def test_values_come_back_as_the_program_has_them(
    name: str, arguments: Any, given: Any, value: Any
) -> None:
    found = call(name, lambda *_: given, *arguments)
    assert found == value
    assert type(found) is type(value)
    if isinstance(found, tuple):
        assert all(type(part) is float for part in found)


@pytest.mark.parametrize(
    ("name", "arguments", "given", "said"),
    [
        ("heavy", ("a",), None, "`None` is no value of type `bool`"),
        ("heavy", ("a",), 1, "`1` is no value of type `bool`"),
        ("weight", ("a", 1), float("nan"), "`nan` is no value"),
        ("weight", ("a", 1), np.inf, "`inf` is no value"),
        ("weight", ("a", 1), "1", "`'1'` is no value"),
        ("weight", ("a", 1), True, "`True` is no value"),
        ("weight", ("a", 1), np.ones(1), "an array of shape (1,) is no value of type `float32`"),
        ("middle", ((0.0, 0.0), (1.0, 1.0)), (1.0,), "a vector of 1 elements"),
        ("middle", ((0.0, 0.0), (1.0, 1.0)), np.ones((2, 1)), "an array of shape (2, 1)"),
        ("middle", ((0.0, 0.0), (1.0, 1.0)), (1.0, float("nan")), "`nan` is no value"),
        ("middle", ((0.0, 0.0), (1.0, 1.0)), 3, "`3` is no value of type `Spot`"),
        ("nearest", ("a",), "tabel", "no object `tabel`"),
        ("name_of", ("a",), 3, "`3` is no value of type `string`"),
    ],
)
def test_what_is_no_value_of_the_type_is_an_error(
    name: str, arguments: Any, given: Any, said: str
) -> None:
    with pytest.raises(crow.FunctionError) as raised:
        call(name, lambda *_: given, *arguments)
    assert said in raised.value.reason
    assert raised.value.name == name


def test_arguments_go_out_as_python_has_them() -> None:
    seen: list[Any] = []

    def weight(*given: Any) -> float:
        seen.append(given)
        return 0.0

    call("weight", weight, "a", 3)
    call("middle", lambda *given: seen.append(given) or (0, 0), (0, 1.5), (2.0, 3.0))
    assert seen == [("a", 3), ((0.0, 1.5), (2.0, 3.0))]
    assert type(seen[1][0][0]) is float


def test_opaque_values_are_passed_on_as_they_are() -> None:
    curve, array, nothing = Curve(), np.zeros(3), None
    one, two, three = (
        call("path", lambda *_, value=value: value, (0, 0), (1, 1))
        for value in (curve, array, nothing)
    )
    assert one is curve
    assert isinstance(two, Opaque)
    assert two.value is array
    assert two == Opaque(array) == array
    assert two != Opaque(np.zeros(3))
    assert isinstance(three, Opaque)  # None would be no value
    assert {two: 1}[Opaque(array)] == 1


def test_what_was_asked_is_not_asked_again() -> None:
    asked: list[Any] = []
    functions = problem({"heavy": lambda b: asked.append(b) or len(asked) > 1}).world.externals
    heavy = functions.functions["heavy"]
    first = [heavy.value({}, (b,)) for b in "aabab"]
    assert asked == ["a", "b"]
    assert first == [False, False, True, False, True]


def test_only_cells_that_are_read_make_a_call_another() -> None:
    asked: list[Any] = []
    world = problem({"free": lambda state, b: not asked.append(b)}).world
    free = world.externals.functions["free"]
    cells = dict(CELLS)
    free.value(cells, ("a",))
    free.value({**cells, ("on", ("a",)): "b"}, ("a",))
    assert len(asked) == 1
    free.value({**cells, ("at", ("b",)): (3.0, 3.0)}, ("a",))
    assert len(asked) == 2


def test_exceptions_are_told_with_the_users_own_traceback() -> None:
    def inner() -> None:
        raise LookupError("no weight")

    def weight(b: str, n: int) -> float:
        inner()
        return 1.0

    made = problem({"weight": weight})
    node = Apply("weight", (Constant("a", INT32), Constant(1, INT32)), INT32)
    with pytest.raises(crow.FunctionError) as raised:
        evaluate(made.world, made.initial, node, {})
    error = raised.value
    assert error.call == "weight(a, 1)"
    assert error.reason == "raised LookupError: no weight"
    assert error.traceback.startswith("Traceback (most recent call last):\n")
    assert error.traceback.count("File ") == 2
    assert "in inner" in error.traceback
    assert error.__cause__ is None
    assert error.__suppress_context__


def test_a_place_is_told_where_there_is_one() -> None:
    made = problem({**PATHS, "free": lambda state, b: 1 / 0})
    with pytest.raises(crow.FunctionError, match=r"domain.cdl:29:12: `free\(a\)` raised") as raised:
        crow.plan(made)
    assert raised.value.location is not None


def test_an_argument_out_of_range_is_no_fault_of_python() -> None:
    made = problem({"weight": lambda b, n: 1.0})
    node = Apply("weight", (Constant("a", INT32), Constant(1 << 40, INT32)), INT32)
    with pytest.raises(EvaluationError, match="does not fit into `int32`"):
        evaluate(made.world, made.initial, node, {})


@pytest.mark.parametrize("limit", [KeyboardInterrupt, MemoryError, SystemExit])
def test_what_ends_the_program_passes_through(limit: type[BaseException]) -> None:
    def heavy(b: str) -> bool:
        raise limit

    with pytest.raises(limit):
        call("heavy", heavy, "a")


# -------------------------------------------------------------------------------------- vectorized


def test_a_vectorized_function_is_called_once_for_many() -> None:
    seen: list[Any] = []

    @crow.function("middle", vectorized=True)
    def middle(a: Any, b: Any) -> Any:
        seen.append((a.shape, b.dtype))
        return (a + b) / 2

    function = problem({"middle": middle}).world.externals.functions["middle"]
    rows = [((0, 0), (2, 2)), ((1, 0), (1, 0)), ((0, 0), (2, 2))]
    assert function.values({}, rows) == [(1.0, 1.0), (1.0, 0.0), (1.0, 1.0)]
    assert function.value({}, ((0, 0), (2, 2))) == (1.0, 1.0)
    assert seen == [((2, 2), np.dtype("float64"))]
    assert function.values({}, [((5, 5), (7, 7))]) == [(6.0, 6.0)]


def test_objects_and_numbers_of_a_vectorized_function_are_columns() -> None:
    @crow.function(vectorized=True)
    def weight(b: Any, n: Any) -> Any:
        assert b.dtype == object
        return np.where(b == "a", n, 2 * n)

    function = problem({"weight": weight}).world.externals.functions["weight"]
    assert function.values({}, [("a", 3), ("b", 3)]) == [3.0, 6.0]


def test_opaque_values_of_a_vectorized_function_stay_what_they_are() -> None:
    seen: list[Any] = []

    @crow.function(vectorized=True)
    def both(b: Any, s: Any, q: Any) -> Any:
        seen.extend([s.shape, q.shape, *q])
        return [True] * len(q)

    function = problem({"both": both}).world.externals.functions["both"]
    paths = [((0.0, 1.0), (2.0, 3.0)), (4.0, 5.0)]
    for path in paths:
        function.values({}, [("a", (0.0, 0.0), path)] * 2)
        function.values({}, [("b", (0.0, 0.0), path), ("a", (1.0, 1.0), path)])
    assert [one for one in seen if one not in paths] == [(1, 2), (1,), (2, 2), (2,)] * 2


def test_a_vectorized_function_may_read_the_state() -> None:
    @crow.function(vectorized=True)
    def free(state: Any, b: Any) -> Any:
        return [not state.held(name) for name in b]

    function = problem({"free": free}).world.externals.functions["free"]
    assert function.values(CELLS, [("a",), ("b",)]) == [True, False]


@pytest.mark.parametrize(
    ("result", "said"),
    [
        (lambda n: np.ones(len(n) + 1), "gave 3 results for 2 candidates"),
        (lambda n: 1.0, "gave `1.0` for 2 candidates"),
        (lambda n: np.full(len(n), np.nan), "no value of type `float32`"),
        (lambda n: np.ones((len(n), 1)), "an array of shape (1,)"),
    ],
)
def test_results_of_the_wrong_shape_are_told(result: Any, said: str) -> None:
    weight = crow.function("weight", vectorized=True)(lambda b, n: result(n))
    function = problem({"weight": weight}).world.externals.functions["weight"]
    with pytest.raises(crow.FunctionError) as raised:
        function.values({}, [("a", 1), ("b", 2)])
    assert said in raised.value.reason


def test_many_calls_of_a_plain_function_are_calls_one_by_one() -> None:
    function = problem({"heavy": lambda b: b == "a"}).world.externals.functions["heavy"]
    assert function.values({}, [("a",), ("b",)]) == [True, False]


# ---------------------------------------------------------------------------------------- unknowns


def test_python_never_sees_an_unknown() -> None:
    unknown = Unknown("s", problem(None).world.features["at"].type)

    def never(*_: object) -> bool:
        raise AssertionError("called")

    world = problem({"free": never, "middle": never, "steady": never}).world
    functions = world.externals.functions
    for _ in range(2):
        for name, arguments, cells in (
            ("middle", (unknown, (0.0, 0.0)), {}),
            ("free", ("a",), {("at", ("b",)): unknown}),
            ("steady", (), {("last", ()): unknown}),
        ):
            with pytest.raises(Touched) as raised:
                functions[name].value(cells, arguments)
            assert raised.value.unknown is unknown


def test_an_unknown_in_a_cell_that_is_not_read_does_no_harm() -> None:
    unknown = Unknown("p", problem(None).world.features["last"].type)
    assert call("free", lambda state, b: True, "a", cells={("last", ()): unknown}) is True
    assert part_read({("last", ()): unknown}, frozenset(("at",))) == frozenset()
