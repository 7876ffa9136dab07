"""Pictures of a table from above: PNG with a panel for each carried block, or an animated GIF."""

from collections.abc import Sequence
from os import PathLike
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

import crow

from ..pictures import save, tiled
from .problems import Box
from .scenes import Scene, scenes
from .world import Point

SIZE = 24
"""Pixels a unit of length."""
FINE = 3
"""Drawn so many times larger, and made smaller then, so that slanting lines are smooth."""
MARGIN = 0.5
"""Around the table, in units of length."""

PAPER, TABLE, WALL, INK = "#ffffff", "#f1ede4", "#3d4451", "#20242c"
REGIONS = ("#f4c7c3", "#c9ddf0", "#cfe8d5", "#f3e3b3")
BLOCKS = ("#edae49", "#66a1d2", "#9b7ede", "#6bbfa3", "#d98cb3", "#b5a27c", "#8fb339")


class Canvas:
    """A drawing of one scene; lengths are those of the table."""

    def __init__(self, scene: Scene, size: int = SIZE) -> None:
        left, top, right, bottom = scene.areas["table"]
        self.scale = size * FINE
        self.origin = left - MARGIN, bottom + MARGIN
        width, height = right - left + 2 * MARGIN, bottom - top + 2 * MARGIN
        self.image = Image.new(
            "RGB", (round(width * self.scale), round(height * self.scale)), PAPER
        )
        self.pen = ImageDraw.Draw(self.image)

    def at(self, point: Point) -> Point:
        """The pixel of a point; y goes up."""
        return (point[0] - self.origin[0]) * self.scale, (self.origin[1] - point[1]) * self.scale

    def box(self, of: Box, fill: str | None, line: str | None = None, width: float = 0.06) -> None:
        """Draw a box."""
        (left, bottom), (right, top) = self.at(of[:2]), self.at(of[2:])
        self.pen.rectangle((left, top, right, bottom), fill, line, round(width * self.scale))

    def line(self, points: Sequence[Point], colour: str, width: float = 0.08) -> None:
        """Draw a way."""
        pixels = [self.at(point) for point in points]
        self.pen.line(pixels, colour, max(1, round(width * self.scale)), joint="curve")

    def circle(self, point: Point, radius: float, fill: str | None, line: str) -> None:
        """Draw a circle."""
        width = round(0.08 * self.scale)
        self.pen.circle(self.at(point), radius * self.scale, fill, line, width)

    def text(self, point: Point, text: str, height: float = 0.8) -> None:
        """Write in the middle of a point."""
        font = ImageFont.load_default(height * self.scale)
        self.pen.text(self.at(point), text, INK, font, anchor="mm")

    def done(self) -> Image.Image:
        """The drawing in its size."""
        width, height = self.image.size
        return self.image.resize((width // FINE, height // FINE), Image.Resampling.LANCZOS)


def drawn(scene: Scene, way: Sequence[Point] = (), size: int = SIZE) -> Image.Image:
    """A scene, and the way that a block has come."""
    canvas = Canvas(scene, size)
    canvas.box(scene.areas["table"], TABLE)
    regions = [name for name in scene.areas if name != "table"]
    for name, colour in zip(regions, REGIONS, strict=False):
        canvas.box(scene.areas[name], colour)
    canvas.box(scene.areas["table"], None, WALL)
    for wall in scene.walls.values():
        canvas.box(wall, WALL)
    for block in sorted(scene.positions, key=lambda name: name in scene.held):
        _block(canvas, scene, block)
    if way:
        canvas.line(way, INK)
    canvas.circle(scene.gripper, 0.3, INK if scene.held else None, INK)
    return canvas.done()


def colour(scene: Scene, block: str) -> str:
    """The colour of a block."""
    return BLOCKS[list(scene.positions).index(block) % len(BLOCKS)]


def _block(canvas: Canvas, scene: Scene, block: str) -> None:
    (x, y), (width, depth, _) = scene.positions[block], scene.sizes[block]
    own = (x - width / 2, y - depth / 2, x + width / 2, y + depth / 2)
    canvas.box(own, colour(scene, block), INK, 0.12 if block in scene.held else 0.06)
    canvas.text((x - width / 2 + 0.5, y + depth / 2 - 0.5), block)


# ------------------------------------------------------------------------------------------- files


def picture(problem: crow.Problem, result: crow.Plan, file: str | PathLike[str]) -> Path:
    """Draw a plan: `.gif` moves, any other is a strip with a panel for each carried block.

    Returns the file. Raises OSError, and ValueError for a format that Pillow does not know.
    """
    path, start = Path(file), Scene.of(problem.initial)
    if path.suffix == ".gif":
        save(path, [drawn(scene) for scene in scenes(start, result.steps)], milliseconds=60)
    else:
        save(path, [strip(start, result)])
    return path


def strip(start: Scene, result: crow.Plan, *, size: int = SIZE) -> Image.Image:
    """The start, and each block where it was carried with the way that it has come.

    Panels are in a column for a table that is wide, else two of them side by side.
    """
    panels, scene = [drawn(start, size=size)], start
    for step in result.steps:
        *_, scene = scene.after(step)
        if step.controller == "carry":
            panels.append(drawn(scene, step.arguments[1], size))
    width, height = panels[0].size
    return tiled(panels, across=1 if width > 4 * height else 2)
