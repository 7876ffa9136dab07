"""The replayer: a trace, item by item, to its end or the first item that fails."""

from dataclasses import replace

import pytest
from programs import expression_of, problem_of

from crow.problem import Problem
from crow.replay import goal_item, replay, replay_to_goal
from crow.trace import AssertItem, DoItem, EffItem, Trace, item_json
from crow.transition import apply

DOMAIN = """
typedef T
feature p(x: T)
feature q(x: T)
feature n() -> int32
controller go(x: T)
controller make(x: T):
  eff:
    p[x] = True
behavior first(x: T):
  body:
    assert not p(x)
    do make(x)
    do go(x)
  eff:
    n = 1
behavior second(x: T):
  body:
    achieve p(x)
    do go(x)
  eff:
    q[x] = True
"""
PROBLEM = 'problem "p"\nobjects:\n  a, b: T\ngoal: q(a) and n == 1\n'


def sound() -> tuple[Problem, Trace]:
    problem = problem_of(DOMAIN, PROBLEM)
    behaviors = problem.world.behaviors
    first = apply(problem.world, problem.initial, behaviors["first"], ("a",))
    second = apply(problem.world, first.state, behaviors["second"], ("a",))
    assert first.problem is second.problem is None
    return problem, (*first.trace, *second.trace)


def test_a_sound_trace_reaches_the_goal() -> None:
    problem, trace = sound()
    replayed = replay_to_goal(problem, trace)
    assert replayed.is_sound
    assert len(replayed.states) == len(trace) + 2  # the initial state, and the goal item
    assert replayed.final.cells == {("p", ("a",)): True, ("n", ()): 1, ("q", ("a",)): True}


def test_the_first_item_that_fails_is_named_and_nothing_runs_after_it() -> None:
    problem, trace = sound()
    again = (*trace, *trace)
    replayed = replay(problem.world, problem.initial, again)
    assert replayed.failure is not None
    assert replayed.failure.index == len(trace)
    assert (replayed.failure.condition, replayed.failure.reason) == ("not p(x)", "it is false here")
    assert replayed.failure.location is not None
    assert len(replayed.states) == len(trace) + 1


def test_a_goal_that_does_not_hold() -> None:
    problem, trace = sound()
    replayed = replay_to_goal(problem, trace[:-1])
    assert replayed.failure is not None
    assert replayed.failure.condition == "q(a) and n() == 1"
    assert not replayed.is_sound


def test_an_empty_trace() -> None:
    problem = problem_of(DOMAIN, PROBLEM.replace("q(a) and n == 1", "not q(a)"))
    assert replay_to_goal(problem, ()).is_sound
    assert replay(problem.world, problem.initial, ()).final is problem.initial


@pytest.mark.parametrize("change", ["gone", "of another", "with other arguments"])
def test_a_controllers_effect_follows_its_do(change: str) -> None:
    problem, trace = sound()
    index = next(i for i, item in enumerate(trace) if isinstance(item, EffItem))
    effect = trace[index]
    assert isinstance(effect, EffItem)
    other = {
        "gone": (),
        "of another": (replace(effect, owner="second"),),
        "with other arguments": (replace(effect, variables={"x": "b"}),),
    }[change]
    replayed = replay(problem.world, problem.initial, (*trace[:index], *other, *trace[index + 1 :]))
    assert replayed.failure is not None
    assert replayed.failure.index == index - 1
    assert replayed.failure.condition == "do make(a)"
    assert replayed.failure.reason == "its effect does not follow"


def test_an_effect_without_a_value_is_a_failure_with_a_place() -> None:
    domain = DOMAIN + "behavior third():\n  eff:\n    n = 1 // n\n"
    problem = problem_of(domain, PROBLEM)
    third = problem.world.behaviors["third"]
    assert third.effect is not None
    trace = (EffItem("third", third.effect, (), {}),)
    failure = replay(problem.world, problem.initial, trace).failure
    assert failure is not None
    assert (failure.condition, failure.reason) == ("eff of third", "division by zero")
    assert failure.location is not None


def test_a_condition_without_a_value_is_a_failure() -> None:
    problem, _ = sound()
    condition = expression_of(DOMAIN, "1 // n == 1", "a, b: T")
    item = AssertItem(condition, {}, "1 // n() == 1")
    failure = replay(problem.world, problem.initial, (item,)).failure
    assert failure is not None
    assert (failure.condition, failure.reason) == ("1 // n() == 1", "division by zero")


def test_items_as_json() -> None:
    problem, trace = sound()
    assert [item_json(item) for item in trace[:3]] == [
        {"assert": "not p(x)", "variables": {"x": "a"}},
        {"do": "make", "arguments": ["a"]},
        {"eff": "make", "variables": {"x": "a"}},
    ]
    assert goal_item(problem.goal).text == "q(a) and n() == 1"
    assert DoItem("go", ("a",)) == DoItem("go", ("a",))
