"""What follows from constraints without any choice: unit rules, functions, equations (App. B.1)."""

import itertools
import math
from collections.abc import Mapping

import pytest
from posed import posed

from crow.calls import FunctionError
from crow.constraints import Conflict, Constraint, Store
from crow.program import FLOAT32, INT32
from crow.unknowns import Unknown
from crow.values import Value

BOOLEANS = "a, b, c, d: bool"


@pytest.mark.parametrize(
    ("conditions", "expected"),
    [
        ("a and b", {"a": True, "b": True}),
        ("not wanted: a or b", {"a": False, "b": False}),
        ("not (a or not b)", {"a": False, "b": True}),
        ("a or b\nnot a", {"a": False, "b": True}),
        ("not wanted: a and b\na", {"a": True, "b": False}),
        ("a ^ b\na", {"a": True, "b": False}),
        ("not wanted: a ^ b\nnot a", {"a": False, "b": False}),
        ("a == b\nb == c\nc", {"a": True, "b": True, "c": True}),
        ("a != b\nb", {"a": False, "b": True}),
        ("a == False", {"a": False}),
        ("True == a", {"a": True}),
        ("a ^ a or b", {"b": True}),
        ("a == a and b", {"b": True}),
        ("b if a else c\na", {"a": True, "b": True}),
        ("b if a else c\nnot b", {"a": False, "b": False, "c": True}),
        ("b if a else c\nnot c", {"a": True, "b": True, "c": False}),
        ("not wanted: b if a else c\nnot a", {"a": False, "c": False}),
        ("a or b or c or d\nnot a\nnot c\nnot d", {"a": False, "b": True, "c": False, "d": False}),
        ("(a and b) or (c and d)\nnot d", {"a": True, "b": True, "d": False}),
        ("(a or b) and (not a or b)\na", {"a": True, "b": True}),
        ("a or b", {}),
        ("a or not a or 1 / 0 > 1", {}),
    ],
)
def test_unit_rules(conditions: str, expected: Mapping[str, bool]) -> None:
    problem = posed(BOOLEANS, conditions)
    values = problem.store.values
    assert {n: values[u] for n, u in problem.unknowns.items() if u in values} == expected


@pytest.mark.parametrize(
    "conditions",
    [
        "a\nnot a", "a ^ a", "a != a", "a and b\nnot a or not b", "a == b\nb == c\na ^ c\na",
        "a or b\nnot a and not b", "b if a else c\nnot b\nnot c", "1 / 0 > 1",
        "not wanted: 1 / 0 > 1", "a and 1 / 0 > 1", "a\nnot a or 1 // 0 == 1",
    ],
)  # fmt: skip
def test_clashes_are_found(conditions: str) -> None:
    assert posed(BOOLEANS, conditions).conflict.core


@pytest.mark.parametrize(
    ("type_", "conditions", "expected"),
    [
        ("float64", "x + 1 == 3", 2.0),
        ("float64", "1 + x == 3", 2.0),
        ("float64", "3 == x - 1", 4.0),
        ("float64", "5 - x == 3", 2.0),
        ("float64", "x * 4 == 10", 2.5),
        ("float64", "0.5 * x == 10", 20.0),
        ("float64", "x / 4 == 10", 40.0),
        ("float64", "12 / x == 4", 3.0),
        ("float64", "-x == 4", -4.0),
        ("float64", "-(x + 1) * 2 == 4", -3.0),
        ("float64", "x + x == 4", 2.0),
        ("float64", "3 * x - 4 == x", 2.0),
        ("float64", "x == 10 - x", 5.0),
        ("float64", "(x - 1) / 4 + x == 1", 1.0),
        ("float64", "x + 0.1 == 0.3", 0.3 - 0.1),
        ("float64", "not wanted: x != 7", 7.0),
        ("int64", "x + 1 == 3", 2),
        ("int64", "x * 4 == 12", 3),
        ("int64", "x / 4 == 3", 12),
        ("int64", "12 / x == 4", 3),
        ("int64", "x == 3.0", 3),
        ("int64", "x * 1000000007 == 1000000014000000049", 1_000_000_007),
        ("int64", "2 * x == x + 5", 5),
        ("int64", "x >= 3 and x <= 3", 3),
        ("int64", "not wanted: x < 4\nx < 4.5", 4),
        ("string", 'x == "word"', "word"),
        ("vector[float64, 2]", "x == [1, 2]", (1.0, 2.0)),
        ("vector[float64, 2]", "x + [0.1, 1] == [0.3, 2]", (0.3 - 0.1, 1.0)),
        ("vector[float64, 2]", "[0.1, 1] + 2 * x == [0.3, 2]", None),
        ("vector[int64, 2]", "-x == [1, 2]", (-1, -2)),
        ("vector[int64, 2]", "x * 2 == [2, 4]", (1, 2)),
    ],
)
def test_equations_are_solved(type_: str, conditions: str, expected: Value) -> None:
    problem = posed(f"x: {type_}", conditions)
    (found,) = problem.found()
    if expected is not None:
        assert found["x"] == expected
        assert type(found["x"]) is type(expected)
    assert problem.solutions().nodes == 0


