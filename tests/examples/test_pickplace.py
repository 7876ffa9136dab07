"""Picking and placing: plans checked by arithmetic of their own, what Python computes, pictures."""

import json
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pickplace_checker import Bench, CrashError, carried_out, meets
from PIL import Image, ImageColor
from support import EXAMPLES, cdlc

import crow
from cdlc import load_problem
from examples import pickplace
from examples.pickplace import render, world
from examples.pickplace.__main__ import main

FOLDER = EXAMPLES / "pickplace"
LIMIT = 60
PROBLEMS: dict[str, Callable[[], crow.Problem]] = {
    "tight": pickplace.tight,
    "blocked": pickplace.blocked,
    "crowded": pickplace.crowded,
    "gate": pickplace.gate,
}
WANTED = {"tight": "AB", "blocked": "A", "crowded": "ABCD", "gate": "A"}


def planned(problem: crow.Problem, seed: int = 0) -> crow.Plan:
    result = crow.plan(problem, seed=seed, time_limit=LIMIT)
    assert isinstance(result, crow.Plan), result.summary()
    return result


def checked(problem: crow.Problem, plan: crow.Plan, wanted: str) -> Bench:
    steps = [(step.controller, step.arguments) for step in plan.steps]
    return carried_out(problem.initial.cells, steps, wanted)


# ------------------------------------------------------------------------------------------- plans


@pytest.mark.parametrize("name", PROBLEMS)
def test_problem_files_are_the_problems(name: str) -> None:
    filed = load_problem(FOLDER / f"{name}.cdl", functions=world)
    stated = PROBLEMS[name]()
    assert dict(filed.initial.cells) == dict(stated.initial.cells)
    assert filed.world.objects == stated.world.objects
    assert (filed.name, filed.goal) == (stated.name, stated.goal)


@pytest.mark.parametrize("name", PROBLEMS)
def test_the_command_line_plans(name: str) -> None:
    file = FOLDER / f"{name}.cdl"
    ran = cdlc("plan", file, "--functions", FOLDER / "world.py", "--format", "json")
    assert ran.status == 0, ran.err
    steps = [(s["controller"], s["arguments"]) for s in json.loads(ran.out)["steps"]]
    told = [(name, [_tuples(a) for a in arguments]) for name, arguments in steps]
    carried_out(PROBLEMS[name]().initial.cells, told, WANTED[name])


def _tuples(value: Any) -> Any:
    """What is a list in JSON, as the tuple that it was; an opaque value from how it prints."""
    match value:
        case list():
            return tuple(map(_tuples, value))
        case {"opaque": text}:
            return eval(text, {"__builtins__": {}})
        case _:
            return value


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(
    ("problem", "wanted"),
    [
        *((pickplace.tight(n), "ABCDE"[:n]) for n in range(2, 6)),
        (pickplace.tight(4, room=0.0), "ABCD"),
        *((pickplace.blocked(n), "A") for n in range(2, 6)),
        *((pickplace.crowded(n), "ABCDE"[:n]) for n in range(2, 6)),
        (pickplace.gate(), "A"),
    ],
    ids=lambda value: value.name if isinstance(value, crow.Problem) else None,
)
def test_plans_can_be_carried_out(problem: crow.Problem, wanted: str, seed: int) -> None:
    checked(problem, planned(problem, seed), wanted)


def test_what_is_in_the_way_is_moved_first() -> None:
    problem = pickplace.blocked()
    assert checked(problem, planned(problem), "A").carried == ["B", "A"]
    problem = pickplace.gate()
    assert checked(problem, planned(problem), "A").carried == ["T", "A"]


def test_a_block_is_gripped_where_the_gripper_reaches_it_at_both_ends() -> None:
    layout = pickplace.Layout(
        table=(0.0, 0.0, 10.0, 2.0),
        blocks={"A": (1.0, 1.0)},
        regions={"red": (6.0, 0.0, 8.0, 2.0)},
        gripper=(2.0, 1.0),
        reach=(1.5, 0.0, 7.6, 2.0),
    )
    problem = layout.problem("inside(A, red)")
    bench = checked(problem, planned(problem), "A")
    assert bench.positions["A"] == (7.0, 1.0)
    steps = {step.controller: step.arguments for step in planned(problem).steps}
    assert steps["grip"][1] == (0.5, 0.0)


