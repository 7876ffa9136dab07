"""Behaviors applied one after another, and the states they are shown with."""

import json
import time

from programs import problem_of
from small_plan import SMALL

from cdlc.diagnostics import Collector
from cdlc.plans.simulate import Simulation, simulate, state_json, state_text
from cdlc.source import SourceFile


def simulated(*steps: str) -> tuple[Simulation, Collector]:
    found = Collector()
    sources = dict[str, SourceFile]()
    result = simulate(SMALL.problem, list(steps), found, sources)
    assert all(name.startswith("<step ") for name in sources)
    return result, found


def test_steps_are_applied_in_order() -> None:
    result, found = simulated("silent(u)", "first(a, y=b)")
    assert not found.found
    assert (result.is_complete, result.failed) == (True, None)
    assert result.json() == {
        "version": 1,
        "state": {"p(b)": True, "p(u)": True, "q(a)": True, "on(b, a)": True, "on(b, u)": True},
    }


def test_no_step_shows_the_initial_state() -> None:
    result, _ = simulated()
    assert state_text(result.world, result.state) == "on(a, b)\non(b, a)\non(b, u)\n"


def test_a_failed_step_leaves_the_state_before_it() -> None:
    result, found = simulated("silent(u)", "silent(u)", "first(a)")
    (diagnostic,) = found
    assert diagnostic.code == "step-failed"
    assert diagnostic.message() == (
        "step 2 cannot be applied: `not p(u)`: it is false where it stands"
    )
    assert str(diagnostic.location) == "<step 2>:1:1"
    assert [str(label.location) for label in diagnostic.labels()] == ["domain.cdl:24:5"]
    document = json.loads(json.dumps(result.json()))
    assert document["failed"]["step"] == "silent(u)"
    assert document["failed"]["span"]["start"] == {"line": 24, "column": 5}
    assert "p(u)" in document["state"]
    assert not result.is_complete


def test_an_open_choice_lists_what_it_can_be() -> None:
    result, found = simulated("first(b)")
    (diagnostic,) = found
    assert diagnostic.code == "open-choice"
    assert diagnostic.message() == "`y` can be `a` or `u`"
    assert diagnostic.help()[0].text == "name one: `y=a`"
    assert not result.is_complete
    assert result.failed is None


def test_a_step_that_is_none() -> None:
    result, found = simulated("first(a)", "frist(a)")
    (diagnostic,) = found
    assert (diagnostic.code, str(diagnostic.location)) == ("bad-step", "<step 2>:1:1")
    assert not result.is_complete


VALUES = """
typedef T
typedef pose: vector[float32, 2]
feature flag()
feature p(x: T)
feature n() -> int64
feature f(x: T) -> float64
feature at(x: T) -> pose
feature where(x: T) -> T
feature name(x: T) -> string
"""


def test_values_are_shown_as_cdl_writes_them() -> None:
    problem = problem_of(
        VALUES,
        'problem "p"\nobjects:\n  a, b: T\ninit:\n  flag = True\n  f[a] = 2\n  at[b] = [1, 2.5]\n'
        '  where[a] = b\n  name[a] = "x\\"y"\ngoal: True\n',
    )
    world, state = problem.world, problem.initial
    assert state_json(world, state) == {
        "flag()": True, "n()": 0, "f(a)": 2.0, "f(b)": 0.0, "at(a)": None, "at(b)": [1.0, 2.5],
        "where(a)": "b", "where(b)": None, "name(a)": 'x"y', "name(b)": None,
    }  # fmt: skip
    assert state_text(world, state) == (
        "flag()\nn() = 0\nf(a) = 2.0\nf(b) = 0.0\nat(a) = ?\nat(b) = [1.0, 2.5]\n"
        'where(a) = b\nwhere(b) = ?\nname(a) = "x\\"y"\nname(b) = ?\n'
    )


def test_a_state_of_many_false_cells_is_shown_at_once() -> None:
    objects = ", ".join(f"o{i}" for i in range(400))
    problem = problem_of(
        "typedef T\nfeature r(x: T, y: T, z: T)\n",
        f'problem "p"\nobjects:\n  {objects}: T\ninit: r[o7, o2, o399] = True\ngoal: True\n',
    )
    began = time.monotonic()
    assert state_text(problem.world, problem.initial) == "r(o7, o2, o399)\n"
    assert time.monotonic() - began < 2
