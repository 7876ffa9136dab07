"""Iterative widening: what counts as width, when a round ends the search, turns of the widths."""

import pytest
from programs import problem_of

import crow
from crow.plan import call_text
from crow.search.engine import CrowEngine

T = "typedef T\nobject_constant a: T\nobject_constant b: T\nobject_constant e: T\n"
T += "feature p(x: T)\nfeature q(x: T)\nfeature r()\ncontroller c(x: T)\ncontroller d()\n"
DIRECT = "behavior direct(x: T):\n  goal: p(x)\n  body:\n    do c(x)\n  eff: p[x] = True\n"


def problem(domain: str, goal: str, init: str = "pass") -> crow.Problem:
    text = f'problem "p"\ninit:\n  {init}\ngoal: {goal}\n'
    return problem_of(T + domain, text)


def calls(result: crow.Result) -> list[str]:
    assert isinstance(result, crow.Plan), result
    return [call_text(s.controller, s.arguments, {}) for s in result.steps if s.controller]


@pytest.mark.parametrize(
    ("goal", "width"),
    [
        ("p(a)", 1),
        ("p(a) and p(b)", 2),
        ("p(a) and p(b) and p(e)", 3),
        ("forall x: T: p(x)", 3),
        ("p(a) and r()", 1),  # what is true already is completed at once
        ("p(a) or r()", 1),
    ],
)
def test_the_members_of_a_goal_are_its_width(goal: str, width: int) -> None:
    result = crow.plan(problem(DIRECT, goal, "r[...] = True"), "iw")
    assert isinstance(result, crow.Plan)
    assert result.statistics["width"] == width


BODIES = {
    "two in R": ("achieve p(a)\n    achieve p(b)", 2),
    "one way of an if": ("if r():\n      achieve p(a)\n    else:\n      achieve p(b)", 1),
    "a loop": ("foreach x: T:\n      achieve p(x)", 3),
    "one of M and one of R": ("promotable:\n      achieve p(a)\n    achieve p(b)", 2),
    "two of M": ("promotable:\n      achieve p(a)\n      achieve p(b)", 2),
    "an assertion is none": ("assert not r()\n    achieve p(a)", 1),
    "those of L are none": (
        "achieve p(a)\n    achieve p(b)\n    promotable:\n      achieve p(e)",
        1,
    ),
}


@pytest.mark.parametrize("name", BODIES)
def test_the_achieves_of_m_and_r_are_the_width_of_a_behavior(name: str) -> None:
    body, width = BODIES[name]
    both = f"behavior both():\n  goal: r()\n  body:\n    {body}\n  eff: r[...] = True\n"
    result = crow.plan(problem(DIRECT + both, "r()"), "iw")
    assert isinstance(result, crow.Plan)
    assert result.statistics["width"] == width


CALLERS = """
behavior outer():
  goal: r()
  body:
    achieve q(a)
    achieve q(b)
  eff: r[...] = True
behavior inner(x: T):
  goal: q(x)
  body:
    achieve p(x)
    achieve p(e)
  eff: q[x] = True
"""


def test_what_callers_still_achieve_does_not_count() -> None:
    task = problem(DIRECT + CALLERS, "r()")
    result = crow.plan(task, "iw")
    assert calls(result) == ["c(a)", "c(e)", "c(b)"]
    assert result.statistics["width"] == 2
    narrow = CrowEngine(task, lambda _: None, width=1)
    assert list(narrow.round(9)) == []
    assert narrow.left_out() == ("width",)


ENDLESS = "behavior go(x: T):\n  goal: r()\n  body:\n    achieve r()\n    do c(x)\n"
WIDE = """
behavior wide():
  goal: r()
  body:
    achieve p(a)
    achieve p(b)
  eff: r[...] = True
"""


def test_a_width_without_end_keeps_no_wider_plan_from_being_found() -> None:
    result = crow.plan(problem(ENDLESS + DIRECT + WIDE, "r()"), "iw", node_limit=20_000)
    assert calls(result) == ["c(a)", "c(b)"]
    assert result.statistics["width"] == 2


def test_only_a_round_that_leaves_nothing_out_says_that_there_is_no_plan() -> None:
    task = problem(DIRECT, "p(a) and p(b) and q(a)")
    result = crow.plan(task, "iw")
    assert isinstance(result, crow.Unsolvable)
    assert result.statistics["width"] == 3
    assert result.statistics["pruned"]["width"] > 0


def test_a_depth_limit_is_named() -> None:
    task = problem(DIRECT + WIDE, "r()")
    result = crow.plan(task, "iw", depth_limit=1)
    assert isinstance(result, crow.LimitReached)
    assert result.limits == ("depth",)
    assert result.statistics["width"] == 2
    assert calls(crow.plan(task, "iw", depth_limit=2)) == ["c(a)", "c(b)"]


def test_plans_of_all_widths_are_told_once() -> None:
    other = DIRECT.replace("direct", "other").replace("do c(x)", "do d()")
    found = list(crow.plans(problem(DIRECT + other, "p(a)"), "iw"))
    assert len(found) == 2
    assert [plan.statistics["width"] for plan in found] == [1, 1]
