"""What a call in Python reads is looked at wherever what may change it is asked for."""

from math import isinf
from typing import Any

import pytest
from programs import problem_of

import crow
from crow.planning import ENGINES
from crow.problem import Problem
from crow.program.dependencies import features_read, features_written
from crow.registration import registered
from crow.search.machine import Machine
from crow.search.relaxed.costs import costs
from crow.search.relaxed.guide import Guiding

DOMAIN = """
typedef T
feature p(x: T)
feature q(x: T)
feature n() -> int64
feature far() -> int64
def [[reads=p, n]] some(x: T) -> bool
def [[reads=all]] every(x: T) -> bool
def static(x: T) -> bool
def [[reads=n]] doubled() -> int64
def inner(x: T) -> bool:
  return q(x) and some(x)
controller c(x: T)
controller d(x: T)
behavior act(x: T):
  goal: p(x)
  body:
    do c(x)
  eff:
    p[x] = True
    n += 1
behavior after(x: T):
  goal: q(x)
  body:
    assert every(x)
    do d(x)
  eff:
    q[x] = True
"""
PROBLEM = """
problem "p"
objects:
  a, b: T
goal: {goal}
"""
PYTHON: dict[str, Any] = {
    "some": lambda state, x: state.p(x) and state.n() > 0,
    "every": lambda state, x: state.p(x),
    "static": lambda x: x == "a",
    "doubled": lambda state: 2 * state.n(),
}


def problem(goal: str) -> Problem:
    from dataclasses import replace

    made = problem_of(DOMAIN, PROBLEM.format(goal=goal))
    given = registered(made.world.program, PYTHON)
    return made.changed(world=replace(made.world, registered=given))


@pytest.mark.parametrize(
    ("goal", "features"),
    [
        ("some(a)", {"p", "n"}),
        ("every(a)", {"p", "q", "n", "far"}),
        ("static(a)", set()),
        ("inner(a)", {"p", "q", "n"}),
        ("static(a) or doubled() > 3", {"n"}),
        ("q(a)", {"q"}),
    ],
)
def test_features_that_are_read(goal: str, features: set[str]) -> None:
    made = problem(goal)
    assert features_read(made.world.program, (made.goal,)) == features


def test_features_that_are_written() -> None:
    made = problem("p(a)")
    (act, _) = made.world.program.behaviors
    assert list(features_written(made.world.program, act.effect or ())) == ["p", "n"]
    given = registered(made.world.program, {"c": crow.effect(lambda state, x: {})})
    (controller, _) = made.world.of(made.world.program, (), given).program.controllers
    written = features_written(made.world.program, controller.effect or ())
    assert list(written) == ["p", "q", "n", "far"]


@pytest.mark.parametrize("goal", ["some(a)", "every(a)", "inner(a)", "doubled() == 2"])
def test_the_relaxation_knows_what_may_make_a_call_true(goal: str) -> None:
    """Asked for with its opposite at hand, so that the operators of both behaviors are made."""
    made = problem(f"({goal}) or (p(a) and q(a))")
    guiding = Guiding(Machine(made), "ff")
    needs = guiding.operators.conditions.needs(problem(goal).goal, {})
    assert needs
    for behavior in made.world.program.behaviors:
        code = guiding.machine.programs.code(behavior)
        guiding.operators.applied(code, ("a",), is_first=False)
    task = guiding.task
    true = frozenset(task.true_facts(guiding.machine.store.initial))
    found = costs(task, true, frozenset()).facts
    assert not any(isinf(found[number]) for number in needs)


def test_what_no_state_changes_is_decided_at_once() -> None:
    guiding = Guiding(Machine(problem("p(a)")), "ff")
    assert guiding.operators.conditions.needs(problem("static(a)").goal, {}) == ()
    assert guiding.operators.conditions.needs(problem("static(b)").goal, {}) is None


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(
    ("goal", "controllers"),
    [
        ("doubled() == 4", ["c", "c"]),  # by whatever writes what the call reads
        ("q(a) or (q(b) and static(b))", ["c", "d"]),
    ],
)
def test_comparisons_of_calls_are_reached(engine: str, goal: str, controllers: list[str]) -> None:
    made = problem(goal) if "doubled" in goal else problem(f"p(a) and p(b) and ({goal})")
    plan = crow.plan(made, engine, depth_limit=3)
    assert isinstance(plan, crow.Plan)
    assert {step.controller for step in plan.steps} == set(controllers)


IMPERATIVE = """
feature n() -> int64
feature done()
def [[reads=n]] is_even() -> bool
controller c(even: bool)
behavior count_up():
  goal: done()
  body:
    do step_all()
  eff:
    done[...] = True
behavior step():
  body:
    if is_even():
      do c(True)
    else:
      do c(False)
  eff:
    n += 1
"""


def test_a_run_whose_one_state_changes_in_place_asks_again() -> None:
    from dataclasses import replace

    calls = "".join("    step()\n" for _ in range(4))
    made = problem_of(
        IMPERATIVE.replace("    do step_all()\n", calls), 'problem "p"\ngoal: done()\n'
    )
    given = registered(made.world.program, {"is_even": lambda state: state.n() % 2 == 0})
    made = made.changed(world=replace(made.world, registered=given))
    assert made.is_imperative
    for engine in ENGINES:
        plan = crow.plan(made, engine)
        assert isinstance(plan, crow.Plan)
        arguments = [step.arguments for step in plan.steps if step.controller]
        assert arguments == [(True,), (False,), (True,), (False,)], engine
