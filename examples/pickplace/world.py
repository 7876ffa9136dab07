"""What the pick-and-place program leaves to Python: geometry, and the values to choose among.

All of it is read from the state, seen from above. A held block is lifted: walls, and blocks that
are too high, are in its way, while the empty gripper passes over everything.
"""

from collections.abc import Iterator, Sequence
from itertools import chain, combinations, islice
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

import crow

if TYPE_CHECKING:
    from crow import StateView

Point = tuple[float, float]
Path = tuple[Point, ...]
Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Objects = NDArray[np.object_]

TOUCH = 1e-9
"""Less than this is no overlap, and no distance: poses are sums, and sums are rounded."""

RANDOM = 64
"""So many random candidates at a time."""
ON_TOP = 0.8
"""The part of a block's top, along each side, in which it can be gripped."""

GRASPS = 8
"""So many grasps are tried for a path."""


# ------------------------------------------------------------------------------------------- boxes

# Rows are x and y from, x and y to. What touches does not overlap.


def boxes(of: Sequence[Any], width: int = 4) -> Floats:
    """Rows of numbers as an array, which has its columns also without a row."""
    return np.asarray(of, dtype=float).reshape(-1, width)


def around(middles: Floats, size: Floats) -> Floats:
    """The boxes of some size around their middles."""
    half = np.asarray(size)[..., :2] / 2
    return np.concatenate([middles - half, middles + half], axis=-1)


def grown(of: Floats, size: Floats) -> Floats:
    """Where the middle of a body of some size is while it overlaps boxes, or would leave them."""
    half = np.asarray(size)[..., :2] / 2
    return np.concatenate([of[..., :2] - half, of[..., 2:] + half], axis=-1)


def shrunk(of: Floats, size: Floats) -> Floats:
    """Where the middle of a body of some size is while it is within boxes."""
    return grown(of, -np.asarray(size))


def contain(of: Floats, points: Floats) -> Flags:
    """Whether points are in boxes, borders included: row by row, or with one box for all."""
    inside = (of[..., :2] - TOUCH <= points) & (points <= of[..., 2:] + TOUCH)
    return np.asarray(inside.all(axis=-1))


def has_inside(of: Floats, points: Floats) -> Flags:
    """Whether points are in boxes, borders excluded, as `contain` says it with them."""
    inside = (of[..., :2] + TOUCH < points) & (points < of[..., 2:] - TOUCH)
    return np.asarray(inside.all(axis=-1))


def touched_by(points: Floats, obstacles: Floats) -> NDArray[np.int64]:
    """For each point, how many obstacles it is in, borders excluded."""
    return np.asarray(has_inside(obstacles, points[:, None, :]).sum(axis=-1))


def crossed(a: Floats, b: Floats, obstacles: Floats) -> Flags:
    """Which obstacles the straight lines from points to others go through: a row for each line.

    A line is within a box from the time it has come past the nearer side on each axis until it
    has come past the farther one on either.
    """
    start, way = np.atleast_2d(a)[:, None, :], np.atleast_2d(b - a)[:, None, :]
    low, high = obstacles[:, :2] + TOUCH, obstacles[:, 2:] - TOUCH
    moves = np.abs(way) > TOUCH
    along = np.where(moves, way, 1.0)
    times = np.stack([(low - start) / along, (high - start) / along])
    between = (low < start) & (start < high)
    enters = np.where(moves, times.min(axis=0), np.where(between, -np.inf, np.inf))
    leaves = np.where(moves, times.max(axis=0), np.where(between, np.inf, -np.inf))
    first, last = enters.max(axis=-1), leaves.min(axis=-1)
    return np.asarray(np.maximum(first, 0.0) < np.minimum(last, 1.0))


def corners(room: Floats, obstacles: Floats) -> Floats:
    """The points of a room that are on a side of it, or of an obstacle, along each axis.

    Rows are ordered by y, then by x.
    """
    return _crossings(np.concatenate([room[None], obstacles]), room).reshape(-1, 2)


def _crossings(of: Floats, room: Floats) -> Floats:
    """Where lines along the sides of boxes cross within a room: by row, column and axis."""
    lines = []
    for axis in (0, 1):
        sides = of[:, axis::2].ravel()
        inside = (room[axis] - TOUCH <= sides) & (sides <= room[axis + 2] + TOUCH)
        lines.append(np.unique(sides[inside]))
    return np.stack(np.meshgrid(*lines), axis=-1)


def uniform(room: Floats, count: int, rng: np.random.Generator) -> Floats:
    """Random points of a box."""
    return rng.uniform(room[:2], np.maximum(room[:2], room[2:]), (count, 2))


# ------------------------------------------------------------------------------------------- ways


