"""Branching, draws, rounds and backtracking (App. B.1), and what is said where nothing is found."""

import math
from collections.abc import Iterator
from itertools import count, islice, pairwise, product
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from posed import Posed, posed

from crow.budget import Budget, Stopped
from crow.calls import FixedCells, FunctionError
from crow.constraints import Store
from crow.functions import generator

# -------------------------------------------------------------------------------- finite domains


def test_truth_values_objects_and_bounded_integers_are_tried() -> None:
    domain = "typedef spot\nfeature on(s: spot, t: spot)\n"
    problem = posed(
        "a, b: bool; s, t: spot; n: int64",
        "a ^ b\non(s, t)\nn >= 2 and n < 6\nn * n > 10 and n % 2 == 1 or n % 4 == 0",
        domain, objects="p, q, r: spot", init="on[p, q] = True; on[r, p] = True",
    )  # fmt: skip
    found = problem.found()
    expected = [
        {"a": a, "b": not a, "s": s, "t": t, "n": n}
        for a, (s, t), n in product((True, False), (("p", "q"), ("r", "p")), (4, 5))
    ]
    assert sorted(map(str, found)) == sorted(map(str, expected))


def test_a_disjunction_over_other_variables_is_split() -> None:
    problem = posed(
        "x, y: float64",
        "x + 1 == 2 or x == 5\nx > 3 or y == x\nnot (x == 5 and y > 2)\ny == 1 or y == 3",
    )
    assert sorted((f["x"], f["y"]) for f in problem.found()) == [(1.0, 1.0), (5.0, 1.0)]


def test_a_conditional_is_split() -> None:
    problem = posed("x: int64; b: bool", "(x == 1 if b else x == 2)\nx + (3 if b else 4) == 6")
    assert problem.found() == [{"x": 2, "b": False}]


def test_unsatisfiable_is_proved_with_a_core() -> None:
    problem = posed(
        "a, b, c, d: bool", "c or d\na or b\na or not b\nnot a or b\nnot a or not b\nd or not c"
    )
    solutions = problem.solutions()
    assert next(solutions, None) is None
    assert solutions.is_proved
    core = solutions.core()
    assert [c.text for c in core.core] == ["a or b", "a or not b", "not a or b", "not a or not b"]


# ------------------------------------------------------------------------------------ generators

LINE = """
def close(a: float64, b: float64) -> bool
def spot(x: float64) -> bool
def half(x: float64) -> float64
generator gen_close(a, b):
  goal: close(a, b)
  in: a
  out: b
generator gen_spot(x):
  goal: spot(x)
  in:
  out: x
generator gen_half(x, y):
  goal: half(x) = y
  in: y
  out: x
generator gen_far(a, b):
  goal: not close(a, b)
  in: b
  out: a
"""


def line(conditions: str, variables: str = "x, y, z: float64", **functions: Any) -> Posed:
    given = {
        "close": lambda a, b: abs(a - b) <= 1,
        "spot": lambda x: x == int(x) and 0 <= x < 10,
        "half": lambda x: x / 2,
        **functions,
    }
    return posed(variables, conditions, LINE, functions=given)


@generator
def near(a: float, *, rng: np.random.Generator) -> Iterator[float]:
    while True:
        yield a + rng.uniform(-1, 1)


@generator(complete=True)
def spots() -> Iterator[float]:
    yield from map(float, range(10))


def test_a_generator_for_a_literal_gives_values() -> None:
    problem = line("close(x, y)\nclose(y, z)\nx == 0\nz > 1.5", gen_close=near)
    solver = problem.solver()
    for solution in islice(solver.solutions(problem.store), 5):
        found = problem.checked(solution)
        assert found["x"] == 0
        assert found["z"] > 1.5
    told = solver.source.statistics()["gen_close"]
    assert told["yielded"] >= 5
    assert "z > 1.5" in str(told["rejected"])


def test_polarity_and_equations_in_either_orientation_are_matched() -> None:
    far = generator(lambda b: iter([b + 5.0]))
    assert line("not close(x, y)\ny == 1", "x, y: float64", gen_far=far).found() == [
        {"x": 6.0, "y": 1.0}
    ]
    double = generator(complete=True)(lambda y: iter([2 * y]))
    for condition in (
        "half(x) == y",
        "y == half(x)",
        "not half(x) != y",
        "half(x) + 0 == half(x) and half(x) == y",
    ):
        problem = line(f"{condition}\ny == 4", "x, y: float64", gen_half=double)
        assert problem.found() == [{"x": 8.0, "y": 4.0}]
    problem = line("half(x) == y\nx == 3", "x, y: float64", gen_half=double)
    assert problem.found() == [{"x": 3.0, "y": 1.5}]
    assert problem.solver().source.statistics() == {}