@pytest.mark.parametrize(
    ("type_", "conditions"),
    [
        ("int64", "x * 4 == 10"),
        ("int64", "x == 2.5"),
        ("int64", "5 / x == 2"),
        ("int64", "x == 9000000000 * 2000000000"),
        ("int32", "x - 1 == 2147483647"),
        ("float64", "x * 0 == 1"),
        ("float64", "x - x == 1"),
        ("float64", "1 / x == 0"),
        ("float64", "x + 1 == x"),
        ("int64", "x > 3 and x < 4"),
        ("vector[int64, 2]", "x * 2 == [2, 3]"),
    ],
)
def test_equations_without_solution_clash(type_: str, conditions: str) -> None:
    assert posed(f"x: {type_}", conditions).conflict.core


@pytest.mark.parametrize("conditions", ["x * 0 == 0", "x == x", "x + y == 3", "x // 2 == 1"])
def test_equations_that_do_not_say_what_is_equal_stay_open(conditions: str) -> None:
    assert not posed("x, y: float64", conditions).store.values


def test_vectors_are_solved_by_their_elements() -> None:
    problem = posed("x, y: float64; v: vector[float64, 2]", "[x, y + 1] == [3, 5]\nv == [y, x]")
    assert problem.found() == [{"x": 3.0, "y": 4.0, "v": (4.0, 3.0)}]
    problem = posed("x, y: float64; v: vector[float64, 2]", "v == [3, 5]\nv == [x, y] * 2 + [1, 1]")
    assert problem.found() == [{"x": 1.0, "y": 2.0, "v": (3.0, 5.0)}]
    assert posed("x: float64", "[x, 1] == [3, 2]").conflict.core


FUNCTIONS = """
typedef spot
def twice(x: float64) -> float64
def near(x: float64, y: float64) -> bool
def [[reads=height]] tall(s: spot) -> bool
def [[reads=height]] rise(s: spot, x: float64) -> float64
def middle(x: float64, y: float64): return (x + y) / 2 > 3
def sign(x: float64) -> int64:
  if x < 0: return -1
  return 1
feature height(s: spot) -> float64
feature width(s: spot) -> float64
"""
PYTHON = {
    "twice": lambda x: 2 * x,
    "near": lambda x, y: abs(x - y) < 1,
    "tall": lambda state, s: state.height(s) > 2,
    "rise": lambda state, s, x: state.height(s) + x,
}


def test_functions_are_computed_as_soon_as_their_arguments_are_known() -> None:
    problem = posed(
        "x, y, z: float64", "y == twice(x)\nz == twice(y) + 1\nx == 3", FUNCTIONS, functions=PYTHON
    )
    assert problem.found() == [{"x": 3.0, "y": 6.0, "z": 13.0}]
    clash = posed(
        "x, y: float64", "near(x, y)\nx == 1\ny == 5", FUNCTIONS, functions=PYTHON
    ).conflict
    assert [c.text for c in clash.core] == ["near(x, y)", "x == 1", "y == 5"]


def test_derived_functions_are_unfolded_or_run() -> None:
    problem = posed("x, y: float64; n: int64", "middle(x, 4)\nn == sign(x)\nx == 5", FUNCTIONS)
    assert problem.found() == [{"x": 5.0, "n": 1}]
    assert posed("x, y: float64", "middle(x, y)\nx == 1\ny == 2", FUNCTIONS).conflict.core