def way(start: Floats, end: Floats, room: Floats, obstacles: Floats) -> Floats | None:
    """A short way for a point within a room past obstacles, by its corners; None if there is none.

    There is none unless there is one along the lines on which sides of obstacles, `start` and `end`
    lie: any way can be pushed onto them.
    """
    ends = np.stack([start, end])
    if not contain(room, ends).all() or touched_by(ends, obstacles).any():
        return None
    if not crossed(start, end, obstacles).any():
        return ends
    points, graph = _lines(ends, room, obstacles)
    first, last = (int(np.linalg.norm(points - p, axis=-1).argmin()) for p in ends)
    distances, before = dijkstra(graph, directed=False, indices=first, return_predecessors=True)
    if not np.isfinite(distances[last]):
        return None
    numbers = [last]
    while numbers[-1] != first:
        numbers.append(int(before[numbers[-1]]))
    return _straightened(np.stack([start, *points[numbers[-2:0:-1]], end]), obstacles)


def _lines(ends: Floats, room: Floats, obstacles: Floats) -> tuple[Floats, csr_array]:
    """Where the lines of a room cross, and how far one of two neighbours is along a free line."""
    grid = _crossings(np.concatenate([np.tile(ends, 2), obstacles]), room)
    numbers = np.arange(grid[..., 0].size).reshape(grid.shape[:2])
    across, down = (numbers[:, :-1], numbers[:, 1:]), (numbers[:-1], numbers[1:])
    a, b = np.concatenate([np.stack([p.ravel(), q.ravel()]) for p, q in (across, down)], axis=1)
    points = grid.reshape(-1, 2)
    is_free = touched_by((points[a] + points[b]) / 2, obstacles) == 0
    a, b = a[is_free], b[is_free]
    lengths = np.linalg.norm(points[a] - points[b], axis=-1)
    return points, csr_array((lengths, (a, b)), (len(points), len(points)))


def _straightened(path: Floats, obstacles: Floats) -> Floats:
    """A way with as few of its corners as are needed, the farthest taken that can be seen."""
    taken = [0]
    while taken[-1] + 1 < len(path):
        here = taken[-1]
        ahead = path[here + 1 :]
        is_clear = np.array(~crossed(path[here], ahead, obstacles).any(axis=-1))
        is_clear[0] = True  # a piece of a line
        taken.append(here + 1 + int(np.flatnonzero(is_clear)[-1]))
    return path[taken]


# ------------------------------------------------------------------------------------------- state


def standing(state: "StateView", besides: str) -> list[str]:
    """The blocks on the table without one."""
    return [b for b in state.objects("Block") if b != besides and not state.held(b)]


def places(state: "StateView", blocks: list[str]) -> Floats:
    """The boxes of blocks."""
    size = boxes([state.size(b) for b in blocks], 3)
    return around(boxes([state.position(b) for b in blocks], 2), size)


def walls(state: "StateView") -> Floats:
    """The boxes of all walls."""
    return boxes([state.wall(w) for w in state.objects("Wall")])


# ------------------------------------------------------------------------------------------ places


def alike(*columns: Objects) -> Iterator[tuple[tuple[Any, ...], list[int]]]:
    """The different rows of columns, and the numbers of those that are the same: most often all."""
    found: dict[tuple[Any, ...], list[int]] = {}
    for number, row in enumerate(zip(*columns, strict=True)):
        found.setdefault(row, []).append(number)
    yield from found.items()


@crow.function(vectorized=True)
def within(state: "StateView", b: Objects, r: Objects, p: Floats) -> Flags:
    """Whether blocks lie wholly within regions, and in no wall."""
    found = np.empty(len(p), bool)
    for (block, region), rows in alike(b, r):
        size, room = np.asarray(state.size(block)), np.asarray(state.area(region))
        is_walled = touched_by(p[rows], grown(walls(state), size)) > 0
        found[rows] = contain(shrunk(room, size), p[rows]) & ~is_walled
    return found


@crow.function(vectorized=True)
def is_free(state: "StateView", b: Objects, p: Floats) -> Flags:
    """Whether blocks would stand in no other."""
    found = np.empty(len(p), bool)
    for (block,), rows in alike(b):
        others = grown(places(state, standing(state, block)), np.asarray(state.size(block)))
        found[rows] = touched_by(p[rows], others) == 0
    return found


@crow.function(vectorized=True)
def reachable(state: "StateView", b: Objects, p: Floats) -> Flags:
    """Whether there is a grasp by which the gripper reaches blocks."""
    found = np.empty(len(p), bool)
    for (block,), rows in alike(b):
        room = grown(np.asarray(state.reach()), ON_TOP * np.asarray(state.size(block)))
        found[rows] = contain(room, p[rows])
    return found


@crow.generator(batch=True)
def spots(state: "StateView", b: str, r: str, *, rng: np.random.Generator) -> Iterator[Floats]:
    """Places for a block in a region, those first that the fewest other blocks are in.

    They are beside sides of the region, of walls and other blocks, and then random ones for ever.
    """
    size, room = np.asarray(state.size(b)), np.asarray(state.area(r))
    others, fixed = (grown(o, size) for o in (places(state, standing(state, b)), walls(state)))
    inner = shrunk(room, size)
    if (inner[:2] > inner[2:] + TOUCH).any():
        return
    found = corners(inner, np.concatenate([others, fixed]))
    while True:
        found = found[touched_by(found, fixed) == 0]
        yield found[np.argsort(touched_by(found, others), kind="stable")]
        found = uniform(inner, RANDOM, rng)


