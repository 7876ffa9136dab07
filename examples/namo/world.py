"""What the NAMO programs leave to Python: every function and generator of App. C.

A cell is (row, column) from the top left, a trajectory the cells of the agent in order. A map is
text: `#` is a wall, a lower-case letter a cell of the obstacle of that name, which is rigid; its
position is that of its first cell. All that changes is in the state that each function is given.

Generators yield tuples of outputs, of which each has one: each solution once, in random order;
`paths` the shortest first, `ways` and `ways_with_object` one only, as any other leads to the same
state (docs/decisions/0022-namo.md).
"""

from collections.abc import Container, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING

import networkx
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from scipy.sparse import csr_array
from scipy.sparse.csgraph import breadth_first_order

import crow

if TYPE_CHECKING:
    from crow import StateView

Cell = tuple[int, int]
Trajectory = tuple[Cell, ...]
Mask = NDArray[np.bool_]
"""A truth value for each cell of a map."""


# ------------------------------------------------------------------------------------------- cells


def minus(a: Cell, b: Cell) -> Cell:
    """The way from one cell to another, as rows and columns."""
    return a[0] - b[0], a[1] - b[1]


def moved(cells: Iterable[Cell], way: Cell) -> list[Cell]:
    """Cells so many rows and columns further."""
    return [(row + way[0], column + way[1]) for row, column in cells]


def is_beside(a: Cell, b: Cell) -> bool:
    """Whether two cells share a side."""
    return abs(a[0] - b[0]) + abs(a[1] - b[1]) == 1


def is_in(cell: Cell, mask: Mask) -> bool:
    """What a mask says about a cell; False beyond the map."""
    rows, columns = mask.shape
    return 0 <= cell[0] < rows and 0 <= cell[1] < columns and bool(mask[cell])


# --------------------------------------------------------------------------------------------- map


@dataclass(frozen=True)
class Map:
    """A map as text, row by row."""

    rows: tuple[str, ...]

    def __post_init__(self) -> None:
        if len({len(row) for row in self.rows}) != 1:
            raise ValueError("the rows of a map are equally long")

    @cached_property
    def open(self) -> Mask:
        """Where there is no wall."""
        return np.array([[letter != "#" for letter in row] for row in self.rows])

    @cached_property
    def shapes(self) -> dict[str, list[Cell]]:
        """The cells of each obstacle, counted from its first."""
        cells: dict[str, list[Cell]] = {}
        for r, row in enumerate(self.rows):
            for c, letter in enumerate(row):
                if letter.islower():
                    cells.setdefault(letter, []).append((r, c))
        return {name: [minus(cell, own[0]) for cell in own] for name, own in cells.items()}

    @cached_property
    def neighbours(self) -> NDArray[np.int64]:
        """Two rows with all pairs of open cells that share a side, numbered row by row."""
        numbers = np.arange(self.open.size).reshape(self.open.shape)
        across, down = (numbers[:, :-1], numbers[:, 1:]), (numbers[:-1], numbers[1:])
        pairs = np.concatenate(
            [np.stack([a.ravel(), b.ravel()]) for a, b in (across, down)], axis=1
        )
        return pairs[:, self.open.ravel()[pairs].all(axis=0)]

    def has(self, cell: Cell) -> bool:
        """Whether there is such a cell."""
        return 0 <= cell[0] < len(self.rows) and 0 <= cell[1] < len(self.rows[0])

    def number(self, cell: Cell) -> int:
        """The number of a cell, row by row."""
        return cell[0] * len(self.rows[0]) + cell[1]

    def cell(self, number: int) -> Cell:
        """The cell of a number."""
        row, column = divmod(int(number), len(self.rows[0]))
        return row, column

    def without(self, cells: Iterable[Cell]) -> Mask:
        """The open cells without some."""
        free = self.open.copy()
        for cell in cells:
            if self.has(cell):
                free[cell] = False
        return free

    def room_for(self, body: Iterable[Cell], free: Mask) -> Mask:
        """Where a body of cells, counted from (0, 0), fits into the free cells."""
        rows, columns = free.shape
        fits = np.ones_like(free)
        for r, c in body:
            shifted = np.zeros_like(free)
            if abs(r) < rows and abs(c) < columns:
                to = slice(max(0, -r), rows - max(0, r)), slice(max(0, -c), columns - max(0, c))
                of = slice(max(0, r), rows + min(0, r)), slice(max(0, c), columns + min(0, c))
                shifted[to] = free[of]
            fits &= shifted
        return fits

    def reach(self, start: Cell, free: Mask) -> Mask:
        """The free cells that can be reached from one."""
        if not is_in(start, free):
            return np.zeros_like(free)
        labels, _ = ndimage.label(free)
        return np.asarray(labels == labels[start])

    def way(self, start: Cell, end: Cell, free: Mask) -> Trajectory | None:
        """A shortest way through free cells."""
        if not (is_in(start, free) and is_in(end, free)):
            return None
        first, last = self.number(start), self.number(end)
        heads, tails = self.neighbours[:, free.ravel()[self.neighbours].all(axis=0)]
        graph = csr_array((np.ones(len(heads), np.int8), (heads, tails)), (free.size, free.size))
        _, before = breadth_first_order(graph, first, directed=False)
        numbers = [last]
        while numbers[-1] != first:
            previous = before[numbers[-1]]
            if previous < 0:
                return None
            numbers.append(previous)
        return tuple(self.cell(number) for number in reversed(numbers))


