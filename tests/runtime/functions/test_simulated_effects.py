"""Effects of controllers that Python computes, on every engine, and what carries them out."""

from typing import Any

import numpy as np
import pytest
from small_program import problem

import crow
from crow.planning import ENGINES
from crow.problem import Problem
from crow.replay import replay_to_goal
from crow.unknowns import Touched, Unknown

INITIAL = problem(None).initial


@crow.effect
def carry(state: Any, b: str, to: Any) -> dict[Any, Any]:
    """A simulator: what is carried is held, and what lies there already holds it."""
    below = [t for (t,), spot in state.cells("at").items() if tuple(spot) == tuple(to) and t != b]
    return {
        ("at", (b,)): np.array(to),
        ("held", b): True,
        f"on({b})": below[0] if below else "table",
        "count": state.count() + 1,
    }


@crow.effect
def note(state: Any, p: Any) -> dict[Any, Any]:
    return {"last": p}


PYTHON = {
    "free": lambda state, b: not state.held(b),
    "path": lambda a, b: [a, b],
    "middle": lambda a, b: b,
    "carry": carry,
    "note": note,
}


def simulated(goal: str, **other: Any) -> Problem:
    return problem({**PYTHON, **other}, goal)


def changes(python: Any, *arguments: Any) -> Any:
    world = problem({"carry": crow.effect(python)}).world
    return world.externals.effects["carry"].changes(INITIAL.cells, arguments)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(
    ("goal", "calls"),
    [
        ("held(a)", ["carry"]),
        ("on(a) == b", ["carry", "note"]),
        ("on(a) == b and count == 1", ["carry", "note"]),
        ("on(a) == b and held(a)", ["carry"]),
        ("count == 1", ["carry"]),
    ],
)
def test_plans_are_found_and_replay(engine: str, goal: str, calls: list[str]) -> None:
    made = simulated(goal)
    plan = crow.plan(made, engine, depth_limit=4)
    assert isinstance(plan, crow.Plan)
    assert [step.controller for step in plan.steps][: len(calls)] == calls
    again = simulated(goal)  # without what the first world remembers
    replayed = replay_to_goal(again, plan.trace)
    assert replayed.failure is None
    assert replayed.final.cells["count", ()] == sum(s.controller == "carry" for s in plan.steps)


@pytest.mark.parametrize("engine", ENGINES)
def test_what_a_simulator_does_not_do_is_not_planned(engine: str) -> None:
    still = crow.effect("carry")(lambda state, b, to: {"count": 1})
    assert not isinstance(
        crow.plan(simulated("held(a)", carry=still), engine, depth_limit=3), crow.Plan
    )


def test_the_cheapest_plan_does_not_take_a_simulator_for_growing() -> None:
    made = problem(PYTHON, "on(a) == b")
    from crow.search.optimal import only_grows

    goal = made.changed(minimize=problem(None, "count == 0").goal.left)  # type: ignore[union-attr]
    assert not only_grows(goal)
    assert only_grows(problem(None).changed(minimize=goal.minimize))


def test_arguments_are_given_out_as_python_has_them() -> None:
    plan = crow.plan(simulated("on(a) == b"))
    assert isinstance(plan, crow.Plan)
    _, last = plan.steps
    assert last.arguments == ([(0.0, 1.0), (2.0, 1.0)],)
    document = plan.json()
    assert document["steps"][1]["arguments"] == [{"opaque": "[(0.0, 1.0), (2.0, 1.0)]"}]


def test_it_is_computed_once_for_a_state() -> None:
    asked: list[Any] = []

    def counted(state: Any, b: str, to: Any) -> dict[Any, Any]:
        asked.append((b, to, state.count()))
        return {"count": state.count() + 1}

    effect = problem({"carry": crow.effect(counted)}).world.externals.effects["carry"]
    for _ in range(2):
        effect.changes(INITIAL.cells, ("a", (0, 0)))
    effect.changes({**INITIAL.cells, ("count", ()): 4}, ("a", (0, 0)))
    assert asked == [("a", (0.0, 0.0), 0), ("a", (0.0, 0.0), 4)]


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (None, "returned `None`, where a mapping"),
        ([("count", 1)], "where a mapping"),
        ({"cuont": 1}, "no feature `cuont`; did you mean `count`?"),
        ({("at", "c"): (0, 0)}, "no object `c`"),
        ({("held", "table"): True}, "is a `Thing`, not a `Box`"),
        ({"at": (0, 0)}, "`at` takes 1 objects, not 0"),
        ({3: 1}, "`3` is no cell"),
        ({"count": 1.5}, "gave `count()` what does not fit"),
        ({"count": 1 << 40}, "does not fit into `int32`"),
        ({("at", "a"): (0, np.nan)}, "`nan` is no value"),
        ({("at", "a"): np.zeros(3)}, "an array of shape (3,)"),
        ({("on", "a"): "tabel"}, "no object `tabel`"),
        ({"held(a)": True, ("held", ("a",)): False}, "gave two values"),
    ],
)
def test_what_is_no_effect_is_an_error(given: Any, said: str) -> None:
    with pytest.raises(crow.FunctionError) as raised:
        changes(lambda *_: given, "a", (0.0, 0.0))
    assert said in raised.value.reason


