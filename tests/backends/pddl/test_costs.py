"""Costs of actions: optimal plans of the emitted PDDL are optimal plans of the program."""

import re
from pathlib import Path

import pytest
from programs import emitted, task_of

from cdlc.backends.engines import installed
from cdlc.backends.pddl.solve import solve_task

needs_planner = pytest.mark.skipif("fast-downward" not in installed(), reason="needs `planners`")
GOLDEN = Path(__file__).parent / "golden" / "costs.cdl"

HEAD = """
typedef T
feature p(x: T)
feature n() -> int64
feature m() -> int64
feature k(x: T) -> int64
controller go(x: T)
controller rest()
"""
PROBLEM = 'problem "p"\nobjects:\n  a: T\ngoal: p(a)\n'


def act(effect: str, minimize: str = "n", init: str = "pass", body: str = "do go(x)") -> str:
    lines = "".join(f"    {line}\n" for line in effect.splitlines())
    behavior = f"behavior act(x: T):\n  body:\n    {body}\n  eff:\n{lines}    p[x] = True\n"
    problem = PROBLEM.replace("goal", f"init: {init}\ngoal") + f"minimize: {minimize}\n"
    task = task_of(HEAD + behavior, problem)
    return task.domain + (task.problem or "")


def charges(text: str) -> list[str]:
    return re.findall(r"\(increase \(total-cost\) (\([^()]*\)|[^()]+)\)", text)


@pytest.mark.parametrize(
    ("effect", "minimize", "init", "expected"),
    [
        ("n += 3", "n", "pass", ["3"]),
        ("n += 3\nn += 4", "n", "pass", ["7"]),
        ("n += 3\nm += 1", "n + 2 * m", "pass", ["5"]),
        ("n += k(x)", "n", "k[a] = 2", ["(k ?x)"]),
        ("n += k(x) + 1", "n", "k[a] = 2", ["(go-cost ?x)"]),
        ("n += 1", "n / 4", "pass", ["1"]),
        ("n += 1\nm += 1", "n / 4 + m", "pass", ["5"]),
        ("if p(x): n += 2", "n", "pass", ["2"]),
        ("n += 2 if p(x) else 3", "n", "pass", ["2", "3"]),
    ],
)
def test_increments_are_one_cost_an_action(
    effect: str, minimize: str, init: str, expected: list[str]
) -> None:
    text = act(effect, minimize, init)
    assert charges(text) == expected
    assert "(:metric minimize (total-cost))" in text
    assert "(n)" not in text


def test_tables_hold_sums_and_scaled_values() -> None:
    text = act("n += k(x) + 1", "n", "k[a] = 2")
    assert "(= (go-cost a) 3)" in text
    assert "(k " not in text


@pytest.mark.parametrize(
    ("effect", "minimize", "init", "body"),
    [
        ("n -= 1", "n", "pass", "do go(x)"),
        ("n = 4", "n", "pass", "do go(x)"),
        ("n *= 2", "n", "pass", "do go(x)"),
        ("n += k(x)\nk[x] += 1", "n", "pass", "do go(x)"),
        ("n += k(x)", "n", "k[a] = -1", "do go(x)"),
        ("n += 1", "n", "pass", "assert n() < 5"),
        ("n += 1\nm = n()", "n", "pass", "do go(x)"),
        ("n += 1", "n - m", "pass", "do go(x)"),
        ("n += 1", "n * m", "pass", "do go(x)"),
    ],
)
def test_what_is_no_cost_is_a_number_to_minimize(
    effect: str, minimize: str, init: str, body: str
) -> None:
    text = act(effect, minimize, init, body)
    assert "total-cost" not in text
    assert ":numeric-fluents" in text
    assert re.search(r"\(:metric minimize .*\(n\)", text)


def test_controller_calls_are_counted_where_they_differ() -> None:
    one = "behavior one(x: T):\n  body: do go(x)\n  eff: p[x] = True\n"
    two = "behavior two(x: T):\n  body:\n    do go(x)\n    do rest()\n  eff: p[x] = True\n"
    none = "behavior none(x: T):\n  eff: p[x] = False\n"
    assert "total-cost" not in task_of(HEAD + one, PROBLEM).domain
    assert charges(task_of(HEAD + one + two + none, PROBLEM).domain) == ["1", "2"]


@needs_planner
def test_an_optimal_plan_costs_what_the_program_says() -> None:
    domain, problem = re.split(r"^(?=problem )", GOLDEN.read_text(), flags=re.MULTILINE)
    task, _, stated = emitted(domain, problem)
    assert task is not None
    assert stated is not None
    result = solve_task(task, stated, "fast-downward-opt", time_limit=60)
    # Drying c, then flying there, beats flying there as it is and driving through b.
    assert [step.controller for step in result.steps] == ["wait", "fly"]
    assert result.cost == 4.5
