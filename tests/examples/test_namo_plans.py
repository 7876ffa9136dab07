"""NAMO planned: what the strategies solve, plans in a simulator, and a plan that is disturbed."""

import json
import re
import subprocess
import sys
from typing import get_args

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from namo_enumeration import Maze
from namo_simulator import Simulation, arrives
from support import EXAMPLES, ROOT, cdlc

import crow
from crow.execution import Planned
from examples import namo

SOLVED = [
    ("easy", "direct"),
    ("easy", "waypoint"),
    ("easy", "interleaved"),
    ("medium", "waypoint"),
    ("medium", "interleaved"),
    ("hard", "interleaved"),
]
UNSOLVABLE = [("medium", "direct"), ("hard", "direct"), ("hard", "waypoint")]
LIMIT = 60


def carried_out(text: str, plan: crow.Plan) -> Simulation:
    return arrives(text, [(step.controller or "", step.arguments) for step in plan.steps])


def text_of(name: str) -> str:
    return "\n".join(namo.rows_of(name))


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(("name", "strategy"), SOLVED)
def test_plans_arrive_without_a_collision(name: str, strategy: namo.Strategy, seed: int) -> None:
    result = crow.plan(namo.problem(name, strategy), seed=seed, time_limit=LIMIT)
    assert isinstance(result, crow.Plan)
    carried_out(text_of(name), result)


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize(("name", "strategy"), UNSOLVABLE)
def test_what_a_strategy_cannot_do_is_proved(name: str, strategy: namo.Strategy, seed: int) -> None:
    result = crow.plan(namo.problem(name, strategy), seed=seed, time_limit=LIMIT)
    assert isinstance(result, crow.Unsolvable)


@st.composite
def small_maps(draw: st.DrawFn) -> str:
    rows, columns = draw(st.sampled_from([(2, 3), (2, 4), (3, 3)]))
    letters = st.sampled_from(".....#ab")
    cells = draw(st.lists(letters, min_size=rows * columns, max_size=rows * columns))
    start, goal = draw(st.permutations(range(rows * columns)))[:2]
    cells[start], cells[goal] = "S", "G"
    text = "".join(cells)
    return "\n".join(text[r * columns : (r + 1) * columns] for r in range(rows))


@settings(max_examples=40, suppress_health_check=[HealthCheck.filter_too_much])
@given(small_maps(), st.sampled_from(get_args(namo.Strategy)), st.integers(0, 9))
def test_the_planner_solves_what_the_enumeration_does(
    text: str, strategy: namo.Strategy, seed: int
) -> None:
    maze = Maze(text)
    assume(maze.goal in maze.waypoints())
    can = {"direct": maze.direct, "waypoint": maze.by_waypoint, "interleaved": maze.interleaved}
    result = crow.plan(namo.problem(text, strategy), seed=seed, time_limit=5 * LIMIT)
    if can[strategy]():
        assert isinstance(result, crow.Plan)
        carried_out(text, result)
    else:
        assert isinstance(result, crow.Unsolvable)


@pytest.mark.parametrize("make", [namo.suite, namo.corridor])
@pytest.mark.parametrize(("size", "obstacles"), [(5, 4), (10, 7)])
def test_rooms_are_left(make: object, size: int, obstacles: int) -> None:
    assert callable(make)
    text = make(size, obstacles)
    result = crow.plan(namo.problem(text, "direct"), time_limit=LIMIT)
    assert isinstance(result, crow.Plan)
    carried_out(text, result)


PLAN = """
import json, crow
from examples import namo
result = crow.plan(namo.problem("hard"), seed=7, node_limit=1_000_000)
print(json.dumps([[s.controller, list(s.arguments)] for s in result.steps]))
"""


def test_a_seed_gives_the_same_plan_in_every_process() -> None:
    found = [
        subprocess.run(
            [sys.executable, "-c", PLAN],
            cwd=ROOT,
            env={"PYTHONPATH": f"{ROOT}:{ROOT / 'runtime'}", "PYTHONHASHSEED": seed},
            capture_output=True,
            check=True,
            timeout=120,
        ).stdout
        for seed in ("1", "2")
    ]
    assert found[0] == found[1]
    arrives(text_of("hard"), [(c, a) for c, a in json.loads(found[0])])


@pytest.mark.parametrize("name", namo.MAPS)
def test_the_command_line_plans_them(name: str) -> None:
    folder = EXAMPLES / "namo"
    ran = cdlc("plan", folder / f"{name}.cdl", "--functions", folder / "world.py")
    assert ran.status == 0, ran.err
    assert ran.out.count("exec_traj") >= 4


def test_the_example_s_own_command_draws_a_plan(tmp_path: object) -> None:
    file = f"{tmp_path}/hard.gif"
    ran = subprocess.run(
        [sys.executable, "-m", "examples.namo", "hard", "-o", file],
        cwd=ROOT, capture_output=True, text=True, check=False, timeout=120,
    )  # fmt: skip
    assert (ran.returncode, ran.stdout.strip()) == (0, file), ran.stderr


# ------------------------------------------------------------------------------------ disturbances


@pytest.mark.parametrize("name", ["easy", "medium"])
@pytest.mark.parametrize("seed", range(3))
def test_an_obstacle_that_is_pushed_back_is_moved_again(name: str, seed: int) -> None:
    problem = namo.problem(name, "waypoint")
    robot = namo.PushedBack(problem)
    record = crow.execute(problem, robot, seed=seed, time_limit=LIMIT)
    assert record.status == "done", record.text()
    assert robot.scene.agent == robot.scene.marked("G")
    assert robot.pushed is not None
    plans = [event for event in record.events if isinstance(event, Planned)]
    assert len(plans) >= 2
    assert plans[1].reason is not None
    # What the robot did is possible in the other simulator, too, with the same hand in it.
    simulation = Simulation.of(text_of(name))
    first, done = Simulation.of(text_of(name)).obstacles, False
    for call in record.calls:
        simulation.step(call.controller, call.arguments)
        if not done and call.controller == "exec_traj" and not simulation.held:
            moved = {o for o, cells in simulation.obstacles.items() if cells != first[o]}
            if robot.pushed in moved:
                simulation.obstacles[robot.pushed] = first[robot.pushed]
                simulation.check()
                done = True
    assert done
    assert simulation.agent == simulation.goal


def test_the_story_is_told() -> None:
    ran = subprocess.run(
        [sys.executable, "-m", "examples.namo", "easy", "--strategy", "waypoint", "--disturb"],
        cwd=ROOT, capture_output=True, text=True, check=False, timeout=120,
    )  # fmt: skip
    assert ran.returncode == 0, ran.stderr
    assert re.search(r"plan of \d+ calls, as ", ran.stdout)
    assert ran.stdout.rstrip().endswith("done: the goal holds")
