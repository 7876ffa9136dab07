"""NAMO problems: maps, what the strategies can do with them, and simulated worlds and plans."""

import json
import re
from itertools import pairwise
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest
from namo_enumeration import Maze, flooded
from namo_simulator import CrashError, Simulation, arrives
from PIL import Image, ImageColor
from support import EXAMPLES

import cdlc
import crow
from crow.program import Apply, Expression, Vector
from examples import namo
from examples.namo import world
from examples.namo.render import AGENT, FLOOR, WALL, colour, drawn, written

FOLDER = EXAMPLES / "namo"
MATRIX = {
    ("easy", "direct"): True,
    ("easy", "waypoint"): True,
    ("easy", "interleaved"): True,
    ("medium", "direct"): False,
    ("medium", "waypoint"): True,
    ("medium", "interleaved"): True,
    ("hard", "direct"): False,
    ("hard", "waypoint"): False,
    ("hard", "interleaved"): True,
}


def text_of(name: str) -> str:
    return "\n".join(namo.rows_of(name))


# ---------------------------------------------------------------------------------------- problems


def elements(goal: Expression) -> tuple[Expression, ...]:
    """Those of the vector in `at([2, 3])`."""
    assert isinstance(goal, Apply)
    (vector,) = goal.arguments
    assert isinstance(vector, Vector)
    return vector.elements


@pytest.mark.parametrize("name", namo.MAPS)
def test_problem_files_are_the_maps(name: str) -> None:
    file = FOLDER / f"{name}.cdl"
    filed = cdlc.load_problem(file, functions=world)
    strategy = re.search(r'^domain "(\w+).cdl"', file.read_text(), re.MULTILINE)
    assert strategy is not None
    stated = namo.problem(name, strategy[1])  # type: ignore[arg-type]
    assert dict(filed.initial.cells) == dict(stated.initial.cells)
    assert filed.world.objects == stated.world.objects
    assert elements(filed.goal) == elements(stated.goal)
    assert filed.name == stated.name


def test_each_strategy_is_a_program_of_its_own() -> None:
    names = [namo.problem("easy", s).world.program.name for s in namo.STRATEGIES]
    assert names == ["namo-direct", "namo-waypoint", "namo-interleaved"]


def module(**functions: object) -> ModuleType:
    made = ModuleType("functions")
    vars(made).update(functions)
    return made


def test_a_module_may_have_functions_for_other_programs() -> None:
    functions = {name: f for name, f in vars(world).items() if callable(f)}
    cdlc.load(FOLDER / "direct.cdl", functions=module(**functions))
    del functions["blocking"]
    functions["blockng"] = crow.function("blockng")(lambda state, o, t: False)
    with pytest.raises(cdlc.CompileError, match="did you mean `blocking`") as raised:
        cdlc.load(FOLDER / "direct.cdl", functions=module(**functions))
    assert "no generator `waypoints`" not in str(raised.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "equally long"),
        ("S.\nG", "equally long"),
        ("S.\nG?", r"`\?` stands for nothing"),
        ("SS\n.G", "one start, `S`, not 2"),
        ("S.\n..", "one goal, `G`, not 0"),
        ("esay", "`e` |one start"),
    ],
)
def test_what_is_no_map_is_refused(text: str, message: str) -> None:
    with pytest.raises(namo.MapError, match=message):
        namo.problem(text)


# -------------------------------------------------------------------------------------- strategies


@pytest.mark.parametrize(("name", "strategy"), MATRIX)
def test_maps_need_the_strategies_that_they_were_made_for(name: str, strategy: str) -> None:
    maze = Maze(text_of(name))
    solves = {
        "direct": maze.direct,
        "waypoint": maze.by_waypoint,
        "interleaved": maze.interleaved,
    }
    assert solves[strategy]() == MATRIX[name, strategy]


def test_the_enumeration_knows_what_is_out_of_reach() -> None:
    assert Maze("S.G").direct()
    assert not Maze("Sa.G").interleaved()  # it can be pushed, and is still in the way
    assert Maze("S.aG\n#..#").direct()
    assert not Maze("S#aG").interleaved()