def test_an_output_may_be_an_expression() -> None:
    problem = line("half(x + 1) == y\ny == 4", "x, y: float64",
                   gen_half=generator(lambda y: iter([2 * y])))  # fmt: skip
    assert problem.found() == [{"x": 7.0, "y": 4.0}]


def test_repeated_parameters_constants_and_types_of_objects_have_to_fit() -> None:
    domain = """
    typedef spot
    typedef place: spot
    def link(s: spot, t: spot, n: int64, x: float64) -> bool
    generator same(s: spot, x):
      goal: link(s, s, 1, x)
      in: s
      out: x
    generator only(s: place, t: spot, x):
      goal: link(s, t, 2, x)
      in: s, t
      out: x
    """
    python = {
        "link": lambda s, t, n, x: True,
        "same": generator(lambda s: iter([1.0])),
        "only": generator(lambda s, t: iter([2.0])),
    }

    def values(condition: str) -> list[float]:
        return [f["x"] for f in posed(
            "x: float64; s: spot; t: spot; p: place", condition, domain,
            objects="a, b: spot; c: place", functions=python, known={"s": "a", "t": "b", "p": "c"},
        ).found()]  # fmt: skip

    assert values("link(s, s, 1, x)") == [1.0]
    assert values("link(s, t, 1, x)") == []
    assert values("link(s, s, 2, x)") == []
    assert values("link(p, t, 2, x)") == [2.0]
    assert values("link(p, t, 1 + 1, x)") == [2.0]


def test_derived_functions_and_comparisons_as_goals() -> None:
    domain = """
    def size(x: float64) -> float64
    def fits(x: float64): return size(x) < 3 and x > 0
    generator gen_fits(x):
      goal: fits(x)
      in:
      out: x
    generator gen_size(x, y):
      goal: size(x) < y
      in: y
      out: x
    """
    python = {
        "size": lambda x: x + 1,
        "gen_fits": generator(lambda: iter([5.0, 1.0])),
        "gen_size": generator(lambda y: iter([y, y - 3])),
    }
    alone = {**python, "gen_size": generator(lambda y: iter([]))}
    assert posed("x: float64", "fits(x)", domain, functions=alone).found() == [{"x": 1.0}]
    for condition in ("size(x) < 7", "7 > size(x)", "not size(x) >= 7"):
        assert posed("x: float64", condition, domain, functions=python).found() == [{"x": 4.0}]


def test_several_outputs_and_opaque_values() -> None:
    domain = """
    typedef path: pyobject
    def route(x: float64, y: float64, p: path) -> bool
    def length(p: path) -> float64
    generator gen_route(x, y, p):
      goal: route(x, y, p)
      in: x
      out: y, p
    """

    def routes(x: float) -> Iterator[tuple[float, list[float]]]:
        for step in count(1):
            yield x + step, [x, x + step]

    problem = posed(
        "x, y, z: float64; p, q: path",
        "route(x, y, p)\nroute(y, z, q)\nx == 1\nlength(p) == 2\nlength(q) > length(p)",
        domain,
        functions={
            "route": lambda x, y, p: p == [x, y],
            "length": lambda p: p[1] - p[0],
            "gen_route": generator(routes),
        },
    )
    found = problem.found(1)[0]
    assert (found["y"], found["z"]) == (3.0, 6.0)
    assert found["q"].value == [3.0, 6.0]


# ------------------------------------------------------------------------- rounds, limits and ends


def test_a_complete_generator_lets_be_proved_that_there_is_nothing() -> None:
    problem = line("spot(x)\nx * x == 17", "x: float64", gen_spot=spots)
    solutions = problem.solutions()
    assert list(solutions) == []
    assert solutions.is_proved
    assert [c.text for c in solutions.core().core] == ["spot(x)", "x * x == 17"]


@pytest.mark.parametrize(
    ("python", "limit", "kind"),
    [
        (generator(lambda: iter(())), None, "incomplete"),
        (generator(lambda: map(float, range(5))), None, "incomplete"),
        (generator(lambda: map(float, count())), 50, "limit"),
        (generator(limit=7)(lambda: map(float, count())), None, "limit"),
        (generator(lambda: iter([3.0] * 40)), None, "incomplete"),
    ],
)
def test_what_kept_from_a_proof_is_told(python: Any, limit: int | None, kind: str) -> None:
    problem = line("spot(x)\nx < 0", "x: float64", gen_spot=python)
    solutions = problem.solutions(limit=limit)
    assert list(solutions) == []
    assert not solutions.is_proved
    assert [(cut.kind, cut.what) for cut in solutions.cuts] == [(kind, "gen_spot")]
    assert "gen_spot" in str(solutions.core())


