"""Whether the NAMO strategies solve a map: every path, waypoint, order and placement tried.

What the three programs of `examples/namo` say, written down a second time and without planning:
only states in which the agent stands where it set out are told apart.
"""

from collections.abc import Iterator
from functools import cache
from itertools import chain, product

Cell = tuple[int, int]
Cells = frozenset[Cell]
Obstacles = tuple[Cells, ...]
SIDES = ((0, 1), (1, 0), (0, -1), (-1, 0))


def beside(cells: Cells) -> Cells:
    return frozenset((r + i, c + j) for r, c in cells for i, j in SIDES)


def flooded(start: Cell, free: Cells) -> Cells:
    """The cells that can be reached from one, itself included."""
    found, border = {start}, {start}
    while border:
        border = (beside(frozenset(border)) & free) - found
        found |= border
    return frozenset(found)


def shifted(cells: Cells, by: Cell) -> Cells:
    return frozenset((r + by[0], c + by[1]) for r, c in cells)


class Maze:
    """The open cells of a map; moves and paths in it, each found once."""

    def __init__(self, text: str) -> None:
        seen: dict[str, set[Cell]] = {}
        for row, line in enumerate(text.split()):
            for column, letter in enumerate(line):
                seen.setdefault(letter, set()).add((row, column))
        (self.start,), (self.goal,) = seen["S"], seen["G"]
        self.open = frozenset(c for letter, own in seen.items() if letter != "#" for c in own)
        self.obstacles = tuple(frozenset(seen[x]) for x in sorted(seen) if x.islower())
        self.moves = cache(self._moves)
        self.trails = cache(self._trails)
        self.cleared = cache(self._cleared)

    def paths(self, a: Cell, b: Cell) -> Iterator[Cells]:
        """The cells of each simple path from one cell to another, the shortest first."""
        for length in range(len(self.open)):
            yield from self._extended([a], b, length)

    def _extended(self, path: list[Cell], b: Cell, more: int) -> Iterator[Cells]:
        row, column = path[-1]
        if more == 0:
            if path[-1] == b:
                yield frozenset(path)
        elif abs(row - b[0]) + abs(column - b[1]) <= more:
            for cell in ((row + i, column + j) for i, j in SIDES):
                if cell in self.open and cell not in path:
                    yield from self._extended([*path, cell], b, more - 1)

    def _trails(self, a: Cell, b: Cell) -> tuple[Cells, ...]:
        """The different sets of cells of the simple paths."""
        return tuple(dict.fromkeys(self.paths(a, b)))

    def _moves(self, obstacles: Obstacles, at: Cell, number: int) -> frozenset[Obstacles]:
        """Where things can be when one obstacle was moved, the agent being back again."""
        taken = frozenset[Cell]().union(*obstacles)
        others = taken - obstacles[number]
        own = obstacles[number]
        # One that is close already does not go anywhere else.
        close = beside(own) & flooded(at, self.open - taken)
        ends = set()
        for stand in [at] if at in beside(own) else close:
            body = own | {stand}
            room = self.open - others
            ways = frozenset(
                (r - stand[0], c - stand[1])
                for r, c in self.open
                if shifted(body, (r - stand[0], c - stand[1])) <= room
            )
            for way in flooded((0, 0), ways):
                put = shifted(own, way)
                (here,) = shifted(frozenset([stand]), way)
                if at in flooded(here, self.open - others - put):
                    ends.add((*obstacles[:number], put, *obstacles[number + 1 :]))
        return frozenset(ends)

    def _cleared(self, obstacles: Obstacles, at: Cell, path: Cells) -> frozenset[Obstacles]:
        """Where things can be when each obstacle on a path was moved off it, in any order."""
        if not any(own & path for own in obstacles):
            return frozenset([obstacles])
        found = set[Obstacles]()
        for number, own in enumerate(obstacles):
            if own & path:
                for end in self.moves(obstacles, at, number):
                    if not end[number] & path:
                        found |= self.cleared(end, at, path)
        return frozenset(found)

    # ---------------------------------------------------------------------------------- strategies

    def waypoints(self) -> list[Cell]:
        taken = frozenset[Cell]().union(*self.obstacles)
        return sorted(self.open - flooded(self.start, self.open - taken))

    def direct(self) -> bool:
        paths = self.paths(self.start, self.goal)
        return any(self.cleared(self.obstacles, self.start, path) for path in paths)

    def by_waypoint(self) -> bool:
        return self.direct() or any(map(self._through, self.waypoints()))

    def _through(self, x: Cell) -> bool:
        reached = set[Obstacles]()
        for path in self.trails(self.start, x):
            for end in self.cleared(self.obstacles, self.start, path) - reached:
                reached.add(end)
                if any(self.cleared(end, x, onward) for onward in self.trails(x, self.goal)):
                    return True
        return False

    def interleaved(self) -> bool:
        nothing = frozenset[Cell]()
        whole = ((self.goal, path, nothing) for path in self.paths(self.start, self.goal))
        parts = (
            (x, first, second)
            for x in self.waypoints()
            for first in self.trails(self.start, x)
            for second in self.trails(x, self.goal)
        )
        return any(self._ordered(*segments) for segments in chain(whole, parts))

    def _ordered(self, x: Cell, first: Cells, second: Cells) -> bool:
        """Whether two segments are cleared and followed, each obstacle moved once for each.

        One that is not in the way may be moved, too.
        """
        every = frozenset(product(range(len(self.obstacles)), (0, 1) if second else (0,)))
        pending = [(self.obstacles, every, self.start, False)]
        seen = set()
        while pending:
            node = pending.pop()
            if node in seen:
                continue
            seen.add(node)
            obstacles, left, at, is_second = node
            if is_second and not any(own & second for own in obstacles):
                return True
            if not is_second and not any(own & first for own in obstacles):
                rest = frozenset(one for one in left if one[1] == 1)
                pending.append((obstacles, rest, x, True))
            for number, segment in left:
                path = (first, second)[segment]
                rest = left - {(number, segment)}
                ends = self.moves(obstacles, at, number)
                pending += [(end, rest, at, is_second) for end in ends if not end[number] & path]
        return False