# ------------------------------------------------------------------------------------------ grasps


def grasps_for(state: "StateView", b: str, p: Point) -> Floats:
    """The box of grasps by which the gripper reaches a block where it is, and in another place."""
    half = ON_TOP * np.asarray(state.size(b)[:2]) / 2
    box, reach = np.concatenate([-half, half]), np.asarray(state.reach())
    for pose in (state.position(b), p):
        own = reach - np.tile(pose, 2)
        box = np.concatenate([np.maximum(box[:2], own[:2]), np.minimum(box[2:], own[2:])])
    return box


@crow.function
def grasps(state: "StateView", b: str, p: Point, g: Point) -> bool:
    """Whether a grasp is on top of a block, and reaches it where it is and in another place."""
    return bool(contain(grasps_for(state, b, p), np.asarray(g)))


@crow.generator(batch=True)
def grips(state: "StateView", b: str, p: Point, *, rng: np.random.Generator) -> Iterator[Floats]:
    """Grasps of a block for a place: the one closest to its middle first."""
    box = grasps_for(state, b, p)
    if (box[:2] > box[2:]).any():
        return
    yield np.clip(0.0, box[:2], box[2:])[None]
    while True:
        yield uniform(box, RANDOM, rng)


# ------------------------------------------------------------------------------------------- paths


@crow.function
def start_of(t: Path) -> Point:
    """Where a path begins."""
    return t[0]


@crow.function
def end_of(t: Path) -> Point:
    """Where a path ends."""
    return t[-1]


def room_for(state: "StateView", b: str, g: Point) -> Floats:
    """Where the middle of a block can be that is held by a grasp."""
    table = shrunk(np.asarray(state.area("table")), np.asarray(state.size(b)))
    reach = np.asarray(state.reach()) - np.tile(g, 2)
    return np.concatenate([np.maximum(table[:2], reach[:2]), np.minimum(table[2:], reach[2:])])


@crow.function
def leads(state: "StateView", b: str, g: Point, p: Point, t: Path) -> bool:
    """Whether a path takes a held block from where it is to a place, past the walls.

    It stays on the table, and the gripper within its reach; blocks may be in its way.
    """
    points = boxes(t, 2)
    obstacles = grown(walls(state), np.asarray(state.size(b)))
    fits = len(t) > 1 and t[0] == state.position(b) and t[-1] == p
    return (
        fits
        and bool(contain(room_for(state, b, g), points).all())
        and not crossed(points[:-1], points[1:], obstacles).any()
    )


@crow.generator
def paths(state: "StateView", b: str, g: Point, p: Point) -> Iterator[tuple[Path]]:
    """Short paths past the walls: past all high blocks first, then past fewer and fewer of them."""
    size, room = np.asarray(state.size(b)), room_for(state, b, g)
    others = [o for o in standing(state, b) if state.size(o)[2] > state.lift()]
    fixed = walls(state)
    known = set()
    for count in range(len(others), -1, -1):
        for passed in combinations(others, count):
            obstacles = grown(np.concatenate([places(state, list(passed)), fixed]), size)
            found = way(np.asarray(state.position(b)), np.asarray(p), room, obstacles)
            path = () if found is None else tuple(map(tuple, found.tolist()))
            if path and path not in known:
                known.add(path)
                yield (path,)


@crow.function
def carries(state: "StateView", b: str, p: Point, g: Point, t: Path) -> bool:
    """Whether a grasp and a path take a block from where it stands to a place."""
    return grasps(state, b, p, g) and leads(state, b, g, p, t)


@crow.generator
def ways(
    state: "StateView", b: str, p: Point, *, rng: np.random.Generator
) -> Iterator[tuple[Point, Path]]:
    """Different paths, each with a grasp: the one closest to the block's middle, if it does."""
    known = set()
    table = shrunk(np.asarray(state.area("table")), np.asarray(state.size(b)))
    for g in islice(chain.from_iterable(grips(state, b, p, rng=rng)), GRASPS):
        for (path,) in paths(state, b, g, p):
            if path not in known:
                known.add(path)
                yield tuple(g.tolist()), path
        if (room_for(state, b, g) == table).all():
            return  # with any other grasp there is no more room


@crow.function(vectorized=True)
def hits(state: "StateView", o: Objects, p: Floats, b: Objects, t: Objects) -> Flags:
    """Whether blocks in some places are in the way of others along their paths.

    They are where these end, and all along if they are too high to be passed over.
    """
    found = np.empty(len(p), bool)
    for (other, block, path), rows in alike(o, b, t):
        size, way = np.asarray(state.size(other)), boxes(path, 2)
        obstacles = grown(around(p[rows], size), np.asarray(state.size(block)))
        found[rows] = has_inside(obstacles, way[-1])
        if size[2] > state.lift():
            found[rows] |= crossed(way[:-1], way[1:], obstacles).any(axis=0)
    return found
