"""What pictures of several examples have in common."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Protocol

from PIL import Image


class Call(Protocol):
    """A step of a plan, or a controller call of an execution."""

    @property
    def controller(self) -> str | None:
        """What is called."""

    @property
    def arguments(self) -> tuple[Any, ...]:
        """What with."""


def tiled(panels: Sequence[Image.Image], across: int, gap: int = 0) -> Image.Image:
    """Panels of one size in rows of some, left to right."""
    width, height = panels[0].size
    rows, columns = -(-len(panels) // across), min(across, len(panels))
    size = columns * (width + gap) - gap, rows * (height + gap) - gap
    whole = Image.new("RGB", size, "white")
    for number, panel in enumerate(panels):
        row, column = divmod(number, across)
        whole.paste(panel, (column * (width + gap), row * (height + gap)))
    return whole


def save(path: Path, images: Sequence[Image.Image], milliseconds: int = 0) -> None:
    """Write a file whole, or not at all; several images as an animation, which waits at its end.

    Raises OSError, and ValueError for a format that Pillow does not know.
    """
    first, *others = images
    new = path.with_name(f".new-{path.name}")
    try:
        if others:
            times = [milliseconds] * len(others) + [max(2_000, 10 * milliseconds)]
            first.save(new, save_all=True, append_images=others, duration=times, loop=0)
        else:
            first.save(new)
        new.replace(path)
    finally:
        new.unlink(missing_ok=True)
