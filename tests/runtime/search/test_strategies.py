"""Best-first search and `auto`: what deepening drowns in, limits, determinism, `commit`."""

import pytest
from programs import problem_of
from small_domains import COMMITTED
from support import EXAMPLES

import crow
from cdlc.driver import problem_compilation
from crow.plan import call_text
from crow.replay import replay_to_goal

T = "typedef T\nfeature p(x: T)\nfeature q(x: T)\nfeature r()\ncontroller c(x: T)\ncontroller d()\n"


def example(name: str) -> crow.Problem:
    return problem_compilation([str(EXAMPLES / f"{name}.cdl")]).problem


def problem(domain: str, goal: str, init: str = "pass") -> crow.Problem:
    text = f'problem "p"\nobjects:\n  a, b, e: T\ninit:\n  {init}\ngoal: {goal}\n'
    return problem_of(T + domain, text)


def calls(result: crow.Result) -> list[str]:
    assert isinstance(result, crow.Plan), result
    return [call_text(s.controller, s.arguments, {}) for s in result.steps if s.controller]


DROWNING = ["gripper/four", "logistics/parcel", "jugs/four", "blocks/towers12"]


@pytest.mark.parametrize("name", DROWNING)
def test_auto_plans_where_deepening_drowns(name: str) -> None:
    task = example(name)
    result = crow.plan(task, node_limit=60_000)
    assert isinstance(result, crow.Plan)
    assert replay_to_goal(task, result.trace).is_sound
    again = crow.plan(task, node_limit=60_000)
    assert (again.steps, again.statistics["nodes"]) == (result.steps, result.statistics["nodes"])


@pytest.mark.parametrize("h", ["ff", "add"])
@pytest.mark.parametrize("name", ["blocks/sussman", "gripper/four", "cupboard/dishes"])
def test_best_plans_with_each_heuristic(name: str, h: str) -> None:
    task = example(name)
    result = crow.plan(task, "best", h=h, node_limit=60_000)
    assert isinstance(result, crow.Plan)
    assert replay_to_goal(task, result.trace).is_sound


def test_an_unknown_heuristic_is_refused() -> None:
    with pytest.raises(ValueError, match="no heuristic `max`; there are ff, add"):
        crow.plan(example("blocks/sussman"), h="max")


@pytest.mark.parametrize("engine", ["best", "auto"])
def test_limits(engine: str) -> None:
    task = example("blocks/towers12")
    nodes = crow.plan(task, engine, node_limit=600)
    assert isinstance(nodes, crow.LimitReached)
    assert nodes.limits == ("nodes",)
    assert isinstance(crow.plan(task, engine, time_limit=0.02), crow.TimedOut)
    assert isinstance(crow.plan(task, engine, memory_limit_mb=1), crow.OutOfMemory)


RECURSIVE = """
behavior go(x: T):
  goal: p(x)
  body:
    achieve p(x)
    do c(x)
"""


def test_a_goal_below_itself_without_end_keeps_no_plan_from_being_found() -> None:
    other = "behavior direct(x: T):\n  goal: p(x)\n  body:\n    do c(x)\n  eff: p[x] = True\n"
    assert calls(crow.plan(problem(RECURSIVE + other, "p(a)"), "best", node_limit=1_000))


def test_best_commits_to_the_way_it_prefers() -> None:
    assert calls(crow.plan(problem(COMMITTED, "r()", "q[b] = True"), "best")) == ["c(b)", "d()"]


def test_best_keeps_to_a_commit() -> None:
    # What `k` leaves is known only once it has run, so nothing is preferred.
    domain = "feature good() -> T\ncontroller k(x: T):\n  eff:\n    q[x] = x == good()\n"
    domain += COMMITTED.replace("do c(x)", "do k(x)")
    result = crow.plan(problem(domain, "r()", "good = b"), "best")
    assert isinstance(result, crow.LimitReached)
    assert result.limits == ("commit",)
    free = problem(domain.replace("    commit\n", ""), "r()", "good = b")
    assert calls(crow.plan(free, "best")) == ["k(b)", "d()"]


@pytest.mark.parametrize("engine", ["best", "auto"])
def test_a_space_that_was_searched_through_is_unsolvable(engine: str) -> None:
    result = crow.plan(problem(COMMITTED.replace("    commit\n", ""), "r()"), engine)
    assert isinstance(result, crow.Unsolvable)
    assert result.summary().startswith(f"no plan exists by the program ({engine}")
    assert result.explanation is not None
    assert "q(x)" in result.explanation


def test_best_counts_depth_only_up_to_a_limit() -> None:
    nested = "behavior n(x: T):\n  goal: q(x)\n  body:\n    achieve p(x)\n    do d()\n"
    nested += "  eff: q[x] = True\nbehavior go(x: T):\n  goal: p(x)\n  body:\n    do c(x)\n"
    task = problem(nested + "  eff: p[x] = True\n", "q(a)")
    limited = crow.plan(task, "best", depth_limit=1)
    assert isinstance(limited, crow.LimitReached)
    assert limited.limits == ("depth",)
    assert calls(crow.plan(task, "best", depth_limit=2)) == ["c(a)", "d()"]
    assert "depth" not in crow.plan(task, "best").statistics
