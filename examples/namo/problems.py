"""Maps as text, and the planning problems that they are.

`#` is a wall, `.` is free, `S` where the agent starts, `G` where it should go, and each lower-case
letter a cell of the movable obstacle of that name.
"""

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Literal, get_args

import cdlc
import crow

from . import world

if TYPE_CHECKING:
    from crow import Domain

FOLDER = Path(__file__).parent
MAPS = ("easy", "medium", "hard")
Strategy = Literal["direct", "waypoint", "interleaved"]
STRATEGIES: tuple[Strategy, ...] = get_args(Strategy)


class MapError(ValueError):
    """A text that is no map."""


def problem(of: str, strategy: Strategy = "interleaved", *, name: str = "namo") -> crow.Problem:
    """The problem of a map, which is one of `MAPS` or a text, for one of the programs.

    Raises MapError for what is no map.
    """
    rows = rows_of(of)
    marks = {mark: next(_cells(rows, mark)) for mark in sorted(set("".join(rows)) - set("#."))}
    obstacles = [mark for mark in marks if mark.islower()]
    return crow.Problem(
        _domain(strategy),
        objects=dict.fromkeys(obstacles, "Object"),
        init={
            "grid": rows,
            "agent_position": marks["S"],
            **{("position", (o,)): marks[o] for o in obstacles},
        },
        goal="at(goal)",
        values={"goal": marks["G"]},
        name=of if of in MAPS else name,
    )


def rows_of(of: str) -> tuple[str, ...]:
    """The rows of a map, which is one of `MAPS` or a text. Raises MapError."""
    text = (FOLDER / "maps" / f"{of}.map").read_text("utf-8") if of in MAPS else of
    rows = tuple(text.split())
    if len({len(row) for row in rows}) != 1:
        raise MapError("the rows of a map are equally long")
    if wrong := re.search(r"[^#.SGa-z]", "".join(rows)):
        raise MapError(
            f"`{wrong[0]}` stands for nothing on a map; `#.SG` and lower-case letters do"
        )
    for mark, what in {"S": "start", "G": "goal"}.items():
        if text.count(mark) != 1:
            raise MapError(f"a map has one {what}, `{mark}`, not {text.count(mark)}")
    return rows


def _cells(rows: tuple[str, ...], mark: str) -> Iterator[world.Cell]:
    for number, row in enumerate(rows):
        yield from ((number, match.start()) for match in re.finditer(mark, row))


@cache
def _domain(strategy: Strategy) -> "Domain":
    return cdlc.load(FOLDER / f"{strategy}.cdl", functions=world)