def test_draws_are_limited_and_not_repeated_in_later_rounds() -> None:
    asked: list[float] = []

    def numbers() -> Iterator[float]:
        for number in count():
            asked.append(number)
            yield float(number)

    problem = line("spot(x)\nx < 0", "x: float64", gen_spot=generator(numbers))
    solver = problem.solver(limit=20)
    assert list(solver.solutions(problem.store)) == []
    assert asked == list(range(20))
    told = solver.source.statistics()["gen_spot"]
    rejected = told.pop("rejected")
    assert sorted((place.rpartition(": ")[2], count) for place, count in rejected.items()) == [
        ("`spot(x)`", 10),
        ("`x < 0`", 10),
    ]
    assert told == {"calls": 1, "yielded": 20, "ended": 0, "limited": 1}


def test_a_variable_without_generator_is_named_with_its_constraint() -> None:
    problem = line("close(x, y)\nx == 1")
    solutions = problem.solutions()
    assert next(solutions, None) is None
    (cut,) = solutions.cuts
    assert cut.kind == "missing"
    assert "`y` in domain.cdl" in str(cut)
    assert "close(x, y)" in str(cut)


def test_one_round_has_as_many_draws_as_it_is_told() -> None:
    problem = line("spot(x)\nx > 5", "x: float64", gen_spot=spots)
    few, more = problem.solutions(most=4), problem.solutions(most=8)
    assert list(few) == []
    assert [c.kind for c in few.cuts] == ["round"]
    assert [s.values[problem.unknowns["x"]] for s in more] == [6.0, 7.0]


def test_an_endless_generator_below_a_useless_value_does_not_starve_others() -> None:
    """x = 0 never leads anywhere; y could be drawn for it without end."""
    problem = line(
        "spot(x)\nclose(y, z)\ny == 10 * x\nz > y + 0.9\nx > 0 or z > 100",
        gen_spot=spots, gen_close=near,
    )  # fmt: skip
    solutions = problem.solutions(limit=10**9)
    found = problem.checked(next(solutions))
    assert found["x"] > 0
    assert solutions.nodes < 300


def test_nested_endless_generators_find_what_lies_deep_in_both() -> None:
    domain = """
    def p(x: int64) -> bool
    def q(x: int64, y: int64) -> bool
    generator gen_p(x):
      goal: p(x)
      in:
      out: x
    generator gen_q(x, y):
      goal: q(x, y)
      in: x
      out: y
    """
    python = {
        "p": lambda x: True,
        "q": lambda x, y: True,
        "gen_p": generator(lambda: count()),
        "gen_q": generator(lambda x: count()),
    }
    problem = posed("x, y: int64", "p(x)\nq(x, y)\nx * y == 77 and x > y", domain, functions=python)
    assert problem.found(2, limit=100) == [{"x": 11, "y": 7}, {"x": 77, "y": 1}]


def test_generators_for_one_variable_take_turns() -> None:
    domain = """
    def p(x: int64) -> bool
    generator up(x):
      goal: p(x)
      in:
      out: x
    generator down(x):
      goal: p(x)
      in:
      out: x
    """
    python = {
        "p": lambda x: True,
        "up": generator(lambda: count(1)),
        "down": generator(lambda: count(-1, -1)),
    }
    problem = posed("x: int64", "p(x)", domain, functions=python)
    solver = problem.solver()
    drawn = solver.draws(problem.store, problem.unknowns["x"])
    assert drawn is not None
    values = [s.values[problem.unknowns["x"]] for s in islice(drawn, 6)]
    assert values == [1, -1, 2, -2, 3, -3]
    with_most = solver.draws(problem.store, problem.unknowns["x"], most=2)
    assert with_most is not None
    assert len(list(with_most)) == 4
    assert {cut.kind for cut in with_most.cuts} == {"round"}


def test_draws_need_known_inputs() -> None:
    problem = line("close(x, y)", gen_close=near)
    assert problem.solver().draws(problem.store, problem.unknowns["y"]) is None
    known = problem.store.assigned(problem.unknowns["x"], 3.0)
    assert isinstance(known, Store)
    assert problem.solver().draws(known, problem.unknowns["y"]) is not None
    assert problem.solver().draws(known, problem.unknowns["z"]) is None


