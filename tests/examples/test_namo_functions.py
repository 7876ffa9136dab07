"""The functions and generators of NAMO: each against a second reading of App. C, on random maps."""

from collections.abc import Iterator
from itertools import pairwise, product
from typing import TypeVar

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from namo_enumeration import SIDES, Cells, Maze, beside, flooded, shifted

from crow.problem import Problem
from crow.views import StateView
from examples import namo
from examples.namo import world

Cell = tuple[int, int]
T = TypeVar("T")


@st.composite
def maps(draw: st.DrawFn, longest: int = 6) -> str:
    """Maps without walls around them, so that ends of the map matter, too."""
    rows, columns = draw(st.integers(2, 5)), draw(st.integers(2, longest))
    letters = st.sampled_from("....##abc")
    cells = draw(st.lists(letters, min_size=rows * columns, max_size=rows * columns))
    for mark in "SG":
        free = [number for number, letter in enumerate(cells) if letter == "."]
        assume(free)
        cells[draw(st.sampled_from(free))] = mark
    text = "".join(cells)
    return "\n".join(text[r * columns : (r + 1) * columns] for r in range(rows))


def random(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def view(problem: Problem, **changes: object) -> StateView:
    """The initial state of a problem as Python functions see it, with some cells changed."""
    cells = {**problem.initial.cells}
    for name, value in changes.items():
        feature, *objects = name.split("__")
        cells[feature, tuple(objects)] = value
    return StateView(problem.world, cells, frozenset(problem.world.features), "a test")


class Setting:
    """A map twice: as the example's functions see it, and as sets of cells."""

    def __init__(self, text: str) -> None:
        self.maze = Maze(text)
        self.problem = namo.problem(text)
        self.names = [o for o in self.problem.world.objects if o.islower()]
        self.state = view(self.problem)
        self.obstacles = dict(zip(self.names, self.maze.obstacles, strict=True))
        self.free = self.maze.open - frozenset[Cell]().union(*self.maze.obstacles)
        self.reach = flooded(self.maze.start, self.free)
        rows = text.split()
        # A cell beyond each end of the map belongs to what is asked about.
        self.around = list(product(range(-1, len(rows) + 1), range(-1, len(rows[0]) + 1)))

    def first(self, name: str) -> Cell:
        return min(self.obstacles[name])

    def way(self, free: Cells, start: Cell, end: Cell) -> int | None:
        """The length of the shortest way, in cells."""
        reached, length = frozenset([start] if start in free else []), 1
        while reached and end not in reached:
            grown = reached | (beside(reached) & free)
            if grown == reached:
                return None
            reached, length = grown, length + 1
        return length if reached else None


def is_way(t: tuple[Cell, ...], free: Cells) -> bool:
    steps = {(b[0] - a[0], b[1] - a[1]) for a, b in pairwise(t)}
    return set(t) <= free and steps <= set(SIDES)


def yielded(values: Iterator[tuple[T]]) -> Iterator[T]:
    """What a generator of one output yields."""
    return (value for (value,) in values)


def yielded_once(cells: Iterator[tuple[Cell]]) -> set[Cell]:
    found = list(yielded(cells))
    assert len(found) == len(set(found))
    return set(found)


# --------------------------------------------------------------------------------- single cells


@given(maps())
def test_waypoints_are_where_the_agent_cannot_go(text: str) -> None:
    setting = Setting(text)
    expected = setting.maze.open - setting.reach
    assert yielded_once(world.waypoints(setting.state, rng=random())) == expected
    valid = {x for x in setting.around if world.valid_waypoint(setting.state, x)}
    assert valid == expected


@given(maps())
def test_places_beside_an_obstacle_are_those_in_reach(text: str) -> None:
    setting = Setting(text)
    for name, cells in setting.obstacles.items():
        expected = beside(cells) & setting.reach
        assert yielded_once(world.places_beside(setting.state, name, rng=random())) == expected
        close = {x for x in setting.around if world.close_to_object(setting.state, name, x)}
        assert close == expected
        is_close = setting.maze.start in beside(cells)
        assert world.close_to(setting.state, name) == is_close
        assert is_close == (setting.maze.start in expected)


@given(maps(), st.randoms(use_true_random=False))
def test_places_for_an_obstacle_are_those_it_could_go_to(text: str, chance: object) -> None:
    setting = Setting(text)
    t = next(
        yielded(world.paths(setting.state, setting.maze.start, setting.maze.goal, rng=random())),
        None,
    )
    assume(t is not None)
    for name, cells in setting.obstacles.items():
        space = setting.free | cells
        first = setting.first(name)
        ways = {
            (r - first[0], c - first[1])
            for r, c in setting.around
            if shifted(cells, (r - first[0], c - first[1])) <= space
        }
        reached = flooded((0, 0), frozenset(ways))
        expected = {
            (first[0] + r, first[1] + c) for r, c in reached if not shifted(cells, (r, c)) & set(t)
        }
        assert yielded_once(world.places_for(setting.state, name, t, rng=random())) == expected
        free = {p for p in setting.around if world.free_location(setting.state, name, t, p)}
        assert free == expected


@given(maps())
def test_blocking_is_to_share_a_cell(text: str) -> None:
    setting = Setting(text)
    paths = yielded(world.paths(setting.state, setting.maze.start, setting.maze.goal, rng=random()))
    for t, _ in zip(paths, range(20), strict=False):
        for name, cells in setting.obstacles.items():
            assert world.blocking(setting.state, name, t) == bool(cells & set(t))


# --------------------------------------------------------------------------------- trajectories


@given(maps(longest=4), st.integers(0, 3))
def test_paths_are_all_simple_paths_the_shortest_first(text: str, seed: int) -> None:
    setting = Setting(text)
    start, goal = setting.maze.start, setting.maze.goal
    found = list(yielded(world.paths(setting.state, start, goal, rng=random(seed))))
    assert all(world.connect(setting.state, start, goal, t) for t in found)
    assert all(is_way(t, setting.maze.open) and len(set(t)) == len(t) for t in found)
    assert [len(t) for t in found] == sorted(len(t) for t in found)
    assert len(found) == len(set(found)) == sum(1 for _ in setting.maze.paths(start, goal))


def test_which_path_comes_first_is_left_to_chance_and_only_that() -> None:
    setting = Setting("S...\n....\n....\n...G")
    ends = setting.maze.start, setting.maze.goal

    def found(seed: int) -> list[tuple[Cell, ...]]:
        return list(yielded(world.paths(setting.state, *ends, rng=random(seed))))

    assert found(1) == found(1)
    assert found(1) != found(2)
    assert set(found(1)) == set(found(2))
    assert len({found(seed)[0] for seed in range(40)}) > 10  # of 20
    assert start_and_end(found(1)[-1]) == ends


def start_and_end(t: tuple[Cell, ...]) -> tuple[Cell, Cell]:
    return world.start_of(t), world.end_of(t)


def test_a_path_to_where_one_is_stays_there() -> None:
    setting = Setting("S.\n.G")
    assert list(yielded(world.paths(setting.state, (0, 0), (0, 0), rng=random()))) == [((0, 0),)]
    assert list(yielded(world.paths(setting.state, (0, 0), (0, 9), rng=random()))) == []
    assert list(yielded(world.paths(setting.state, (-1, 0), (0, 0), rng=random()))) == []


@pytest.mark.parametrize(
    "t",
    [
        (),
        ((0, 0),),
        ((0, 0), (0, 2)),
        ((0, 0), (0, 1), (0, 0), (0, 1), (0, 2)),
        ((0, 0), (1, 0), (1, 1), (1, 2), (0, 2)),
        ((0, 0), (-1, 0), (-1, 1), (-1, 2), (0, 2)),
        ((0, 1), (0, 2)),
    ],
)
def test_what_is_no_path_does_not_connect(t: tuple[Cell, ...]) -> None:
    setting = Setting("S.G\n###")
    assert not world.connect(setting.state, (0, 0), (0, 2), t)
    assert not world.collision_free_connect(setting.state, (0, 0), (0, 2), t) or len(set(t)) < len(
        t
    )


@given(maps())
def test_ways_are_shortest_and_free(text: str) -> None:
    setting = Setting(text)
    start = setting.maze.start
    for end in setting.around:
        length = setting.way(setting.free, start, end)
        found = list(yielded(world.ways(setting.state, start, end)))
        assert [len(t) for t in found] == ([] if length is None else [length])
        for t in found:
            assert start_and_end(t) == (start, end)
            assert is_way(t, setting.free)
            assert world.collision_free_connect(setting.state, start, end, t)


@given(maps())
def test_other_ways_pass_where_they_are_free(text: str) -> None:
    setting = Setting(text)
    start, goal = setting.maze.start, setting.maze.goal
    paths = yielded(world.paths(setting.state, start, goal, rng=random()))
    for t, _ in zip(paths, range(20), strict=False):
        is_free = world.collision_free_connect(setting.state, start, goal, t)
        assert is_free == (not any(set(t) & cells for cells in setting.obstacles.values()))


@given(maps(), st.data())
def test_ways_with_an_obstacle_move_both_as_one_body(text: str, data: st.DataObject) -> None:
    setting = Setting(text)
    close = [o for o, cells in setting.obstacles.items() if setting.maze.start in beside(cells)]
    assume(close)
    name = data.draw(st.sampled_from(close))
    state = view(setting.problem, **{f"attached__{name}": True})
    start, first, cells = setting.maze.start, setting.first(name), setting.obstacles[name]
    space = setting.free | cells
    fits = frozenset(
        (start[0] + r, start[1] + c)
        for r, c in product(range(-6, 7), repeat=2)
        if shifted(cells | {start}, (r, c)) <= space
    )
    for end in setting.around:
        agent = (start[0] + end[0] - first[0], start[1] + end[1] - first[1])
        length = setting.way(fits, start, agent)
        found = list(yielded(world.ways_with_object(state, first, end)))
        assert [len(t) for t in found] == ([] if length is None else [length])
        for t in found:
            assert start_and_end(t) == (start, agent)
            assert is_way(t, fits)
            assert world.collision_free_connect_with_object(state, first, end, t)
            assert not world.collision_free_connect_with_object(setting.state, first, end, t)


def test_nothing_moves_with_an_agent_that_holds_nothing() -> None:
    setting = Setting("Sa.\n..G")
    assert list(yielded(world.ways_with_object(setting.state, (0, 1), (0, 2)))) == []
    held = view(setting.problem, attached__a=True)
    assert list(yielded(world.ways_with_object(held, (0, 0), (0, 2)))) == []  # `a` is not there
    assert list(yielded(world.ways_with_object(held, (0, 1), (0, 2)))) == [((0, 0), (0, 1))]


# ----------------------------------------------------------------------------------------- maps


def test_shapes_are_read_from_the_map_and_positions_from_the_state() -> None:
    problem = namo.problem("S.a.\n.aa.\n...G")
    assert problem.initial.cells["position", ("a",)] == (0, 2)
    state = view(problem, position__a=(1, 3))
    assert sorted(world.obstacle(state, "a")) == [(1, 3), (2, 2), (2, 3)]


def test_an_obstacle_that_the_map_lacks_is_an_error_that_says_so() -> None:
    state = view(namo.problem("Sa.\n..G"), grid=("S..", "..G"))
    with pytest.raises(ValueError, match="no obstacle `a`"):
        world.blocking(state, "a", ((0, 0),))
    with pytest.raises(ValueError, match="equally long"):
        world.blocking(view(namo.problem("Sa.\n..G"), grid=("Sa", "..G")), "a", ((0, 0),))
