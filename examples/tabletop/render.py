"""Pictures of the table, rendered by MuJoCo: PNG with a panel after each call, or animated GIF.

Without a display MuJoCo renders by EGL or OSMesa (Debian's libegl1 or libosmesa6), which the
environment variable MUJOCO_GL chooses before MuJoCo is imported: `egl` or `osmesa`.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from os import PathLike
from pathlib import Path

import mujoco
from PIL import Image

import crow

from ..pictures import save, tiled
from .robot import Robot
from .world import Simulation

FRAMES = 12
"""A second, in animations."""


class Camera:
    """Takes pictures of a robot at work: `panels` after each call, and `frames` all the time."""

    def __init__(self, robot: Robot, width: int, height: int) -> None:
        self._simulation = robot.simulation
        self._renderer = mujoco.Renderer(robot.simulation.model, height, width)
        self._due = robot.simulation.data.time
        self.frames: list[Image.Image] = []
        self.panels = [self.shot()]

    def shot(self) -> Image.Image:
        """A picture of how things stand."""
        self._renderer.update_scene(self._simulation.data, camera="front")
        return Image.fromarray(self._renderer.render())

    def film(self, simulation: Simulation) -> None:
        """Take a frame if it is time for one."""
        if simulation.data.time >= self._due:
            self._due += 1 / FRAMES
            self.frames.append(self.shot())

    def after_call(self) -> None:
        """Take a panel."""
        self.panels.append(self.shot())

    def close(self) -> None:
        """Give back what the renderer has."""
        self._renderer.close()


@contextmanager
def camera(
    robot: Robot, *, films: bool = True, size: tuple[int, int] = (480, 360)
) -> Iterator[Camera]:
    """A camera on a robot while it works; `films` is for frames, not only panels.

    Raises what the library raises that renders, where there is none that works.
    """
    own = Camera(robot, *size)
    robot.watch = own.after_call
    if films:
        robot.simulation.tell = own.film
    try:
        yield own
    finally:
        robot.watch, robot.simulation.tell = (lambda: None), (lambda _: None)
        own.close()


def write(own: Camera, file: str | PathLike[str]) -> Path:
    """Write what a camera has taken: the frames as `.gif`, the panels to any other.

    Returns the file. Raises OSError, and ValueError for a format that Pillow does not know.
    """
    path = Path(file)
    if path.suffix == ".gif":
        save(path, own.frames, milliseconds=1_000 // FRAMES)
    else:
        save(path, [tiled(own.panels, across=3)])
    return path


def picture(problem: crow.Problem, result: crow.Plan, file: str | PathLike[str]) -> Path:
    """Carry a plan out and draw that, as `write` does."""
    robot, path = Robot(problem), Path(file)
    with camera(robot, films=path.suffix == ".gif") as own:
        for step in result.steps:
            robot.act(str(step.controller), step.arguments)
    return write(own, path)