def test_each_solution_is_found_once() -> None:
    problem = line("spot(x)\nspot(y)\nx + y == 4 or x == y", "x, y: float64", gen_spot=spots)
    found = [(f["x"], f["y"]) for f in problem.found()]
    expected = [(x, y) for x in range(10) for y in range(10) if x + y == 4 or x == y]
    assert sorted(found) == sorted(expected)


def test_errors_of_python_are_told_with_the_name_of_the_generator() -> None:
    def fails() -> Iterator[float]:
        yield 20.0
        raise ValueError("no more ideas")

    with pytest.raises(FunctionError, match="no more ideas") as caught:
        line("spot(x)", "x: float64", gen_spot=generator(fails)).found()
    assert caught.value.name == "gen_spot"
    for wrong in (math.nan, (1.0, 2.0), "text", None):
        with pytest.raises(FunctionError, match="gen_spot"):
            line("spot(x)", "x: float64", gen_spot=generator(lambda w=wrong: iter([w]))).found()


def test_limits_of_a_search_are_looked_at() -> None:
    problem = line("spot(x)\nx < 0", "x: float64", gen_spot=generator(lambda: map(float, count())))
    with pytest.raises(Stopped), Budget(time_limit=0.2).running():
        next(problem.solutions(limit=10**12), None)
    solutions = problem.solutions(limit=10**12, node_limit=100)
    assert next(solutions, None) is None
    assert [cut.kind for cut in solutions.cuts] == ["nodes"]


# ------------------------------------------------------------------------------- states and time


def test_generators_see_the_state_once_it_is_known() -> None:
    domain = """
    typedef thing
    feature at(o: thing) -> float64
    def [[reads=at]] free(x: float64) -> bool
    generator gen_free(x):
      goal: free(x)
      in:
      out: x
    def some(x: float64) -> bool
    generator gen_some(x):
      goal: some(x)
      in:
      out: x
    """
    seen: list[dict[Any, Any]] = []

    def free_places(state: Any) -> Iterator[float]:
        seen.append(state.cells("at"))
        yield max(state.cells("at").values()) + 1

    problem = posed(
        "x, y: float64", "free(x)\nsome(y)\nx > 5", domain, objects="a, b: thing",
        init="at[a] = 3", cells={"y": ("at", "b")},
        functions={
            "free": lambda state, x: all(x != v for v in state.cells("at").values()),
            "some": lambda y: True,
            "gen_free": generator(free_places),
            "gen_some": generator(lambda: iter([2.0, 3.5, 6.0])),
        },
    )  # fmt: skip
    assert problem.found() == [{"x": 7.0, "y": 6.0}]
    assert [places["b",] for places in seen] == [2.0, 3.5, 6.0]


# --------------------------------------------------------------------------- backtracking and size


def test_failures_do_not_make_other_choices_again() -> None:
    """20 variables of 10 values each; the last one has none: its 10 values are tried once."""
    names = [f"x{i}" for i in range(20)]
    text = "\n".join(f"spot({n})" for n in names) + "\nx19 > 20"
    problem = line(text, f"{', '.join(names)}: float64", gen_spot=spots)
    solutions = problem.solutions()
    assert list(solutions) == []
    assert solutions.is_proved
    assert solutions.nodes < 1_000


def test_two_thousand_variables_are_drawn_in_a_chain() -> None:
    names = [f"x{i}" for i in range(2_000)]
    links = [f"close({a}, {b})" for a, b in pairwise(names)]
    problem = line("\n".join(["x0 == 0", *links]), f"{', '.join(names)}: float64", gen_close=near)
    solutions = problem.solutions()
    assert len(problem.checked(next(solutions))) == 2_000
    assert solutions.nodes == 1_999


# -------------------------------------------------------------------------- against enumeration