# --------------------------------------------------------------------------------- simulated worlds

LANE = "S.a.G\n#...#"
AROUND = [
    ("exec_traj", (((0, 0), (0, 1)),)),
    ("attach", ("a",)),
    ("exec_traj", (((0, 1), (1, 1)),)),
    ("detach", ("a",)),
    ("exec_traj", (((1, 1), (0, 1), (0, 2), (0, 3), (0, 4)),)),
]


def test_the_simulator_carries_out_what_can_be_done() -> None:
    end = arrives(LANE, AROUND)
    assert end.obstacles == {"a": frozenset([(1, 2)])}


@pytest.mark.parametrize(
    ("steps", "message"),
    [
        ([("attach", ("a",))], "not beside"),
        ([*AROUND[:2], ("attach", ("a",))], "is attached"),
        ([("detach", ("a",))], "not attached"),
        ([("exec_traj", (((0, 0), (0, 1), (0, 2)),))], "ran into the agent|ran into a"),
        ([("exec_traj", (((0, 0), (1, 0)),))], "ran into a wall"),
        ([("exec_traj", (((0, 0), (-1, 0)),))], "ran into a wall"),
        ([("exec_traj", (((0, 0), (0, 2)),))], "no step"),
        ([("exec_traj", (((0, 1), (0, 2)),))], "cannot set out"),
        ([*AROUND[:2], ("exec_traj", (((0, 1), (0, 0), (-1, 0)),))], "ran into a wall"),
        (AROUND[:2], "ended at"),
        ([*AROUND[:3], AROUND[4]], "ran into"),
        ([("dance", ())], "nobody knows"),
    ],
)
def test_the_simulator_refuses_what_cannot_be_done(
    steps: list[tuple[str, tuple[object, ...]]], message: str
) -> None:
    with pytest.raises(CrashError, match=message):
        arrives(LANE, steps)


def test_the_example_s_robot_does_what_the_simulator_does() -> None:
    robot, simulation = namo.Robot(namo.problem(LANE)), Simulation.of(LANE)
    for controller, arguments in AROUND:
        assert robot.act(controller, arguments) == "done"
        simulation.step(controller, arguments)
        assert robot.scene.agent == simulation.agent
        assert {o: frozenset(robot.scene.cells(o)) for o in "a"} == simulation.obstacles
        assert robot.scene.held == simulation.held
    assert robot.observe()["position", ("a",)] == (1, 2)
    for scene, after in pairwise(robot.seen):
        assert abs(scene.agent[0] - after.agent[0]) + abs(scene.agent[1] - after.agent[1]) <= 1


@pytest.mark.parametrize(
    "steps",
    [
        [("attach", ("a",))],
        [("exec_traj", (((0, 1), (0, 2)),))],
        [*AROUND[:2], ("exec_traj", (((0, 1), (0, 0), (-1, 0)),))],
    ],
)
def test_the_example_s_robot_fails_where_something_is_in_the_way(
    steps: list[tuple[str, tuple[object, ...]]],
) -> None:
    robot = namo.Robot(namo.problem(LANE))
    assert [robot.act(*step) for step in steps] == ["done"] * (len(steps) - 1) + ["failed"]
    assert robot.scene.is_possible()


def test_the_robot_stops_where_it_ran_into_something() -> None:
    robot = namo.Robot(namo.problem(LANE))
    assert robot.act("exec_traj", (((0, 0), (0, 1), (0, 2)),)) == "failed"
    assert robot.scene.agent == (0, 1)


def test_somebody_pushes_an_obstacle_back_once() -> None:
    robot = namo.PushedBack(namo.problem(LANE))
    away = [*AROUND[:4], ("exec_traj", (((1, 1), (0, 1)),))]
    assert [robot.act(*step) for step in away] == ["done"] * 5
    assert robot.pushed == "a"
    assert robot.scene.positions == {"a": (0, 2)}
    robot.act("exec_traj", (((0, 1), (0, 0)),))
    for step in AROUND[:4]:
        assert robot.act(*step) == "done"
    assert robot.scene.positions == {"a": (1, 2)}