def test_one_grasp_has_to_do_for_both_ends() -> None:
    layout = pickplace.Layout(
        table=(0.0, 0.0, 10.0, 2.0),
        blocks={"A": (1.0, 1.0)},
        regions={"red": (6.0, 0.0, 8.0, 2.0)},
        gripper=(2.0, 1.0),
        reach=(1.5, 0.0, 7.4, 2.0),
    )
    result = crow.plan(layout.problem("inside(A, red)"), node_limit=2_000)
    assert not isinstance(result, crow.Plan)


def test_a_held_block_is_put_down_for_another() -> None:
    problem = pickplace.tight(2)
    held = {("held", ("B",)): True, ("grasp", ("B",)): (0.5, 0.0), ("gripper", ()): (-2.5, 1.0)}
    cells = {**problem.initial.cells, **held}
    del cells["empty", ()]
    problem = problem.changed(initial=crow.State(cells))
    names = [step.controller for step in planned(problem).steps]
    assert names.count("release") == 2 + names.count("grip") - 1
    assert names[0] == "carry"


def test_a_block_can_be_wanted_in_the_gripper() -> None:
    layout = pickplace.Layout((0.0, 0.0, 9.0, 9.0), {"A": (2.0, 3.0)}, {})
    names = [step.controller for step in planned(layout.problem("held(A)")).steps]
    assert names == ["move", "grip"]


def test_the_same_seed_gives_the_same_plan() -> None:
    first, second, other = (planned(pickplace.crowded(3), seed) for seed in (1, 1, 2))
    assert first.steps == second.steps
    assert len(other.steps) >= 12


# ----------------------------------------------------------------------------------------- checker

A_TO_RED = [
    ("move", ((-3.0, 1.0),)),
    ("grip", ("B", (0.0, 0.0))),
    ("carry", ("B", ((-3.0, 1.0), (6.0, 1.0)))),
    ("release", ("B",)),
]


def test_the_checker_carries_out_what_can_be_done() -> None:
    end = carried_out(pickplace.tight().initial.cells, A_TO_RED, "B")
    assert end.positions["B"] == (6.0, 1.0)


@pytest.mark.parametrize(
    ("steps", "said"),
    [
        (A_TO_RED[1:], "not where B is gripped"),
        (A_TO_RED[:3], "not inside"),
        ([*A_TO_RED[:2], A_TO_RED[0]], "without a path"),
        ([*A_TO_RED[:2], ("carry", ("B", ((0.0, 1.0), (6.0, 1.0))))], "somewhere else"),
        ([*A_TO_RED[:2], ("carry", ("B", ((-3.0, 1.0), (9.5, 1.0))))], "off the table"),
        ([*A_TO_RED[:2], ("carry", ("B", ((-3.0, 1.0), (1.9, 1.0)))), A_TO_RED[3]], "in another"),
        ([*A_TO_RED[:2], ("carry", ("B", ((-3.0, 1.0), (4.9, 1.0)))), A_TO_RED[3]], "not inside"),
        ([("move", ((-11.0, 1.0),))], "out of reach"),
        ([("dance", ())], "nobody knows"),
    ],
)  # fmt: skip
def test_the_checker_refuses_what_cannot(steps: list[tuple[str, Any]], said: str) -> None:
    with pytest.raises(CrashError, match=said):
        carried_out(pickplace.tight().initial.cells, steps, "B")


@pytest.mark.parametrize(
    ("path", "crashes"),
    [
        (((2.0, 4.0), (12.0, 4.0)), True),
        (((2.0, 4.0), (5.5, 4.0)), False),  # it touches
        (((2.0, 4.0), (5.6, 6.3)), True),
        (((2.0, 4.0), (5.0, 4.0), (5.0, 7.0)), False),
    ],
)
def test_the_checker_knows_walls_and_high_blocks(path: Any, crashes: bool) -> None:
    cells = {**pickplace.gate().initial.cells, ("position", ("T",)): (6.5 + 1.0, 4.0)}
    steps = [("move", ((2.0, 4.0),)), ("grip", ("A", (0.0, 0.0))), ("carry", ("A", path))]
    if crashes:
        with pytest.raises(CrashError, match="collision"):
            carried_out(cells, steps)
    else:
        carried_out(cells, steps)