@lru_cache(maxsize=256)
def map_of(rows: tuple[str, ...]) -> Map:
    """The map of a text, with what was found out about it before."""
    return Map(rows)


# ------------------------------------------------------------------------------------------- state


def obstacle(state: "StateView", name: str) -> list[Cell]:
    """The cells of an obstacle."""
    shapes = map_of(state.grid()).shapes
    if name not in shapes:
        raise ValueError(f"the map has no obstacle `{name}`")
    return moved(shapes[name], state.position(name))


def free_cells(state: "StateView", besides: Container[str] = ()) -> Mask:
    """The cells without walls and obstacles, besides some that count as free."""
    others = [name for name in state.objects("Object") if name not in besides]
    return map_of(state.grid()).without(cell for o in others for cell in obstacle(state, o))


def in_reach(state: "StateView") -> Mask:
    """The cells that the agent can go to without moving anything."""
    return map_of(state.grid()).reach(state.agent_position(), free_cells(state))


def goes(t: Trajectory, a: Cell, b: Cell, free: Mask) -> bool:
    """Whether a trajectory goes from a cell to another, step by step over free ones."""
    joins = len(t) > 0 and t[0] == a and t[-1] == b
    return joins and all(is_in(c, free) for c in t) and all(is_beside(p, q) for p, q in pairwise(t))


def shuffled(cells: Mask, rng: np.random.Generator) -> Iterator[tuple[Cell]]:
    """The cells that are true, in random order, each as the one output of a generator."""
    for row, column in rng.permutation(np.argwhere(cells)).tolist():
        yield ((row, column),)


# ----------------------------------------------------------------------------------- trajectories


@crow.function
def start_of(t: Trajectory) -> Cell:
    """The first cell of a trajectory."""
    return t[0]


@crow.function
def end_of(t: Trajectory) -> Cell:
    """The last cell of a trajectory."""
    return t[-1]


@crow.function
def connect(state: "StateView", a: Cell, b: Cell, t: Trajectory) -> bool:
    """Whether a trajectory leads past the walls, through each cell once; obstacles may be on it."""
    return len(set(t)) == len(t) and goes(t, a, b, map_of(state.grid()).open)


@crow.generator(complete=True)
def paths(
    state: "StateView", a: Cell, b: Cell, *, rng: np.random.Generator
) -> Iterator[tuple[Trajectory]]:
    """Every simple path, the shortest first; which of equal ones comes first is left to chance."""
    world = map_of(state.grid())
    if not is_in(b, world.reach(a, world.open)):
        return
    graph = networkx.Graph()
    graph.add_node(world.number(a))
    graph.add_edges_from(rng.permuted(rng.permutation(world.neighbours, axis=1), axis=0).T.tolist())
    for path in networkx.shortest_simple_paths(graph, world.number(a), world.number(b)):
        yield (tuple(map(world.cell, path)),)


@crow.function
def blocking(state: "StateView", o: str, t: Trajectory) -> bool:
    """Whether an obstacle is on a trajectory."""
    return any(cell in t for cell in obstacle(state, o))


@crow.function
def collision_free_connect(state: "StateView", a: Cell, b: Cell, t: Trajectory) -> bool:
    """Whether a trajectory leads the agent past walls and obstacles."""
    return goes(t, a, b, free_cells(state))