def test_what_reads_the_state_waits_for_the_cells_it_reads_and_no_others() -> None:
    def store(cells: dict[str, tuple[str, ...]]) -> Store:
        return posed(
            "h, r: float64; s: spot",
            "tall(s)\nr == rise(s, 1)",
            FUNCTIONS,
            objects="a: spot",
            init="height[a] = 3",
            functions=PYTHON,
            cells=cells,
            known={"s": "a"},
        ).store

    assert len(store({"h": ("width", "a")}).open) == 0
    waiting = store({"h": ("height", "a")})
    assert len(waiting.open) == 2
    (height,) = {u for r in waiting.pending for u in r.unknowns if u.name == "h"}
    done = waiting.assigned(height, 5)
    assert isinstance(done, Store)
    assert sorted(done.values.values()) == [5.0, 6.0]
    assert isinstance(waiting.assigned(height, 1), Conflict)


def test_reads_of_unknown_objects_and_cells() -> None:
    problem = posed(
        "s: spot; w: float64",
        "height(s) > 4\nw == height(s) + width(s)",
        FUNCTIONS,
        objects="a, b, c: spot",
        init="height[a] = 1; height[b] = 5; height[c] = 3; width[b] = 2",
    )
    assert problem.found() == [{"s": "b", "w": 7.0}]
    problem = posed(
        "w: float64; s: spot", "width(s) - 1 == height(s)", FUNCTIONS, objects="a: spot",
        init="height[a] = 1", cells={"w": ("width", "a")}, known={"s": "a"},
    )  # fmt: skip
    assert problem.found() == [{"w": 2.0}]


def test_quantifiers_range_over_objects() -> None:
    problem = posed(
        "x: float64", "forall s: spot: height(s) < x or s == s and width(s) > 0\nx == 4", FUNCTIONS,
        objects="a, b: spot", init="height[a] = 1; height[b] = 5; width[b] = 2",
    )  # fmt: skip
    assert problem.found() == [{"x": 4.0}]
    clash = posed(
        "x: float64", "exists s: spot: height(s) > x\nx == 6", FUNCTIONS,
        objects="a, b: spot", init="height[a] = 1; height[b] = 5",
    )  # fmt: skip
    assert clash.conflict.core


# ----------------------------------------------------------------------------------- what may fail


def test_what_is_guarded_is_not_needed() -> None:
    assert posed("x: int64", "x == 0 or 5 // x == 2\nx == 0").found() == [{"x": 0}]
    assert posed("x: int64", "x == 0\nx != 0 and 5 // x == 2").conflict.core
    assert posed("b: bool", "b or 5 // 0 == 1").found() == [{"b": True}]


def test_what_fails_before_it_is_decided_fails() -> None:
    """`5 // x == 2 or b` has no value for x = 0, though b is true: the interpreter agrees."""
    problem = posed("x: int64; b: bool", "5 // x == 2 or b\nx == 0\nb")
    assert "division by zero" in problem.conflict.reason
    assert posed("x: int64; b: bool", "5 // x == 2 or b\nx == 1\nb").found() == [
        {"x": 1, "b": True}
    ]


def test_python_that_fails_is_told_unless_it_is_guarded() -> None:
    def fails(x: float, y: float) -> bool:
        raise KeyError("nothing there")

    python = {**PYTHON, "near": fails}
    with pytest.raises(FunctionError, match="nothing there"):
        posed("x: float64", "near(x, 1)\nx == 1", FUNCTIONS, functions=python).found()
    guarded = posed(
        "x: float64; b: bool", "b or near(x, 1)\nx == 1\nb", FUNCTIONS, functions=python
    )
    assert guarded.found() == [{"x": 1.0, "b": True}]
    for wrong in (math.nan, "no number", (1.0, 2.0)):
        broken = {**PYTHON, "twice": lambda x, wrong=wrong: wrong}
        with pytest.raises(FunctionError, match="twice"):
            posed("x: float64", "twice(x) > 1\nx == 1", FUNCTIONS, functions=broken).found()


def test_a_function_without_python_cannot_be_met() -> None:
    clash = posed("x: float64", "twice(x) > 1", FUNCTIONS).conflict
    assert "no Python given" in clash.reason


# ------------------------------------------------------------------------------------- definitions


def test_a_definition_rounds_as_the_cell_it_is_for() -> None:
    """`f_t(o) = g(…)` of App. B, for a float32 cell."""
    problem = posed("x, y: float64", "x + 0.1 > 0")
    cell = Unknown("cell", FLOAT32)
    (condition,) = problem.constraints
    value = posed("x: float64", "x + 0.1 > 0").constraints[0].condition.left  # type: ignore[union-attr]
    definition = Constraint(value, condition.variables, condition.state, defined=cell)
    store = problem.store.having(definition)
    assert isinstance(store, Store)
    found = store.assigned(problem.unknowns["x"], 0.2)
    assert isinstance(found, Store)
    assert found.values[cell] == pytest.approx(0.3)
    assert found.values[cell] != 0.2 + 0.1
    assert not found.pending
    too_small = Constraint(value, condition.variables, condition.state, defined=Unknown("n", INT32))
    assert isinstance(
        problem.store.having(too_small).assigned(problem.unknowns["x"], 0.2), Conflict
    )  # type: ignore[union-attr]