# ---------------------------------------------------------------------------------------- geometry

SIDE = 7
numbers = st.integers(0, SIDE)
points = st.tuples(numbers, numbers)


@st.composite
def obstacles(draw: st.DrawFn) -> list[tuple[float, ...]]:
    """Boxes with whole corners, none without an inside."""
    pairs = draw(st.lists(st.tuples(points, points), max_size=5))
    boxes = [(*map(min, zip(*p, strict=True)), *map(max, zip(*p, strict=True))) for p in pairs]
    return [box for box in boxes if box[0] < box[2] and box[1] < box[3]]


@given(points, points, obstacles())
def test_lines_cross_what_intervals_say(a: Any, b: Any, of: list[Any]) -> None:
    found = world.crossed(np.array(a, float), np.array(b, float), world.boxes(of))[0]
    assert found.tolist() == [meets(a, b, (0.0, 0.0), box) for box in of]


def flooded(start: tuple[int, int], of: list[Any]) -> set[tuple[int, int]]:
    """What a point reaches along lines of whole numbers: sides of obstacles, and between them.

    All in half units, so that what is between two lines has a place of its own.
    """

    def is_free(x: float, y: float) -> bool:
        return not any(u < x < r and v < y < t for u, v, r, t in of)

    found, border = {start}, [start]
    while border:
        x, y = border.pop()
        for p, q in ((x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)):
            is_new = 0 <= p <= 2 * SIDE and 0 <= q <= 2 * SIDE and (p, q) not in found
            if is_new and is_free((x + p) / 4, (y + q) / 4):
                found.add((p, q))
                border.append((p, q))
    return found


@settings(max_examples=200)
@given(points, points, obstacles())
def test_there_is_a_way_where_a_flood_comes_to(a: Any, b: Any, of: list[Any]) -> None:
    room = np.array([0, 0, SIDE, SIDE], float)
    found = world.way(np.array(a, float), np.array(b, float), room, world.boxes(of))
    ends_free = not any(meets(p, p, (0.0, 0.0), box) for p in (a, b) for box in of)
    reached = ends_free and (2 * b[0], 2 * b[1]) in flooded((2 * a[0], 2 * a[1]), of)
    assert (found is not None) == reached
    if found is not None:
        path = [tuple(p) for p in found.tolist()]
        assert path[0] == a
        assert path[-1] == b
        assert not any(meets(p, q, (0.0, 0.0), box) for p, q in pairwise(path) for box in of)


def test_a_way_through_a_gap_touches_its_sides() -> None:
    room, walls = np.array([0, 0, 10, 10.0]), world.boxes([(4, 0, 5, 6), (4, 6, 5, 10)])
    found = world.way(np.array([1.0, 1.0]), np.array([9.0, 9.0]), room, walls)
    assert found is not None
    assert [4.0, 6.0] in found.tolist()


# -------------------------------------------------------------------------------------- generators


def drawn(problem: crow.Problem, name: str, inputs: tuple[Any, ...], count: int) -> list[Any]:
    generator = problem.world.externals.generators[name]
    rows = generator.draw(problem.initial, inputs, np.random.default_rng(0))
    return [row for row, _ in zip(rows, range(count), strict=False)]


def test_spots_are_beside_things_first_and_free_ones_before_others() -> None:
    problem = pickplace.blocked()
    # What touches both sides of the region; B is in each, and in everything else there.
    assert drawn(problem, "spots", ("A", "red"), 2) == [((6.0, 1.0),), ((9.0, 1.0),)]
    spots = [p for (p,) in drawn(problem, "spots", ("A", "table"), 70)]
    assert spots[:4] == [(-7.0, 1.0), (5.5, 1.0), (-9.0, 1.0), (9.0, 1.0)]
    free = problem.world.externals.functions["is_free"]
    is_free = free.values(problem.initial.cells, [("A", p) for p in spots[4:68]])
    assert set(is_free) == {True, False}
    assert is_free == sorted(is_free, reverse=True)
    assert all(-9.0 <= x <= 9.0 and y == 1.0 for x, y in spots)


def test_there_are_no_spots_in_a_region_that_is_too_small() -> None:
    layout = pickplace.Layout((0, 0, 9, 9), {"A": (2, 3)}, {"red": (4.0, 4.0, 5.9, 9.0)})
    problem = layout.problem("inside(A, red)")
    assert drawn(problem, "spots", ("A", "red"), 5) == []