@crow.generator(complete=True)
def ways(state: "StateView", a: Cell, b: Cell) -> Iterator[tuple[Trajectory]]:
    """A shortest way of the agent past walls and obstacles."""
    way = map_of(state.grid()).way(a, b, free_cells(state))
    if way is not None:
        yield (way,)


# ------------------------------------------------------------------------------- attached obstacles


def attached(state: "StateView") -> list[str]:
    """The obstacles that move with the agent."""
    return [o for o in state.objects("Object") if state.attached(o)]


def room_with_object(state: "StateView") -> Mask:
    """Where the agent can be as one body with what is attached to it."""
    held, agent = attached(state), state.agent_position()
    body = [(0, 0), *(minus(cell, agent) for o in held for cell in obstacle(state, o))]
    return map_of(state.grid()).room_for(body, free_cells(state, held))


@crow.function
def collision_free_connect_with_object(state: "StateView", a: Cell, b: Cell, t: Trajectory) -> bool:
    """Whether the agent's trajectory takes an attached obstacle from a position to another.

    Agent and obstacle are one rigid body, with walls and all other obstacles in its way.
    """
    agent = state.agent_position()
    is_held = any(state.position(o) == a for o in attached(state))
    end = moved([agent], minus(b, a))[0]
    return is_held and goes(t, agent, end, room_with_object(state))


@crow.generator(complete=True)
def ways_with_object(state: "StateView", a: Cell, b: Cell) -> Iterator[tuple[Trajectory]]:
    """A shortest way of the agent that takes an attached obstacle from a position to another."""
    if all(state.position(o) != a for o in attached(state)):
        return
    agent = state.agent_position()
    end = moved([agent], minus(b, a))[0]
    way = map_of(state.grid()).way(agent, end, room_with_object(state))
    if way is not None:
        yield (way,)


# ------------------------------------------------------------------------------------------- places


def good_waypoints(state: "StateView") -> Mask:
    """Where there is no wall, and the agent cannot go without moving something."""
    return map_of(state.grid()).open & ~in_reach(state)


@crow.function
def valid_waypoint(state: "StateView", x: Cell) -> bool:
    """Whether the agent cannot go somewhere without moving something; no wall is there."""
    return is_in(x, good_waypoints(state))


@crow.generator(complete=True)
def waypoints(state: "StateView", *, rng: np.random.Generator) -> Iterator[tuple[Cell]]:
    """All waypoints."""
    yield from shuffled(good_waypoints(state), rng)


@crow.function
def close_to(state: "StateView", o: str) -> bool:
    """Whether the agent is beside an obstacle."""
    return any(is_beside(state.agent_position(), cell) for cell in obstacle(state, o))


def cells_beside(state: "StateView", o: str) -> Mask:
    """The cells beside an obstacle that the agent can go to."""
    world = map_of(state.grid())
    beside = np.zeros_like(world.open)
    for row, column in obstacle(state, o):
        for cell in ((row - 1, column), (row + 1, column), (row, column - 1), (row, column + 1)):
            if world.has(cell):
                beside[cell] = True
    return beside & in_reach(state)


@crow.function
def close_to_object(state: "StateView", o: str, x: Cell) -> bool:
    """Whether a cell is beside an obstacle, and the agent can go there."""
    return is_in(x, cells_beside(state, o))


@crow.generator(complete=True)
def places_beside(state: "StateView", o: str, *, rng: np.random.Generator) -> Iterator[tuple[Cell]]:
    """All cells beside an obstacle that the agent can go to."""
    yield from shuffled(cells_beside(state, o), rng)


def free_places(state: "StateView", o: str, t: Trajectory) -> Mask:
    """Where an obstacle could go if it moved by itself, and is not on a trajectory there."""
    world = map_of(state.grid())
    shape, free = world.shapes[o], free_cells(state, (o,))
    reached = world.reach(state.position(o), world.room_for(shape, free))
    return reached & world.room_for(shape, world.without(t) | ~world.open)


@crow.function
def free_location(state: "StateView", o: str, t: Trajectory, p: Cell) -> bool:
    """Whether an obstacle could go somewhere if it moved by itself, and is off a trajectory there.

    Walls and other obstacles are in its way; whether the agent can move it there is another matter.
    """
    return is_in(p, free_places(state, o, t))


@crow.generator(complete=True)
def places_for(
    state: "StateView", o: str, t: Trajectory, *, rng: np.random.Generator
) -> Iterator[tuple[Cell]]:
    """All places for an obstacle off a trajectory."""
    yield from shuffled(free_places(state, o, t), rng)