ATOMS = (
    "{a} + {b} == {k}", "{a} < {b}", "{a} * 2 == {b} + {k}", "{a} != {b}", "{a} - {b} >= {k}",
    "digit({a})", "near({a}, {b})", "not near({a}, {b})", "step({a}) == {b}", "{a} * {b} == {k}",
    "abs({a} - {b}) <= 1",
)  # fmt: skip
DIGITS = """
def digit(a: int64) -> bool
def near(a: int64, b: int64) -> bool
def step(a: int64) -> int64
generator gen_digit(a):
  goal: digit(a)
  in:
  out: a
generator gen_near(a, b):
  goal: near(a, b)
  in: a
  out: b
generator gen_step(a, b):
  goal: step(a) == b
  in: b
  out: a
"""
DIGITS_PYTHON = {
    "digit": lambda a: 0 <= a < 5,
    "near": lambda a, b: abs(a - b) <= 1,
    "step": lambda a: (a + 2) % 5,
    "gen_digit": generator(complete=True)(lambda: iter(range(5))),
    "gen_near": generator(complete=True)(lambda a: iter((a - 1, a, a + 1))),
    "gen_step": generator(lambda b: iter(((b - 2) % 5,))),
}
NAMES = ("a", "b", "c")
atoms = st.builds(
    lambda text, a, b, k: text.format(a=a, b=b, k=k),
    st.sampled_from(ATOMS), st.sampled_from(NAMES), st.sampled_from(NAMES), st.integers(0, 6),
)  # fmt: skip
formulas = st.recursive(
    st.one_of(atoms, atoms, st.sampled_from(("p", "q"))),
    lambda inner: st.one_of(
        st.builds("({} or {})".format, inner, inner),
        st.builds("({} and {})".format, inner, inner),
        st.builds("(not {})".format, inner),
        st.builds("({} if {} else {})".format, inner, inner, inner),
        st.builds("(({}) ^ ({}))".format, inner, inner),
    ),
    max_leaves=4,
)


@given(st.lists(formulas, min_size=1, max_size=4))
def test_the_solutions_are_those_that_enumeration_finds(texts: list[str]) -> None:
    ranges = [f"digit({name})" for name in NAMES]
    problem = posed("a, b, c: int64; p, q: bool", [*texts, *ranges],
                    DIGITS, functions=DIGITS_PYTHON)  # fmt: skip
    expected = set()
    for values in product(range(5), range(5), range(5), (True, False), (True, False)):
        named = dict(zip((*NAMES, "p", "q"), values, strict=True))
        given_ = {problem.unknowns[name]: value for name, value in named.items()}
        if all(problem.is_true(c, given_) for c in problem.constraints):
            expected.add(values)
    store = Store.of(problem.world).having(*problem.constraints)
    if not isinstance(store, Store):
        assert not expected
        return
    solutions = problem.solver().solutions(store)
    found = [problem.checked(solution) for solution in solutions]
    assert solutions.is_proved or "incomplete" in {cut.kind for cut in solutions.cuts}
    rows = [tuple(f.get(n, False) for n in (*NAMES, "p", "q")) for f in found]
    assert set(rows) <= expected
    # A truth value that does not matter is given in one way; of numbers, nothing is left out.
    assert {row[:3] for row in rows} == {row[:3] for row in expected}


# ----------------------------------------------------------------------- what need not be drawn


def test_what_follows_is_not_drawn() -> None:
    """An equation whose unknown nobody else uses: it is computed in the end (App. B.1, rule 3)."""
    asked: list[float] = []
    problem = line(
        "spot(x)\ny == half(x)\nb == (x > 2)\nx > 6", "x, y: float64; b: bool",
        gen_spot=spots, gen_half=generator(lambda y: iter(asked.append(y) or ())),
    )  # fmt: skip
    found = problem.found()
    assert found == [{"x": x, "y": x / 2, "b": True} for x in (7.0, 8.0, 9.0)]
    assert not asked
    assert problem.solutions(most=1_000).is_proved


def test_what_is_left_open_has_some_value() -> None:
    domain = "typedef spot\ntypedef pose: vector[int64, 2]\n"
    problem = posed(
        "b: bool; n: int64; p: pose; s: spot", "b or n > 3 or p == [1, 2] or s == s and p != p",
        domain, objects="a: spot",
    )  # fmt: skip
    (first, *_) = problem.found()
    assert first == {"b": True, "n": 0, "p": (0, 0), "s": "a"}


def test_states_above_states_are_looked_through_once() -> None:
    problem = posed("x: float64", "x > 1", "typedef spot\nfeature height(s: spot) -> float64\n")
    knowledge = problem.store.knowledge
    x = problem.unknowns["x"]
    low = {("height", (f"s{i}",)): float(i) for i in range(5)} | {("height", ("s7",)): x}
    below, above = dict(low), {("height", ("s2",)): x, ("height", ("s7",)): 3.0}
    cells = FixedCells(above, below)
    assert dict(knowledge.open_cells(cells)) == {("height", ("s2",)): x}
    assert knowledge.open_cells(cells) is knowledge.open_cells(cells)
    known = knowledge.resolved(cells, {x: 9.0})
    assert known["height", ("s2",)] == 9.0
    assert known["height", ("s4",)] == 4.0
    assert knowledge.resolved(cells, {x: 9.0}) is known
    assert knowledge.resolved(below, {}) == below
