"""Values that are bound: drawn, computed, decided, and what is said when there are none (§2.4)."""

from collections.abc import Callable, Iterator, Mapping
from itertools import count
from pathlib import Path
from typing import Any

import pytest

import cdlc
import crow

Loads = Callable[..., crow.Problem]


@pytest.fixture
def loads(tmp_path: Path) -> Loads:
    """Problems of domains given as text, with their Python."""

    def load(
        text: str, goal: str, functions: Mapping[str, Any] | None = None,
        init: Mapping[Any, Any] | None = None, objects: tuple[str, ...] = ("a", "b"),
    ) -> crow.Problem:  # fmt: skip
        file = tmp_path / "domain.cdl"
        file.write_text(text)
        domain = cdlc.load(file, functions=functions or {})
        return crow.Problem(domain, dict.fromkeys(objects, "Thing"), init or {}, goal)

    return load


LINE = """
typedef Thing
feature pos(o: Thing) -> float64
feature done(o: Thing)
feature speed() -> float64
controller go(o: Thing, p: float64)
def shelf(p: float64) -> bool
generator shelves(p):
  goal: shelf(p)
  out: p
behavior move(o: Thing, p: float64):
  goal: pos(o) == p
  body:
    do go(o, p)
  eff:
    pos[o] = p
"""


def on_shelf(p: float) -> bool:
    return p in (1.0, 2.0, 3.0)


@crow.generator("shelves", complete=True)
def shelves() -> Iterator[float]:
    yield from (1.0, 2.0, 3.0)


SHELVES = {"shelf": on_shelf, "shelves": shelves}


def planned(problem: crow.Problem, **limits: Any) -> crow.Plan:
    found = crow.plan(problem, time_limit=20, **limits)
    assert isinstance(found, crow.Plan), (found.status, found.explanation)
    return found


def arguments(plan: crow.Plan) -> list[tuple[Any, ...]]:
    return [step.arguments for step in plan.steps]


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("bind p: float64 where: shelf(p) | do go(o, p)", 1.0),
        ("bind p: float64 | assert shelf(p) | do go(o, p)", 1.0),
        ("bind p: float64 where: shelf(p) and p > 1.5 | do go(o, p)", 2.0),
        ("bind p: float64 where: shelf(p) | assert p > 2.5 | do go(o, p)", 3.0),
        # Computed, not drawn.
        ("bind p: float64 where: p == pos(o) + 4 | do go(o, p)", 4.0),
        ("bind p: float64 | assert 2 * p == 7 | do go(o, p)", 3.5),
        ("bind p: float64 | let q = p + 1 | assert q == 3 | do go(o, q)", 3.0),
        ("bind p: float64 | do go(o, p + 1) | assert p == 1", 2.0),
        ("bind p: float64 | if p > 2: assert p == 5 | else: assert p == 9 | do go(o, p)", 5),
        # Found in the order of time, used before.
        ("bind p, q: float64 where: q == p + 1 | assert shelf(p) and q > 2 | do go(o, q)", 3.0),
        ("bind p: float64 | achieve pos(o) == p | assert p == 6", 6.0),
        ("bind p: float64 | assert p > 0 or p == -2 | assert not p > 0 | do go(o, p)", -2.0),
        ("bind p: float64 where: shelf(p) | commit | do go(o, p)", 1.0),
        ("bind p: float64 | assert p == 8 | commit | do go(o, p)", 8.0),
    ],
)  # fmt: skip
def test_a_bound_value(loads: Loads, body: str, expected: float) -> None:
    head = "behavior finish(o: Thing):\n  goal: done(o)\n  body:\n"
    lines = body.replace(" | ", "\n    ")
    text = f"{LINE}\n{head}    {lines}\n  eff:\n    done[o] = True\n"
    plan = planned(loads(text, "done(a)", SHELVES, {"pos(a)": 0.0, "pos(b)": 0.0}))
    assert arguments(plan)[0] == ("a", expected)


def test_a_state_with_values_that_are_not_known(loads: Loads) -> None:
    text = f"""{LINE}
behavior push(o: Thing):
  goal: done(o)
  body:
    bind p: float64
    do go(o, p)
    achieve pos(o) == p
    achieve speed() > 3
    assert pos(o) == 5
  eff:
    done[o] = True
behavior hurry(q: float64):
  goal: speed() > q
  body:
    bind p: float64 where: shelf(p)
    assert p > q - 1
  eff:
    speed += p + q
"""
    plan = planned(loads(text, "done(a)", SHELVES, {"pos(a)": 0.0, "pos(b)": 0.0}))
    assert arguments(plan)[:2] == [("a", 5.0), ("a", 5.0)]


