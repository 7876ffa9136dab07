"""Maps of any size: rooms in a row, or along a corridor, with obstacles in the doors and rooms."""

import random
from collections.abc import Iterable, Iterator
from itertools import product
from string import ascii_lowercase

from .world import Cell, moved

SHAPES: tuple[tuple[Cell, ...], ...] = (
    ((0, 0),),
    ((0, 0), (0, 1)),
    ((0, 0), (1, 0)),
    ((0, 0), (0, 1), (1, 0)),
)


def suite(size: int, obstacles: int, seed: int = 0, *, rooms: int = 3) -> str:
    """A map of rooms in a row, `size` cells wide and high, each with a door to the next.

    The way goes from the first to the last. One obstacle stands in each door, and the others
    somewhere in the rooms, but not near a door. Raises ValueError for what does not fit.
    """
    chance = _chance("suite", size, obstacles, seed, rooms)
    plan = _Plan(size, rooms, rows=size + 2)
    doors = [(chance.randint(1, size), columns.stop) for columns in plan.columns[:-1]]
    return plan.furnished(doors, obstacles, chance)


def corridor(size: int, obstacles: int, seed: int = 0, *, rooms: int = 3) -> str:
    """A map as `suite` makes it, but with doors to a corridor of two cells instead."""
    chance = _chance("corridor", size, obstacles, seed, rooms)
    plan = _Plan(size, rooms, rows=size + 5)
    plan.dig(product((size + 2, size + 3), range(1, plan.columns[-1].stop)))
    doors = [(size + 1, chance.choice(columns)) for columns in plan.columns]
    return plan.furnished(doors, obstacles, chance)


def _chance(*of: object) -> random.Random:
    """The same wherever the same is asked for."""
    return random.Random(repr(of))  # noqa: S311 - nobody is to be surprised by it


class _Plan:
    """Walls, from which rooms are dug; `columns` are those of each room."""

    def __init__(self, size: int, rooms: int, rows: int) -> None:
        if size < 1 or rooms < 1:
            raise ValueError("there is at least one room, and one cell in it")
        self.inside = range(1, size + 1)
        starts = range(1, rooms * (size + 1), size + 1)
        self.columns = [range(start, start + size) for start in starts]
        self.rows = [["#"] * (rooms * (size + 1) + 1) for _ in range(rows)]
        for columns in self.columns:
            self.dig(product(self.inside, columns))

    def dig(self, cells: Iterable[Cell]) -> None:
        """Free some cells."""
        for row, column in cells:
            self.rows[row][column] = "."

    def furnished(self, doors: list[Cell], obstacles: int, chance: random.Random) -> str:
        """The map with doors, obstacles in them and in the rooms, and a start and a goal."""
        if not len(doors) <= obstacles <= len(ascii_lowercase):
            raise ValueError(f"there are {len(doors)} to {len(ascii_lowercase)} obstacles")
        names = iter(ascii_lowercase[:obstacles])
        self.dig(doors)
        for door, name in zip(doors, names, strict=False):
            self.rows[door[0]][door[1]] = name
        for mark, columns in (("S", self.columns[0]), ("G", self.columns[-1])):
            row, column = chance.choice(list(self.places([(0, 0)], doors, [columns])))
            self.rows[row][column] = mark
        for name in names:
            self.place(name, doors, chance)
        return "\n".join("".join(row) for row in self.rows) + "\n"

    def place(self, name: str, doors: list[Cell], chance: random.Random) -> None:
        """Put an obstacle of a random shape, or the next one that fits, into a random place."""
        for shape in chance.sample(SHAPES, len(SHAPES)):
            places = list(self.places(shape, doors, self.columns))
            if places:
                for row, column in moved(shape, chance.choice(places)):
                    self.rows[row][column] = name
                return
        raise ValueError(f"there is no place for the obstacle `{name}`")

    def places(
        self, shape: Iterable[Cell], doors: list[Cell], rooms: list[range]
    ) -> Iterator[Cell]:
        """Where a shape fits into the rooms, two cells or more from every door."""
        for place in product(self.inside, (column for room in rooms for column in room)):
            cells = moved(shape, place)
            if all(self.rows[r][c] == "." and self.is_apart((r, c), doors) for r, c in cells):
                yield place

    def is_apart(self, cell: Cell, doors: list[Cell]) -> bool:
        """Whether a cell is more than two rows or columns from every door."""
        return all(max(abs(cell[0] - r), abs(cell[1] - c)) > 2 for r, c in doors)
