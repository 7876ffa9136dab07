"""Problems on the table, stated in Python."""

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import cdlc
import crow

from . import world
from .world import Body, Box, Pose

if TYPE_CHECKING:
    from crow import Domain

FOLDER = Path(__file__).parent
UPRIGHT = (1.0, 0.0, 0.0, 0.0)
CUBE = (0.06, 0.06, 0.06)
TABLE: Box = (-0.43, -0.28, 0.43, 0.28)


def problem(
    blocks: Mapping[Body, tuple[float, float]],
    regions: Mapping[str, Box],
    goal: str,
    name: str = "tabletop",
) -> crow.Problem:
    """The problem of blocks that stand on the table, each with where its middle is.

    Raises crow.ProblemError for a goal that is none.
    """
    poses: dict[str, Pose] = {b.name: (*at, b.size[2] / 2, *UPRIGHT) for b, at in blocks.items()}
    return crow.Problem(
        _domain(),
        objects={**{b.name: "Block" for b in blocks}, **dict.fromkeys(regions, "Region")},
        init={
            "area(table)": TABLE,
            **{("area", (r,)): box for r, box in regions.items()},
            **{("size", (b.name,)): b.size for b in blocks},
            **{("mass", (b.name,)): b.mass for b in blocks},
            **{("pose", (b,)): pose for b, pose in poses.items()},
            "payload": 1.0,
        },
        goal=goal,
        name=name,
    )


def tidy() -> crow.Problem:
    """A crate that is too heavy to be lifted, and two cubes that should be stacked on it."""
    blocks = {
        Body("red", CUBE, 0.1): (-0.3, -0.15),
        Body("green", CUBE, 0.1): (-0.3, 0.0),
        Body("blue", CUBE, 0.1): (0.14, 0.1),
        Body("crate", (0.14, 0.14, 0.05), 2.0): (0.12, -0.1),
    }
    goal = "inside(crate, dock) and on(red, crate) and on(green, red)"
    return problem(blocks, {"dock": (0.02, 0.04, 0.22, 0.24)}, goal, "tidy")


@cache
def _domain() -> "Domain":
    return cdlc.load(FOLDER / "tabletop.cdl", functions=world)
