"""How things stand on a table, and how the controllers move them: for pictures."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil, dist
from typing import Any

import crow

from ..pictures import Call
from .problems import Box, Size
from .world import Point


@dataclass(frozen=True)
class Scene:
    """A table from above; `held` are the blocks in the gripper."""

    areas: Mapping[str, Box]
    walls: Mapping[str, Box]
    sizes: Mapping[str, Size]
    positions: Mapping[str, Point]
    gripper: Point
    held: frozenset[str] = frozenset()

    @staticmethod
    def of(state: crow.State) -> "Scene":
        """The scene of a state."""

        def values(feature: str) -> dict[str, Any]:
            return {c[0]: value for (name, c), value in state.cells.items() if name == feature}

        gripper: Any = state.cells["gripper", ()]
        return Scene(
            areas=values("area"),
            walls=values("wall"),
            sizes=values("size"),
            positions=values("position"),
            gripper=gripper,
            held=frozenset(values("held")),
        )

    def after(self, call: Call, step: float = 0.5) -> Iterator["Scene"]:
        """The scenes of a controller call, the last of which it ends with; moves step by step."""
        match call.controller, *call.arguments:
            case "grip", block, _:
                yield replace(self, held=self.held | {block})
            case "release", block:
                yield replace(self, held=self.held - {block})
            case "move", place:
                for point in _walked((self.gripper, place), step):
                    yield replace(self, gripper=point)
            case "carry", block, path:
                grasp = _minus(self.gripper, self.positions[block])
                for point in _walked(path, step):
                    gripper = (point[0] + grasp[0], point[1] + grasp[1])
                    yield replace(self, gripper=gripper, positions={**self.positions, block: point})
            case _:
                raise ValueError(f"no controller {call.controller}{call.arguments}")


def scenes(start: Scene, calls: Iterable[Call], step: float = 0.5) -> Iterator[Scene]:
    """The scenes of a plan, the first included."""
    yield start
    scene = start
    for call in calls:
        for later in scene.after(call, step):
            scene = later
            yield scene


def _minus(a: Point, b: Point) -> Point:
    return a[0] - b[0], a[1] - b[1]


def _walked(path: Iterable[Point], step: float) -> Iterator[Point]:
    """Points along a path, not farther from each other than a step; its corners are among them."""
    for a, b in pairwise(path):
        count = max(1, ceil(dist(a, b) / step))
        for number in range(1, count):
            part = number / count
            yield a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])
        yield b