# ------------------------------------------------------------------------------------------- cores


def test_a_core_names_what_clashes_and_nothing_else() -> None:
    problem = posed(
        "x, y, z, w: float64; b: bool",
        "w > 3\nx == 1\ny == x + 1\nz == y + 1\nb or w > 2\nz < 2.5\nw < 10",
    )
    conflict = problem.conflict
    assert [c.text for c in conflict.core] == ["x == 1", "y == x + 1", "z == y + 1", "z < 2.5"]
    assert all(c.place is not None for c in conflict.core)
    assert "domain.cdl:2:" in str(conflict)


def test_a_core_tells_the_values_that_were_chosen() -> None:
    problem = posed("x, y, z: float64", "x + y == 3\ny < 2\nz > 0")
    store = problem.store.assigned(problem.unknowns["z"], 1)
    assert isinstance(store, Store)
    conflict = store.assigned(problem.unknowns["x"], 0.5)
    assert isinstance(conflict, Conflict)
    assert [c.text for c in conflict.core] == ["x + y == 3", "y < 2"]
    assert conflict.values == {problem.unknowns["x"]: 0.5}
    assert "x = 0.5" in str(conflict)


def test_bounds_of_an_integer_clash_together() -> None:
    conflict = posed("x, y: int64", "x > 3\ny > 2\nx < 2").conflict
    assert [c.text for c in conflict.core] == ["x > 3", "x < 2"]


def test_a_value_of_another_type_is_no_value() -> None:
    problem = posed("x: int64; s: spot", "x > 0\nheight(s) > 1", FUNCTIONS, objects="a: spot")
    for name, value in (("x", 2.5), ("x", 2**70), ("s", "nobody")):
        assert isinstance(problem.store.assigned(problem.unknowns[name], value), Conflict)


# --------------------------------------------------------------------------------------- immutable


def test_stores_are_left_as_they_were() -> None:
    problem = posed("x, y: float64", "x + y == 3\ny < 5")
    store = problem.store
    first, second = (store.assigned(problem.unknowns["x"], v) for v in (1, 2))
    assert isinstance(first, Store)
    assert isinstance(second, Store)
    assert not store.values
    assert len(store.open) == 2
    assert (first.values[problem.unknowns["y"]], second.values[problem.unknowns["y"]]) == (2.0, 1.0)


def test_a_chain_of_two_thousand_equations_is_computed() -> None:
    names = [f"x{i}" for i in range(2_000)]
    links = [f"{b} == {a} + 1" for a, b in itertools.pairwise(names)]
    problem = posed(f"{', '.join(names)}: int64", ["x0 == 0", *links])
    found = problem.store.values
    assert not problem.store.pending
    assert found[problem.unknowns["x1999"]] == 1_999


def test_what_a_computation_stops_at_may_come_later() -> None:
    domain = """
    typedef spot
    feature height(s: spot) -> float64
    feature next(s: spot) -> spot
    def rank(s: spot, t: spot) -> int64:
      if height(s) > 1:
        if height(t) > 2:
          return 2
        return 1
      return 0
    """
    cells = {"x": ("height", "a"), "y": ("height", "b"), "s": ("next", "a")}
    problem = posed(
        "x, y: float64; s, a, b: spot; n: int64",
        "n == rank(a, b)\nx == 3\ny == x\nheight(next(next(a))) > 2",
        domain, objects="a, b: spot", init="next[b] = b; next[a] = a", cells=cells,
        known={"a": "a", "b": "b"},
    )  # fmt: skip
    assert [f | {"n": 2} for f in problem.found()] == problem.found()
    assert [f["s"] for f in problem.found()] == ["a", "b"]
    clash = posed(
        "x: float64; a: spot", "x == 3\nrank(a, a) == 1", domain, objects="a: spot",
        init="next[a] = a", cells={"x": ("height", "a")}, known={"a": "a"},
    ).conflict  # fmt: skip
    assert [c.text for c in clash.core] == ["x == 3", "rank(a, a) == 1"]