def test_effects_that_compute_with_what_is_not_known(loads: Loads) -> None:
    text = f"""{LINE}
controller shift(o: Thing, by: float64):
  eff:
    if by > 2:
      pos[o] += by
    else:
      pos[o] = 0
behavior finish(o: Thing):
  goal: done(o)
  body:
    bind p: float64
    do shift(o, p)
    assert pos(o) == 10
  eff:
    done[o] = True
"""
    plan = planned(loads(text, "done(a)", SHELVES, {"pos(a)": 4.0, "pos(b)": 0.0}))
    assert arguments(plan) == [("a", 6.0)]


def test_a_value_parameter_that_the_goal_does_not_mention(loads: Loads) -> None:
    text = f"""{LINE}
behavior finish(o: Thing, p: float64):
  goal: done(o)
  body:
    assert shelf(p) and p >= 2
    do go(o, p)
  eff:
    done[o] = True
"""
    plan = planned(loads(text, "done(a)", SHELVES, {"pos(a)": 4.0, "pos(b)": 0.0}))
    assert arguments(plan) == [("a", 2.0)]
    assert plan.steps[0].behavior_arguments == ("a", 2.0)


def test_members_of_a_promotable_section_with_values(loads: Loads) -> None:
    text = f"""{LINE}
behavior place(o: Thing):
  goal: done(o)
  body:
    bind p: float64 where: shelf(p)
    assert forall x: Thing: pos(x) != p
    do go(o, p)
  eff:
    pos[o] = p
    done[o] = True
"""
    init = {"pos(a)": 0.0, "pos(b)": 0.0, "pos(c)": 0.0}
    problem = loads(text, "done(a) and done(b) and done(c)", SHELVES, init, ("a", "b", "c"))
    plan = planned(problem)
    assert sorted(p for _, p in arguments(plan)) == [1.0, 2.0, 3.0]
    init["pos(d)"] = 0.0
    goal = "done(a) and done(b) and done(c) and done(d)"
    found = crow.plan(loads(text, goal, SHELVES, init, ("a", "b", "c", "d")), time_limit=60)
    assert found.status == "unsolvable"


# ------------------------------------------------------------------------------------ no plan

FINISH = f"""{LINE}
behavior finish(o: Thing):
  goal: done(o)
  body:
    bind p: float64 where: shelf(p) and p > 5
    do go(o, p)
  eff:
    done[o] = True
"""
START = {"pos(a)": 0.0, "pos(b)": 0.0}


def test_a_complete_generator_proves_that_there_is_no_plan(loads: Loads) -> None:
    found = crow.plan(loads(FINISH, "done(a)", SHELVES, START), time_limit=20)
    assert found.status == "unsolvable"
    assert found.explanation is not None
    assert "p > 5" in found.explanation
    assert "generator `shelves`: 1 call, 3 values, 3 rejected by" in found.explanation
    assert found.statistics["generators"]["shelves"]["yielded"] == 3


def test_one_that_may_leave_values_out_does_not(loads: Loads) -> None:
    def some() -> Iterator[float]:
        yield from (1.0, 2.0)

    found = crow.plan(
        loads(FINISH, "done(a)", {"shelf": on_shelf, "shelves": some}, START), time_limit=20
    )
    assert isinstance(found, crow.LimitReached)
    assert found.limits == ("generator",)


def test_an_endless_one_stops_at_the_limit_of_draws(loads: Loads) -> None:
    def every() -> Iterator[float]:
        yield from (float(-n) for n in count())

    functions = {"shelf": lambda p: p <= 5, "shelves": every}
    found = crow.plan(loads(FINISH, "done(a)", functions, START), draw_limit=16, time_limit=20)
    assert isinstance(found, crow.LimitReached)
    assert found.limits == ("draws",)


def test_an_endless_one_yields_what_is_needed_in_the_end(loads: Loads) -> None:
    def every() -> Iterator[float]:
        yield from (n / 4 for n in count())

    functions = {"shelf": lambda p: p >= 0, "shelves": every}
    plan = planned(loads(FINISH, "done(a)", functions, START))
    assert arguments(plan) == [("a", 5.25)]