def test_generators_yield_what_their_functions_hold_of() -> None:
    problem = pickplace.gate()
    functions, cells = problem.world.externals.functions, problem.initial.cells
    spots = [p for (p,) in drawn(problem, "spots", ("A", "red"), 100)]
    assert functions["within"].values(cells, [("A", "red", p) for p in spots]) == [True] * 100
    for p in spots[:20]:
        for g, t in drawn(problem, "ways", ("A", p), 5):
            assert functions["carries"].value(cells, ("A", p, g, t)) is True
        for (g,) in drawn(problem, "grips", ("A", p), 70):
            assert functions["grasps"].value(cells, ("A", p, g)) is True
        for (t,) in drawn(problem, "paths", ("A", (0.0, 0.0), p), 5):
            assert functions["leads"].value(cells, ("A", (0.0, 0.0), p, t)) is True
            assert functions["hits"].value(cells, ("T", (7.0, 4.0), "A", t)) is True


def test_paths_lead_past_high_blocks_if_they_can() -> None:
    layout = pickplace.Layout(
        table=(0.0, 0.0, 12.0, 9.0),
        blocks={"A": (1.0, 4.5), "T": (6.0, 4.5)},
        regions={"red": (10.0, 3.5, 12.0, 5.5)},
        sizes={"T": (2.0, 2.0, 4.0)},
    )
    problem = layout.problem("inside(A, red)")
    around, through = drawn(problem, "paths", ("A", (0.0, 0.0), (11.0, 4.5)), 5)
    assert len(around[0]) > 2
    assert through[0] == ((1.0, 4.5), (11.0, 4.5))
    bench = checked(problem, planned(problem), "A")
    assert bench.carried == ["A"]


# ---------------------------------------------------------------------------------------- pictures


def test_a_picture_shows_what_was_carried(tmp_path: Any) -> None:
    problem = pickplace.gate()
    plan = planned(problem)
    with Image.open(pickplace.picture(problem, plan, tmp_path / "gate.png")) as image:
        single = pickplace.drawn(pickplace.Scene.of(problem.initial))
        assert image.size == (2 * single.width, 2 * single.height)
    with Image.open(pickplace.picture(problem, plan, tmp_path / "gate.gif")) as image:
        assert image.n_frames > len(plan.steps)
    assert sorted(f.name for f in tmp_path.iterdir()) == ["gate.gif", "gate.png"]


def test_blocks_walls_and_regions_are_where_they_are() -> None:
    problem = pickplace.gate()
    scene = pickplace.Scene.of(problem.initial)
    image = pickplace.drawn(scene)

    def at(x: float, y: float) -> tuple[int, ...]:
        margin, size = render.MARGIN, render.SIZE
        pixel = image.getpixel((int((x + margin) * size), int((8.0 + margin - y) * size)))
        assert isinstance(pixel, tuple)
        return pixel

    for block, place in scene.positions.items():
        assert at(*place) == ImageColor.getrgb(render.colour(scene, block))
    assert at(7.0, 1.0) == ImageColor.getrgb(render.WALL)
    assert at(10.0, 2.0) == ImageColor.getrgb(render.REGIONS[0])
    assert at(4.0, 2.0) == ImageColor.getrgb(render.TABLE)


def test_a_picture_that_cannot_be_written_leaves_nothing(tmp_path: Any) -> None:
    problem = pickplace.tight()
    with pytest.raises(ValueError, match="unknown file extension"):
        pickplace.picture(problem, planned(problem), tmp_path / "x.nothing")
    assert list(tmp_path.iterdir()) == []


def test_scenes_go_where_the_plan_s_states_are() -> None:
    problem = pickplace.crowded(3)
    plan = planned(problem)
    *_, end = pickplace.scenes(pickplace.Scene.of(problem.initial), plan.steps)
    assert end == pickplace.Scene.of(plan.states(problem)[-1])


def test_the_module_plans_and_draws(tmp_path: Any, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "tight.png"
    assert main(["tight", "--blocks", "3", "-o", str(file)]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 12
    assert file.exists()
    with pytest.raises(SystemExit):
        main(["gate", "--blocks", "3"])
    assert main(["crowded", "--time-limit", "0"]) == 3
