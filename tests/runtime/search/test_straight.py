"""Imperative programs: which are, stacking blocks, and what is left to search all the same."""

from itertools import pairwise

import pytest
from programs import problem_of
from support import EXAMPLES

import crow
from benchmarks.serial import stacking
from benchmarks.towers import Towers, random_towers
from cdlc.driver import problem_compilation
from crow.plan import call_text
from crow.search.imperative import is_imperative

T = "typedef T\nobject_constant a: T\nobject_constant b: T\nfeature p(x: T)\nfeature q(x: T)\n"
T += "feature r()\nfeature n() -> int64\ncontroller c(x: T)\n"
MAKE = "behavior make(x: T):\n  goal: p(x)\n  body:\n    do c(x)\n  eff: p[x] = True\n"


def problem(domain: str, goal: str = "r()") -> crow.Problem:
    return problem_of(T + domain, f'problem "p"\ngoal: {goal}\n')


def both(body: str) -> str:
    return f"behavior both():\n  goal: r()\n  body:\n    {body}\n  eff: r[...] = True\n"


def calls(result: crow.Result) -> list[str]:
    assert isinstance(result, crow.Plan), result
    return [call_text(s.controller, s.arguments, {}) for s in result.steps if s.controller]


# ------------------------------------------------------------------------------ blocks


def run(start: Towers, plan: list[str]) -> dict[str, str]:
    """Where each block is after actions, with a hand for one of them; fails if one cannot be."""
    below = {block: "table" for tower in start for block in tower}
    below |= {x: y for tower in start for y, x in pairwise(tower)}
    hand = None
    for action in plan:
        name, _, arguments = action.rstrip(")").partition("(")
        x, *rest = arguments.split(", ")
        if name in ("pickup", "unstack"):
            assert hand is None
            assert x not in below.values()
            assert below.pop(x) == (rest[0] if rest else "table")
            hand = x
        else:
            assert hand == x
            (y,) = rest or ["table"]
            assert y == "table" or y not in below.values()
            below[x], hand = y, None
    assert hand is None
    return below


@pytest.mark.parametrize("count", [2, 5, 12, 30, 150])
@pytest.mark.parametrize("seed", [1, 2])
def test_blocks_are_stacked(count: int, seed: int) -> None:
    start, pairs = random_towers(count, seed)
    result = crow.plan(stacking(start, pairs), time_limit=60)
    plan = calls(result)
    wanted = {block: "table" for tower in start for block in tower} | dict(pairs)
    assert run(start, plan) == wanted
    assert len(plan) <= 4 * count  # each block is moved twice at most
    assert result.statistics["states"] == 1
    assert result.statistics["nodes"] <= 30 * count


def test_a_block_goes_to_its_place_at_once_where_it_can() -> None:
    # b3, b2 and b1 are to be a tower in just the order in which they can be taken.
    assert len(calls(crow.plan(stacking([["b1", "b2", "b3"]], [("b1", "b2"), ("b2", "b3")])))) == 6
    result = crow.plan(problem_compilation([str(EXAMPLES / "blocks/stacking_sussman.cdl")]).problem)
    assert len(calls(result)) == 6


# --------------------------------------------------------------------- what is imperative

IMPERATIVE = {
    "achieve p(a)": True,
    "foreach x: T:\n      achieve p(x)": True,
    "if p(a):\n      make(b)\n    else:\n      achieve p(b)": True,
    "achieve p(a) and p(b)": False,
    "achieve n() == 1": False,
    "bind x: T where: p(x)": False,
    "assert p(a)": False,
    "promotable:\n      achieve p(a)": False,
    "alternative:\n      achieve p(a)\n      achieve p(b)": False,
    "do c(a)\n    commit": False,
}


@pytest.mark.parametrize("body", IMPERATIVE)
def test_what_may_choose_or_fail_is_not_imperative(body: str) -> None:
    task = problem(MAKE + both(body))
    assert is_imperative(task) == IMPERATIVE[body]


def test_two_behaviors_for_one_goal_are_a_choice_but_only_where_it_is_achieved() -> None:
    again = MAKE.replace("make", "again")
    task = problem(MAKE + again + both("achieve p(a)"))
    assert not is_imperative(task)
    task = problem(MAKE + again + both("do c(a)"))
    assert is_imperative(task)
    undo = "behavior undo(x: T):\n  goal: not p(x)\n  body:\n    do c(x)\n  eff: p[x] = False\n"
    task = problem(MAKE + undo + both("achieve_once p(a)\n    achieve not p(a)"))
    assert is_imperative(task)
    assert calls(crow.plan(task)) == ["c(a)", "c(a)"]


# ------------------------------------------------------------------- what is left to search

ORDER = """
behavior all():
  goal: r()
  body:
    unordered:
      achieve p(a)
      achieve q(b)
  eff: r[...] = True
behavior first(x: T):
  goal: p(x)
  body:
    if not q(b):
      achieve r()
    do c(x)
  eff: p[x] = True
behavior second(x: T):
  goal: q(x)
  body:
    do c(x)
  eff: q[x] = True
"""
ENDLESS = "behavior go():\n  goal: r()\n  body:\n    achieve r()\n    do c(a)\n"


def test_where_the_run_has_no_end_a_search_takes_turns() -> None:
    # In the order written, `achieve p(a)` wants r() again, which begins with p(a) again.
    task = problem(ORDER)
    assert is_imperative(task)
    result = crow.plan(task, node_limit=400_000)
    assert calls(result) == ["c(b)", "c(a)"]


def test_limits_end_a_run_without_end() -> None:
    result = crow.plan(problem(ENDLESS), node_limit=5_000)
    assert isinstance(result, crow.LimitReached)
    assert result.limits == ("nodes",)
    assert isinstance(crow.plan(problem(ENDLESS), time_limit=0.05), crow.TimedOut)


def test_a_depth_limit_holds_and_what_no_behavior_achieves_is_told() -> None:
    task = problem(MAKE + both("achieve p(a)"))
    limited = crow.plan(task, depth_limit=1)
    assert isinstance(limited, crow.LimitReached)
    assert limited.limits == ("depth",)
    assert calls(crow.plan(task, depth_limit=2)) == ["c(a)"]
    result = crow.plan(problem(both("achieve p(a)")))
    assert isinstance(result, crow.Unsolvable)
    assert result.explanation is not None
    assert "p(a)" in result.explanation


def test_plans_are_told_once() -> None:
    assert len(list(crow.plans(problem(MAKE + both("achieve p(a)"))))) == 1
