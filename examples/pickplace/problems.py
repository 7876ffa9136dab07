"""Problems of picking and placing, of any size: blocks, walls and regions on a table from above."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import cdlc
import crow

from . import world

if TYPE_CHECKING:
    from crow import Domain

FOLDER = Path(__file__).parent
Box = tuple[float, float, float, float]
Size = tuple[float, float, float]
CUBE: Size = (2.0, 2.0, 2.0)
LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"


@dataclass(frozen=True)
class Layout:
    """What is on a table: blocks by name with where their middles are, regions, and walls."""

    table: Box
    blocks: Mapping[str, world.Point]
    regions: Mapping[str, Box]
    walls: Mapping[str, Box] = field(default_factory=dict)
    sizes: Mapping[str, Size] = field(default_factory=dict)
    """Of blocks that are no cubes."""
    gripper: world.Point = (0.0, 0.0)
    reach: Box | None = None
    """Where the gripper can go; over all of the table unless it is said."""

    def problem(self, goal: str, name: str = "pickplace") -> crow.Problem:
        """The problem of a goal, such as `inside(A, red)`. Raises crow.ProblemError."""
        kinds = {"Block": self.blocks, "Region": self.regions, "Wall": self.walls}
        return crow.Problem(
            _domain(),
            objects={own: kind for kind, names in kinds.items() for own in names},
            init={
                "area(table)": self.table,
                **{("area", (r,)): box for r, box in self.regions.items()},
                **{("wall", (w,)): box for w, box in self.walls.items()},
                **{("size", (b,)): self.sizes.get(b, CUBE) for b in self.blocks},
                **{("position", (b,)): place for b, place in self.blocks.items()},
                "reach": self.reach or self.table,
                "lift": 3.0,
                "gripper": self.gripper,
                "empty": True,
            },
            goal=goal,
            name=name,
        )


def tight(count: int = 2, *, room: float = 1.0) -> crow.Problem:
    """Blocks on a line, and a region at its end with little more room than they take."""
    blocks = {LETTERS[i]: (0.0 - 3.0 * i, 1.0) for i in range(count)}
    end = 5.0 + 2.0 * count + room
    table = (-3.0 * count - 4.0, 0.0, end, 2.0)
    return _line(table, (5.0, 0.0, end, 2.0), blocks).problem(_all_in(blocks), "tight")


def blocked(count: int = 3) -> crow.Problem:
    """Blocks on a line, and one of them in the middle of the region where the first should be."""
    spread = {LETTERS[i]: (3.0 * i - 15.0, 1.0) for i in range(2, count)}
    blocks = {"A": (0.0, 1.0), "B": (7.5, 1.0), **spread}
    layout = _line((-10.0, 0.0, 10.0, 2.0), (5.0, 0.0, 10.0, 2.0), blocks)
    return layout.problem(_all_in("A"), "blocked")


def crowded(count: int = 4, *, room: float = 0.25) -> crow.Problem:
    """Blocks that fill a region, one of which is in the middle of it already."""
    others = {LETTERS[i]: (3.0 * i, 1.5) for i in range(1, count)}
    across = -(-count // 2)
    width, depth = 2.0 * across + room, 4.0 + room
    red = (-3.0 - width, 4.0, -3.0, 4.0 + depth)
    middle = ((red[0] + red[2]) / 2, (red[1] + red[3]) / 2)
    table = (red[0], 0.0, max(3.0 * count, 6.0), red[3])
    layout = Layout(table, {"A": middle, **others}, {"red": red}, gripper=(-5.0, 1.0))
    return layout.problem(_all_in(["A", *others]), "crowded")


def gate() -> crow.Problem:
    """A block that is too high to be carried over stands in the only gap of a wall."""
    layout = Layout(
        table=(0.0, 0.0, 14.0, 8.0),
        blocks={"A": (2.0, 4.0), "T": (7.0, 4.0), "B": (12.0, 4.0)},
        regions={"red": (9.0, 1.0, 14.0, 7.0)},
        walls={"south": (6.5, 0.0, 7.5, 2.75), "north": (6.5, 5.25, 7.5, 8.0)},
        sizes={"T": (2.0, 2.0, 4.0)},
        gripper=(1.0, 1.0),
        reach=(1.0, 1.0, 13.0, 7.0),
    )
    return layout.problem("inside(A, red)", "gate")


def _line(table: Box, red: Box, blocks: Mapping[str, world.Point]) -> Layout:
    return Layout(table, blocks, {"red": red}, gripper=(-5.0, 1.0))


def _all_in(blocks: Sequence[str] | Mapping[str, object]) -> str:

    return " and ".join(f"inside({b}, red)" for b in blocks)


@cache
def _domain() -> "Domain":
    return cdlc.load(FOLDER / "pickplace.cdl", functions=world)
