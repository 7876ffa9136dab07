"""Pictures of scenes: PNG, animated GIF, a page of HTML, and the terminal.

Pillow draws; rich writes to the terminal.
"""

import json
from collections.abc import Iterable, Sequence
from itertools import pairwise
from os import PathLike
from pathlib import Path
from time import sleep
from typing import TYPE_CHECKING

from PIL import Image, ImageDraw, ImageFont

import crow

from ..pictures import save, tiled
from .scenes import Scene, scenes
from .world import Cell

if TYPE_CHECKING:
    from rich.text import Text

SIZE = 32
"""Pixels a cell."""

WALL, FLOOR, LINE, GOAL, AGENT, WAY, INK = (
    "#3d4451", "#f7f5f0", "#e6e2d8", "#3a9d5d", "#d1495b", "#d1495b", "#20242c",
)  # fmt: skip
OBSTACLES = ("#edae49", "#66a1d2", "#9b7ede", "#6bbfa3", "#d98cb3", "#b5a27c", "#8fb339")


def colour(obstacle: str) -> str:
    """The colour of an obstacle."""
    return OBSTACLES[(ord(obstacle) - ord("a")) % len(OBSTACLES)]


# ---------------------------------------------------------------------------------------- drawing


def drawn(scene: Scene, way: Sequence[Cell] = (), size: int = SIZE) -> Image.Image:
    """A scene, and the way that the agent has come or will go."""
    image = Image.new("RGB", (len(scene.rows[0]) * size, len(scene.rows) * size), FLOOR)
    pen = ImageDraw.Draw(image)
    for row, text in enumerate(scene.rows):
        for column, mark in enumerate(text):
            fill = WALL if mark == "#" else FLOOR
            pen.rectangle(_box((row, column), size), fill, fill if mark == "#" else LINE)
    pen.ellipse(_box(scene.marked("G"), size, 0.2), outline=GOAL, width=max(2, size // 8))
    for obstacle in scene.positions:
        _obstacle(pen, scene, obstacle, size)
    for a, b in pairwise(way):
        pen.line([_centre(a, size), _centre(b, size)], WAY, max(1, size // 10))
    for obstacle in scene.held:
        near = min(scene.cells(obstacle), key=lambda cell: _distance(cell, scene.agent))
        pen.line([_centre(near, size), _centre(scene.agent, size)], INK, max(2, size // 6))
    pen.ellipse(_box(scene.agent, size, 0.2), AGENT)
    return image


def _obstacle(pen: ImageDraw.ImageDraw, scene: Scene, obstacle: str, size: int) -> None:
    cells = scene.cells(obstacle)
    gap = size * 0.1
    for row, column in cells:
        left, top, right, bottom = _box((row, column), size, 0.1)
        right += 2 * gap * ((row, column + 1) in cells)
        bottom += 2 * gap * ((row + 1, column) in cells)
        pen.rectangle((left, top, right, bottom), colour(obstacle))
    font = ImageFont.load_default(size * 0.45)
    pen.text(_centre(cells[0], size), obstacle, INK, font, anchor="mm")


def _box(cell: Cell, size: int, inset: float = 0.0) -> tuple[float, float, float, float]:
    left, top = cell[1] * size + inset * size, cell[0] * size + inset * size
    side = size - 1 - 2 * inset * size
    return left, top, left + side, top + side


def _centre(cell: Cell, size: int) -> tuple[float, float]:
    return (cell[1] + 0.5) * size, (cell[0] + 0.5) * size


def _distance(a: Cell, b: Cell) -> int:
    return abs(a[0] - b[0]) + abs(a[1] - b[1])


# ------------------------------------------------------------------------------------------- files


def picture(problem: crow.Problem, result: crow.Plan, file: str | PathLike[str]) -> Path:
    """Draw a plan: `.gif` moves, `.html` is a page to step through, any other is a strip.

    A strip has the start, and a panel for each walk; its format is that of the name (PNG, ...).
    Returns the file. Raises OSError, and ValueError for a format that Pillow does not know.
    """
    path = Path(file)
    start = Scene.of(problem.initial)
    if path.suffix == ".gif":
        animation(list(scenes(start, result.steps)), path)
    elif path.suffix == ".html":
        page(list(scenes(start, result.steps)), path)
    else:
        save(path, [strip(start, result)])
    return path


def strip(
    start: Scene, result: crow.Plan, *, across: int = 4, size: int = SIZE // 2
) -> Image.Image:
    """The start, and each walk of a plan with where it ends, in rows of panels."""
    panels, scene = [drawn(start, size=size)], start
    for step in result.steps:
        *_, scene = (scene, *scene.after(step.controller, step.arguments))
        if step.controller == "exec_traj" and len(step.arguments[0]) > 1:
            panels.append(drawn(scene, step.arguments[0], size))
    return tiled(panels, across, gap=size // 2)


def animation(shown: Sequence[Scene], file: Path, *, milliseconds: int = 150) -> None:
    """Write scenes as an animated GIF, which waits at its end. Raises OSError."""
    save(file, [drawn(scene) for scene in shown], milliseconds)


# -------------------------------------------------------------------------------------------- HTML

_PAGE = Path(__file__).with_name("page.html")


def page(shown: Sequence[Scene], file: Path) -> None:
    """Write scenes as a page that needs nothing else, with a slider over time. Raises OSError."""
    first = shown[0]
    frames = [
        {
            "agent": scene.agent,
            "held": sorted(scene.held),
            "obstacles": {o: scene.cells(o) for o in scene.positions},
        }
        for scene in shown
    ]
    data = {
        "rows": first.rows,
        "goal": first.marked("G"),
        "colours": {o: colour(o) for o in first.positions},
        "frames": frames,
    }
    text = _PAGE.read_text("utf-8").replace("/*DATA*/", json.dumps(data))
    new = file.with_name(f".new-{file.name}")
    new.write_text(text, "utf-8")
    new.replace(file)


# ---------------------------------------------------------------------------------------- terminal


def written(scene: Scene) -> "Text":
    """A scene for the terminal: `@` is the agent."""
    from rich.text import Text

    marks = {scene.marked("G"): ("()", GOAL), scene.agent: ("@ ", f"bold {AGENT}")}
    for obstacle in scene.positions:
        style = f"{INK} on {colour(obstacle)}"
        sign = f"{obstacle}{'*' if obstacle in scene.held else ' '}"
        marks |= dict.fromkeys(scene.cells(obstacle), (sign, style))
    text = Text()
    for row, line in enumerate(scene.rows):
        for column, mark in enumerate(line):
            plain = ("██", WALL) if mark == "#" else ("  ", "")
            text.append(*marks.get((row, column), plain))
        text.append("\n")
    return text


def watch(shown: Iterable[Scene], *, seconds: float = 0.1) -> None:
    """Show scenes on the terminal, one after the other in place."""
    from rich.live import Live

    with Live(auto_refresh=False) as live:
        for scene in shown:
            live.update(written(scene), refresh=True)
            sleep(seconds)