def test_an_endless_one_does_not_keep_others_waiting(loads: Loads) -> None:
    """The values of the outer bind are useless but for one; the inner one is never exhausted."""
    text = f"""{LINE}
def twice(p: float64, q: float64) -> bool
generator doubles(p, q):
  goal: twice(p, q)
  in: p
  out: q
behavior finish(o: Thing):
  goal: done(o)
  body:
    bind p: float64 where: shelf(p)
    bind q: float64 where: twice(p, q)
    assert q == 9
    do go(o, q)
  eff:
    done[o] = True
"""

    def every() -> Iterator[float]:
        yield from map(float, count())

    def larger(p: float) -> Iterator[float]:
        yield from (p * 3**n for n in count(1))

    functions = {
        "shelf": lambda _: True, "shelves": every,
        "twice": lambda _p, _q: True, "doubles": larger,
    }  # fmt: skip
    plan = planned(loads(text, "done(a)", functions, START))
    assert arguments(plan) == [("a", 9.0)]


def test_nothing_says_how_a_value_is_found(loads: Loads) -> None:
    text = f"""{LINE}
behavior finish(o: Thing):
  goal: done(o)
  body:
    bind p: float64 where: p > 3
    do go(o, p)
  eff:
    done[o] = True
"""
    found = crow.plan(loads(text, "done(a)", SHELVES, START), time_limit=20)
    assert isinstance(found, crow.LimitReached)
    assert found.limits == ("solver",)
    assert found.explanation is not None
    assert "`p`" in found.explanation


def test_what_is_computed_from_a_value_that_is_not_known_has_to_be_possible(loads: Loads) -> None:
    body = "bind p: float64\n    assert p > 2 and p < 1\n    let q = p + 1\n    do go(o, q)"
    text = f"{LINE}\nbehavior finish(o: Thing):\n  goal: done(o)\n  body:\n    {body}\n"
    found = crow.plan(loads(f"{text}  eff:\n    done[o] = True\n", "done(a)", SHELVES, START))
    assert isinstance(found, crow.Unsolvable | crow.LimitReached)


def test_an_object_that_depends_on_what_is_not_known(loads: Loads) -> None:
    """It is not said that there is no plan: the solver does not choose among objects here."""
    text = f"""{LINE}
def nearest(p: float64) -> Thing
behavior finish(o: Thing):
  goal: done(o)
  body:
    bind p: float64
    let x = nearest(p)
    assert pos(x) == 0
    do go(x, p)
  eff:
    done[o] = True
"""
    functions = {**SHELVES, "nearest": lambda _: "a"}
    found = crow.plan(loads(text, "done(a)", functions, START), time_limit=20)
    assert isinstance(found, crow.LimitReached)
    assert found.limits == ("solver",)


@pytest.mark.parametrize("engine", ["best", "reference"])
def test_engines_of_objects_say_that_they_draw_no_values(loads: Loads, engine: str) -> None:
    told = rf"engine `{engine}` does not cover `bind p` .* `auto`, `iddfs` and `iw` draw values"
    with pytest.raises(crow.NotPlannable, match=told):
        crow.plan(loads(FINISH, "done(a)", SHELVES, START), engine=engine)


# ----------------------------------------------------------------------------------- randomness


def test_a_value_is_one_of_its_variable(loads: Loads) -> None:
    """2.5 is no whole number, whatever else is true of it."""
    text = f"""{LINE}
behavior finish(o: Thing):
  goal: done(o)
  body:
    bind n: int64 where: shelf(n)
    do go(o, n)
  eff:
    done[o] = True
"""

    @crow.generator("shelves", complete=True)
    def some() -> Iterator[float]:
        yield from (2.5, 3.0)

    plan = planned(loads(text, "done(a)", {"shelf": lambda _: True, "shelves": some}, START))
    assert arguments(plan) == [("a", 3)]


def test_the_same_seed_gives_the_same_plan(loads: Loads) -> None:
    @crow.generator("shelves")
    def drawn(*, rng: Any) -> Iterator[float]:
        while True:
            yield float(rng.uniform(0, 10))

    functions = {"shelf": lambda p: 0 <= p <= 10, "shelves": drawn}
    problem = loads(FINISH, "done(a) and done(b)", functions, START)
    plans = [arguments(planned(problem, seed=seed)) for seed in (0, 0, 1)]
    assert plans[0] == plans[1] != plans[2]
    ((_, first), (_, second)) = plans[0]
    assert first != second