# --------------------------------------------------------------------------------------- room maps


@pytest.mark.parametrize("make", [namo.suite, namo.corridor])
@pytest.mark.parametrize(("size", "obstacles"), [(5, 4), (10, 7), (20, 10), (30, 14)])
def test_rooms_have_doors_that_obstacles_stand_in(make: object, size: int, obstacles: int) -> None:
    assert callable(make)
    text = make(size, obstacles, seed=1)
    assert text == make(size, obstacles, seed=1)
    assert text != make(size, obstacles, seed=2)
    maze = Maze(text)
    assert len(maze.obstacles) == obstacles
    assert len(maze.open) >= 3 * size**2
    assert maze.goal in maze.waypoints()  # doors are closed
    assert flooded(maze.start, maze.open) >= {maze.goal}


def test_rooms_that_have_no_place_for_obstacles_are_refused() -> None:
    with pytest.raises(ValueError, match="no place"):
        namo.suite(3, 20)
    with pytest.raises(ValueError, match="2 to 26 obstacles"):
        namo.suite(5, 1)
    with pytest.raises(ValueError, match="at least one room"):
        namo.suite(0, 1)


# ---------------------------------------------------------------------------------------- pictures


def plan_of(steps: list[tuple[str, tuple[object, ...]]]) -> SimpleNamespace:
    return SimpleNamespace(steps=[SimpleNamespace(controller=c, arguments=a) for c, a in steps])


def test_pictures_show_walls_agent_and_obstacles(tmp_path: Path) -> None:
    scene = namo.Scene.of(namo.problem("#S.a\n.G.a").initial)
    image = drawn(scene, size=20)
    assert image.size == (80, 40)

    def at(row: int, column: int, inside: tuple[int, int] = (10, 10)) -> object:
        return image.getpixel((column * 20 + inside[0], row * 20 + inside[1]))

    assert at(0, 0) == ImageColor.getrgb(WALL)
    assert at(0, 1) == ImageColor.getrgb(AGENT)
    assert at(0, 2) == at(1, 1) == ImageColor.getrgb(FLOOR)
    assert at(1, 3) == at(0, 3, (10, 19)) == ImageColor.getrgb(colour("a"))


def test_plans_are_written_as_strips_animations_and_pages(tmp_path: Path) -> None:
    problem, plan = namo.problem(LANE), plan_of(AROUND)
    frames = 1 + 1 + 1 + 1 + 1 + 4
    for kind in ("png", "gif", "html"):
        assert namo.picture(problem, plan, tmp_path / f"plan.{kind}").exists()  # type: ignore[arg-type]
    with Image.open(tmp_path / "plan.gif") as moving:
        assert moving.n_frames == frames
    with Image.open(tmp_path / "plan.png") as strip:
        assert strip.size == (4 * 5 * 16 + 3 * 8, 2 * 16)  # the start and three walks
    page = (tmp_path / "plan.html").read_text()
    data = re.search(r"const data = (.*);\n", page)
    assert data is not None
    shown = json.loads(data[1])
    assert len(shown["frames"]) == frames
    assert shown["frames"][-1]["agent"] == shown["goal"] == [0, 4]
    assert "http" not in page
    assert len(list(tmp_path.iterdir())) == 3


def test_a_picture_that_cannot_be_written_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="unknown file extension"):
        namo.picture(namo.problem(LANE), plan_of(AROUND), tmp_path / "plan.xyz")  # type: ignore[arg-type]
    assert list(tmp_path.iterdir()) == []


def test_scenes_are_shown_on_a_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    start = namo.Scene.of(namo.problem(LANE).initial)
    namo.watch(namo.scenes(start, plan_of(AROUND).steps), seconds=0)
    assert "██  a   ██" in capsys.readouterr().out
    assert written(start).plain == "@   a   ()\n██      ██\n"
