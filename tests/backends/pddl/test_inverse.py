"""Plans of the runtime as plans of the emitted PDDL: what becomes of calls, methods and choices."""

from dataclasses import replace

import pytest
from programs import problem_of, task_of

import crow
from cdlc.backends.pddl.inverse import NoAction, to_pddl_plan

PRELUDE = """
typedef T
feature p(x: T)
feature q(x: T)
feature at(x: T) -> T
feature n() -> int64
controller c(x: T)
controller d(x: T):
  eff: q[x] = True
"""
PROBLEM = """problem "p"
objects:
  a, b: T
init:
  foreach x: T: at[x] = b
goal: {goal}
"""


def pddl_plan(domain: str, goal: str = "p(a)", *, problem: str = PROBLEM) -> list[str]:
    """The PDDL plan of the runtime's plan, validated by Kairos."""
    kairos = pytest.importorskip("kairos")
    texts = PRELUDE + domain, problem.format(goal=goal)
    stated, task = problem_of(*texts), task_of(*texts)
    result = crow.plan(stated)
    assert result.status == "plan", result
    steps = to_pddl_plan(task, stated, result)
    lines = [f"({' '.join((step.action, *step.arguments))})" for step in steps]
    report = kairos.validate_plan(
        task.domain, task.problem, kairos.parse_plan("".join(f"{line}\n" for line in lines))
    )
    assert report.status == kairos.ValidationStatus.VALID, (lines, report.diagnostics)
    return lines


def test_a_read_is_a_parameter_with_the_value_it_has() -> None:
    plan = pddl_plan(
        "behavior act(x: T):\n  goal: p(x)\n  body:\n    do c(at(x))\n  eff:\n    p[x] = True\n"
        "    at[x] = x\n"
    )
    assert plan == ["(c b a)"]


def test_several_calls_are_one_action() -> None:
    plan = pddl_plan(
        "behavior act(x: T):\n  goal: p(x)\n  body:\n    do c(x)\n    do c(x)\n  eff: p[x] = True\n"
    )
    assert plan == ["(act a)"]


@pytest.mark.parametrize("own", ["", "\n    do c(y)"])
def test_a_called_behavior_is_part_of_its_caller_s_action(own: str) -> None:
    plan = pddl_plan(
        "behavior part(x: T):\n  body:\n    do c(x)\n  eff: q[x] = True\n"
        "behavior act(x: T):\n  goal: p(x)\n  body:\n    bind y: T where: at(x) == y\n"
        f"    part(y){own}\n  eff: p[x] = True\n"
    )
    (step,) = plan
    assert step.startswith("(act ")


def test_the_steps_of_a_method_are_actions() -> None:
    plan = pddl_plan(
        "behavior act(x: T):\n  goal: q(x)\n  body:\n    do d(at(x))\n    do d(x)\n", "q(a)"
    )
    assert plan == ["(d b a)", "(act a)"]


def test_a_behavior_without_calls_is_an_action() -> None:
    plan = pddl_plan("behavior act(x: T):\n  goal: p(x)\n  eff:\n    p[x] = True\n    n += 1\n")
    assert plan == ["(act a)"]


def test_the_alternative_that_was_taken_is_found() -> None:
    domain = (
        "behavior act(x: T):\n  goal: p(x)\n  body:\n    alternative:\n      assert {first}\n"
        "      assert {second}\n    do c(x)\n  eff: p[x] = True\n"
    )
    plans = [
        pddl_plan(domain.format(first=first, second=second))
        for first, second in (("q(x)", "not q(x)"), ("not q(x)", "q(x)"))
    ]
    assert plans == [["(act a)"], ["(c a)"]]


def test_an_object_that_a_condition_fixes_is_no_parameter() -> None:
    plan = pddl_plan(
        "object_constant home: T\n"
        "behavior act(x: T):\n  goal: p(x)\n  body:\n    bind y: T where: y == home\n"
        "    do c(y)\n  eff:\n    p[x] = True\n    q[y] = True\n"
    )
    assert len(plan) == 1
    assert "home" not in plan[0]


def test_costs_that_depend_on_conditions_choose_the_action() -> None:
    domain = (
        "feature cost() -> int64\n"
        "behavior act(x: T):\n  goal: p(x)\n  body:\n    do c(x)\n  eff:\n    p[x] = True\n"
        "    cost += 1 if q(x) else 3\n"
    )
    problem = PROBLEM + "minimize: cost()\n"
    assert len(pddl_plan(domain, problem=problem)) == 1
    with_q = problem.replace("goal:", "  q[a] = True\ngoal:")
    assert pddl_plan(domain, problem=with_q) != pddl_plan(domain, problem=problem)


def test_what_no_action_stands_for_is_said() -> None:
    texts = (
        PRELUDE + ("behavior act(x: T):\n  goal: p(x)\n  body:\n    do c(x)\n  eff: p[x] = True\n"),
        PROBLEM.format(goal="p(a)"),
    )
    stated, task = problem_of(*texts), task_of(*texts)
    result = crow.plan(stated)
    assert len(to_pddl_plan(task, stated, result)) == 1
    with pytest.raises(NoAction, match=r"stands for `act\(x=a\)`, after 0 effects or calls"):
        to_pddl_plan(replace(task, actions=()), stated, result)


GOING = (
    "behavior go(x: T):\n  goal: at(home) == x\n  body:\n    do c(x)\n  eff: at[home] = x\n"
    "object_constant home: T\n"
)


def test_each_phase_is_an_action() -> None:
    plan = pddl_plan(
        GOING + "behavior act(x: T):\n  goal: p(x)\n  body:\n    do c(x)\n"
        "    achieve at(home) == x\n    do c(home)\n  eff: p[x] = True\n"
    )
    assert [line.split()[0] for line in plan] == ["(act", "(c", "(act-2"]


def test_a_phase_that_only_remembers_is_found() -> None:
    plan = pddl_plan(
        GOING + "behavior act(x: T):\n  goal: p(x)\n  body:\n    let before = at(home)\n"
        "    achieve at(home) == x\n    do c(before)\n  eff:\n    p[x] = True\n"
        "    q[before] = True\n",
        "p(a) and q(b)",
    )
    assert len(plan) == 3
    assert plan[-1].endswith(" b)") or " b " in plan[-1]


def test_a_phase_remembers_numbers() -> None:
    plan = pddl_plan(
        "behavior more(x: T):\n  goal: q(x)\n  body:\n    do c(x)\n  eff:\n    q[x] = True\n"
        "    n += 2\n"
        "behavior act(x: T):\n  goal: p(x)\n  body:\n    let before = n()\n"
        "    achieve q(x)\n    do c(x)\n  eff:\n    p[x] = True\n    n[...] = before + 5\n",
        "p(a) and n() == 5",
    )
    assert len(plan) == 3


def test_two_phases_are_open_at_once() -> None:
    plan = pddl_plan(
        "behavior low(x: T):\n  goal: q(x)\n  body:\n    do c(x)\n    achieve at(x) == x\n"
        "    do c(x)\n  eff: q[x] = True\n"
        "behavior go(x: T, y: T):\n  goal: at(x) == y\n  body:\n    do c(y)\n  eff: at[x] = y\n"
        "behavior act(x: T):\n  goal: p(x)\n  body:\n    do c(x)\n    achieve q(x)\n    do c(x)\n"
        "  eff: p[x] = True\n",
        "p(a) and p(b)",
    )
    assert len(plan) == 9  # `b` is where it has to be already
