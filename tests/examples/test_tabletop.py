"""The table in MuJoCo: what the engine says, plans, and executions in which somebody interferes."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support import EXAMPLES, ROOT, cdlc

import crow
from cdlc import load_problem

pytest.importorskip("mujoco", reason="MuJoCo is in the extra `physics`")

from examples import tabletop
from examples.tabletop import world
from examples.tabletop.world import Setting, Simulation

FLAT = (1.0, 0.0, 0.0, 0.0)
LIMIT = 60


@pytest.fixture(scope="module")
def problem() -> crow.Problem:
    return tabletop.tidy()


@pytest.fixture(scope="module")
def plan(problem: crow.Problem) -> crow.Plan:
    result = crow.plan(problem, time_limit=LIMIT)
    assert isinstance(result, crow.Plan)
    return result


def holds(problem: crow.Problem, name: str, *arguments: Any, **poses: Any) -> bool:
    """What a function says, with some blocks elsewhere."""
    cells = {**problem.initial.cells, **{("pose", (b,)): pose for b, pose in poses.items()}}
    found = problem.world.externals.functions[name].value(cells, arguments)
    assert isinstance(found, bool)
    return found


def drawn(problem: crow.Problem, name: str, inputs: tuple[Any, ...], count: int) -> list[Any]:
    rows = problem.world.externals.generators[name].draw(
        problem.initial, inputs, np.random.default_rng(0)
    )
    return [row[0] for row, _ in zip(rows, range(count), strict=False)]


def effect(problem: crow.Problem, name: str, *arguments: Any, **poses: Any) -> dict[str, Any]:
    """Where blocks are after a call, of those that it moved."""
    cells = {**problem.initial.cells, **{("pose", (b,)): pose for b, pose in poses.items()}}
    changes = problem.world.externals.effects[name].changes(cells, arguments)
    assert {cell[0] for cell in changes} <= {"pose"}
    return {cell[1][0]: value for cell, value in changes.items()}


def is_tidy(poses: dict[str, Any]) -> bool:
    """Whether the goal of `tidy` is reached, by where the blocks are alone."""
    (x, y, z), red, green = (poses[name][:3] for name in ("crate", "red", "green"))
    in_dock = x - 0.07 >= 0.02 and x + 0.07 <= 0.22 and y - 0.07 >= 0.04 and y + 0.07 <= 0.24
    off = [abs(a - b) for u, v in ((red, (x, y)), (green, red)) for a, b in zip(u, v, strict=False)]
    heights = [abs(z - 0.025), abs(red[2] - 0.08), abs(green[2] - 0.14)]
    return bool(in_dock and max(off[:2]) < 0.07 and max(off[2:4]) < 0.03 and max(heights) < 0.003)


# ------------------------------------------------------------------------------------------ engine


def test_what_is_done_aside_is_undone(problem: crow.Problem) -> None:
    robot = tabletop.Robot(problem)
    before = robot.simulation.data.qpos.copy(), robot.simulation.data.time
    assert "blue" in robot.simulation.swept("crate", (0.12, -0.192, 0.12, 0.058))
    with robot.simulation.aside():
        robot.simulation.transfer("red", (0.0, 0.0, 0.03, *FLAT))
        assert robot.simulation.data.time > 1
    assert np.array_equal(robot.simulation.data.qpos, before[0])
    assert robot.simulation.data.time == before[1]


def test_the_same_call_has_the_same_effect_to_the_last_digit(problem: crow.Problem) -> None:
    cells: Any = problem.initial.cells
    poses = {cell[1][0]: value for cell, value in cells.items() if cell[0] == "pose"}
    bodies = tuple(
        world.Body(b, cells["size", (b,)], cells["mass", (b,)]) for b in problem.world.objects
        if b in poses
    )  # fmt: skip
    ends = []
    for _ in range(2):
        simulation = Simulation(Setting(bodies))
        for _ in range(2):  # whatever was done with it before
            simulation.reset(poses)
            simulation.push((0.12, -0.192, 0.12, 0.058))
            ends.append(simulation.poses())
    assert ends[0] == ends[1] == ends[2] == ends[3]


def test_what_is_too_heavy_stays(problem: crow.Problem) -> None:
    assert "crate" not in effect(problem, "transfer", "crate", (-0.1, 0.1, 0.025, *FLAT))
    moved = effect(problem, "transfer", "red", (-0.1, 0.1, 0.03, *FLAT))
    assert list(moved) == ["red"]
    assert moved["red"] == pytest.approx((-0.1, 0.1, 0.03, *FLAT), abs=2e-3)


def test_what_is_put_down_beside_the_edge_falls(problem: crow.Problem) -> None:
    on_top = (0.12, -0.1, 0.08, *FLAT)
    stands = effect(problem, "transfer", "red", on_top)["red"]
    assert holds(problem, "on", "red", "crate", red=stands)
    for x in (0.185, 0.2):  # the crate ends at .19, and a block is .06 wide
        moved = effect(problem, "transfer", "red", (x, *on_top[1:]))["red"]
        assert holds(problem, "on", "red", "crate", red=moved) == (x < 0.19)
        assert (moved[2] > 0.079) == (x < 0.19)


def test_a_block_that_is_pushed_takes_others_along(problem: crow.Problem) -> None:
    moved = effect(problem, "push", "crate", (0.12, -0.192, 0.12, 0.058))
    assert set(moved) == {"crate", "blue"}
    assert moved["crate"][1] == pytest.approx(0.14, abs=5e-3)
    assert moved["blue"][1] > 0.2


# ---------------------------------------------------------------------- functions and generators


@pytest.mark.parametrize(
    ("at", "is_free"),
    [
        ((-0.3, 0.059), False),
        ((-0.3, 0.061), True),
        ((0.0, 0.0), True),
        ((0.12, -0.1), False),
        ((-0.39, 0.2), True),
        ((-0.41, 0.2), False),
    ],
)
def test_blocks_fit_where_nothing_is(
    problem: crow.Problem, at: tuple[float, float], is_free: bool
) -> None:
    assert holds(problem, "fits", "red", "table", (*at, 0.03, *FLAT)) == is_free


def test_blocks_fit_on_the_table_alone(problem: crow.Problem) -> None:
    assert not holds(problem, "fits", "red", "table", (0.0, 0.0, 0.08, *FLAT))
    assert holds(problem, "over", "red", "crate", (0.1, -0.1, 0.08, *FLAT))
    assert not holds(problem, "over", "red", "crate", (0.1, -0.1, 0.12, *FLAT))
    assert not holds(problem, "over", "red", "crate", (0.2, -0.1, 0.08, *FLAT))
    assert not holds(
        problem, "over", "red", "crate", (0.1, -0.1, 0.08, *FLAT), green=(0.1, -0.1, 0.08, *FLAT)
    )


def test_what_is_pushed_hits_what_stands_there(problem: crow.Problem) -> None:
    stroke = (0.12, -0.192, 0.12, 0.058)
    hits = {y: holds(problem, "hits", "crate", stroke, "blue", (0.12, y, 0.03, *FLAT))
            for y in (0.0, 0.1, 0.23, 0.25)}  # fmt: skip
    assert hits == {0.0: True, 0.1: True, 0.23: True, 0.25: False}
    # The rod comes down where it stands.
    assert holds(problem, "hits", "crate", stroke, "blue", (0.12, -0.2, 0.03, *FLAT))


def test_generators_yield_what_their_functions_hold_of(problem: crow.Problem) -> None:
    for p in drawn(problem, "spots", ("blue", "table"), 20):
        assert holds(problem, "fits", "blue", "table", p)
    for p in drawn(problem, "tops", ("red", "crate"), 20):
        assert holds(problem, "over", "red", "crate", p)
    strokes = drawn(problem, "strokes", ("crate", "dock"), 6)
    assert len(set(strokes)) == 6
    for s in strokes:
        assert holds(problem, "pushes", "crate", "dock", s)
    moved = effect(problem, "push", "crate", strokes[0], blue=(-0.1, -0.2, 0.03, *FLAT))
    assert holds(problem, "inside", "crate", "dock", crate=moved["crate"])


def test_there_is_no_stroke_into_a_region_that_is_not_straight_ahead() -> None:
    crate = tabletop.Body("crate", (0.14, 0.14, 0.05), 2.0)
    dock = {"dock": (0.2, 0.1, 0.4, 0.27)}
    problem = tabletop.problem({crate: (-0.1, -0.1)}, dock, "inside(crate, dock)")
    assert drawn(problem, "strokes", ("crate", "dock"), 1) == []
    assert not holds(problem, "pushes", "crate", "dock", (-0.1, -0.192, -0.1, 0.2))


# ------------------------------------------------------------------------------------------- plans


def test_the_problem_file_is_the_problem(problem: crow.Problem) -> None:
    filed = load_problem(EXAMPLES / "tabletop" / "tidy.cdl", functions=world)
    assert dict(filed.initial.cells) == dict(problem.initial.cells)
    assert (filed.world.objects, filed.goal) == (problem.world.objects, problem.goal)


def test_the_command_line_plans() -> None:
    folder = EXAMPLES / "tabletop"
    ran = cdlc("plan", folder / "tidy.cdl", "--functions", folder / "world.py")
    assert ran.status == 0, ran.err
    assert [line.split("(")[0] for line in ran.out.splitlines()] == [
        "1. transfer", "2. push", "3. transfer", "4. transfer",
    ]  # fmt: skip


def test_the_plan_is_what_the_simulator_says(problem: crow.Problem, plan: crow.Plan) -> None:
    calls = [(step.controller, step.arguments[0]) for step in plan.steps]
    assert calls == [
        ("transfer", "blue"),
        ("push", "crate"),
        ("transfer", "red"),
        ("transfer", "green"),
    ]
    cells: Any = plan.states(problem)[-1].cells
    assert is_tidy({c[1][0]: value for c, value in cells.items() if c[0] == "pose"})


@pytest.mark.parametrize("seed", [1, 2])
def test_plans_can_be_carried_out(problem: crow.Problem, seed: int) -> None:
    result = crow.plan(problem, seed=seed, time_limit=LIMIT)
    assert isinstance(result, crow.Plan)
    robot = tabletop.Robot(problem)
    for step in result.steps:
        robot.act(str(step.controller), step.arguments)
    assert is_tidy(robot.simulation.poses())


# ------------------------------------------------------------------------------------- executions


def executed(problem: crow.Problem, **nudges: Any) -> tuple[crow.Execution, tabletop.Robot]:
    robot = tabletop.Robot(problem, {int(k[5:]): nudge for k, nudge in nudges.items()})
    return crow.execute(problem, robot, time_limit=LIMIT, step_limit=12), robot


def plans(record: crow.Execution) -> int:
    return sum("plan" in event.json() for event in record.events)


def test_a_table_that_nobody_touches_is_planned_for_once(problem: crow.Problem) -> None:
    record, robot = executed(problem)
    assert record.status == "done", record.text()
    assert (plans(record), len(record.calls)) == (1, 4)
    assert is_tidy(robot.simulation.poses())


def test_a_crate_that_is_nudged_is_pushed_again(problem: crow.Problem) -> None:
    record, robot = executed(problem, after2=("crate", 0.0, -1.5))
    assert record.status == "done", record.text()
    assert plans(record) == 2
    assert [call.controller for call in record.calls].count("push") == 2
    assert is_tidy(robot.simulation.poses())


def test_a_block_that_is_knocked_off_is_stacked_again(problem: crow.Problem) -> None:
    record, robot = executed(problem, after3=("red", -2.0, 0.0))
    assert record.status == "done", record.text()
    assert plans(record) == 2
    assert [call.arguments[0] for call in record.calls].count("red") == 2
    assert is_tidy(robot.simulation.poses())


def test_what_the_rest_of_the_plan_does_not_need_may_move(problem: crow.Problem) -> None:
    record, robot = executed(problem, after2=("blue", 0.5, 0.0))
    assert record.status == "done", record.text()
    assert plans(record) == 1
    assert is_tidy(robot.simulation.poses())


def test_an_observed_pose_is_the_projected_one_within_its_tolerance(problem: crow.Problem) -> None:
    robot = tabletop.Robot(problem)
    policy = crow.Policy(problem, time_limit=LIMIT)
    call = policy.step(robot.observe())
    assert isinstance(call, crow.ControllerCall)
    first = policy.plan
    robot.act(call.controller, call.arguments)
    before = robot.simulation.pose("red")
    robot.nudge("red", 0.25, 0.0)
    assert 0.001 < robot.simulation.pose("red")[0] - before[0] < 0.01
    policy.step(robot.observe())
    assert policy.plan is first
    assert policy.reason is None


# ---------------------------------------------------------------------------------------- pictures

_RENDER = """
import mujoco
model = mujoco.MjModel.from_xml_string("<mujoco><worldbody/></mujoco>")
mujoco.Renderer(model, 8, 8).close()
"""


@pytest.fixture(scope="module")
def rendering() -> dict[str, str]:
    """An environment in which MuJoCo renders without a display."""
    for library in ("osmesa", "egl"):
        own = {**os.environ, "MUJOCO_GL": library}
        command = [sys.executable, "-c", _RENDER]
        if subprocess.run(command, env=own, check=False, capture_output=True).returncode == 0:
            return own
    pytest.skip("nothing renders without a display: neither libosmesa6 nor libegl1 is there")


def test_a_picture_is_rendered_of_each_call(rendering: dict[str, str], tmp_path: Path) -> None:
    from PIL import Image

    file = tmp_path / "tidy.png"
    command = [sys.executable, "-m", "examples.tabletop", "--disturb", "-o", str(file)]
    done = subprocess.run(
        command, cwd=ROOT, env=rendering, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.endswith("done: the goal holds\n")
    with Image.open(file) as image:
        assert image.size == (3 * 480, 2 * 360)
        panels = [np.asarray(image.crop((480 * i, 0, 480 * i + 480, 360)), int) for i in range(2)]
    # Blue is carried away, so that the dock is seen; all else is where it was.
    differ = np.abs(panels[0] - panels[1]).sum(axis=-1) > 60
    assert 0.005 < differ.mean() < 0.15
    blue = [(p[..., 2] - p[..., 0] > 60) & (p[..., 2] > 120) for p in panels]
    assert [int(b.sum()) > 100 for b in blue] == [True, True]
    columns = [np.nonzero(b)[1].mean() for b in blue]
    assert abs(columns[0] - columns[1]) > 10