def test_exceptions_end_the_search() -> None:
    made = simulated("held(a)", carry=crow.effect("carry")(lambda state, b, to: 1 / 0))
    with pytest.raises(crow.FunctionError, match="ZeroDivisionError"):
        crow.plan(made)


def test_no_simulator_sees_an_unknown() -> None:
    world = problem({"carry": crow.effect(lambda *_: 1 / 0)}).world
    effect, unknown = world.externals.effects["carry"], Unknown("s", world.features["at"].type)
    with pytest.raises(Touched):
        effect.changes(INITIAL.cells, ("a", unknown))
    with pytest.raises(Touched):
        effect.changes({**INITIAL.cells, ("at", ("b",)): unknown}, ("a", (0.0, 0.0)))


# ------------------------------------------------------------------------------------- carrying out


class World:
    """A world that does what the simulator says, but the first call, which fails."""

    def __init__(self, made: Problem) -> None:
        self.made = made
        self.state = made.initial
        self.done: list[Any] = []

    def observe(self) -> Any:
        return self.state

    def _run(self, name: str, *arguments: Any) -> Any:
        self.done.append((name, *arguments))
        if len(self.done) == 1:
            return "failed"
        effect = self.made.world.externals.effects[name]
        inside = tuple(tuple(a) if isinstance(a, tuple) else a for a in arguments)
        self.state = self.made.world.updated(self.state, effect.changes(self.state.cells, inside))
        return None

    @crow.controller("carry")
    def carried(self, b: str, to: Any) -> Any:
        return self._run("carry", b, to)

    @crow.controller("wait")
    def waited(self) -> None:
        self.done.append("wait")

    @crow.controller("note")
    def noted(self, p: Any) -> Any:
        self.done.append(("note", p))


def test_a_robot_carries_controllers_out() -> None:
    made = simulated("held(a)")
    world = World(made)
    from dataclasses import replace

    from crow.registration import registered

    given = registered(made.world.program, world)
    robots = replace(made.world.registered, controllers=given.controllers)
    runs = made.changed(world=replace(made.world, registered=robots))
    record = crow.execute(runs, crow.Robot(runs, world.observe))
    assert record.status == "done", record.text()
    assert world.done == [("carry", "a", (0.0, 1.0))] * 2
    assert [c.arguments for c in record.calls] == [("a", (0.0, 1.0))]


def test_a_robot_without_a_controller_that_behaviors_run_is_refused() -> None:
    given = {**PYTHON, "carry": crow.controller(lambda b, to: None)}
    with pytest.raises(crow.FunctionsError, match="`note` has no `@crow") as raised:
        crow.Robot(problem(given), lambda: INITIAL)
    assert [m.message for m in raised.value.mistakes] == ["`note` has no `@crow.controller`"]


def test_opaque_arguments_of_calls_are_those_of_python() -> None:
    policy = crow.Policy(simulated("on(a) == b"))
    first = policy.step(INITIAL)
    assert isinstance(first, crow.ControllerCall)
    assert first == crow.ControllerCall("carry", ("a", (2.0, 1.0)))
    after = {**INITIAL.cells, **changes(carry, "a", (2.0, 1.0))}
    second = policy.step(after)
    assert isinstance(second, crow.ControllerCall)
    assert second.arguments == ([(0.0, 1.0), (2.0, 1.0)],)
    assert hash(second) == hash(crow.ControllerCall("note", second.arguments))
    assert second != crow.ControllerCall("note", ([(0.0, 1.0), (2.0, 1.0)],))
