"""Plans of picking and placing carried out with intervals, from what the problem says."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

Point = tuple[float, float]
Interval = tuple[float, float]
ROUNDING = 1e-6


class CrashError(AssertionError):
    """What cannot be done, and why."""


def joint(a: Interval, b: Interval) -> Interval:
    return max(a[0], b[0]), min(a[1], b[1])


def below(start: float, speed: float, bound: float) -> Interval:
    """The times at which start + speed * time is less than a bound."""
    if speed == 0:
        return (float("-inf"), float("inf")) if start < bound else (1.0, 0.0)
    time = (bound - start) / speed
    return (float("-inf"), time) if speed > 0 else (time, float("inf"))


def meeting(start: float, speed: float, half: float, other: Interval) -> Interval:
    """The times at which a moving interval has more than an end in common with another."""
    upper = below(start, speed, other[1] + half - ROUNDING)
    lower = below(-start, -speed, half - other[0] - ROUNDING)
    return joint(upper, lower)


def meets(a: Point, b: Point, size: Sequence[float], box: Sequence[float]) -> bool:
    """Whether a body overlaps a box while its middle goes straight from a to b."""
    times = (0.0, 1.0)
    for axis in (0, 1):
        side = (box[axis], box[axis + 2])
        times = joint(times, meeting(a[axis], b[axis] - a[axis], size[axis] / 2, side))
    return times[0] <= times[1]


def footprint(middle: Point, size: Sequence[float]) -> tuple[float, float, float, float]:
    (x, y), (width, depth, *_) = middle, size
    return x - width / 2, y - depth / 2, x + width / 2, y + depth / 2


def is_within(box: Sequence[float], room: Sequence[float]) -> bool:
    slack = [box[0] - room[0], box[1] - room[1], room[2] - box[2], room[3] - box[3]]
    return min(slack) >= -ROUNDING


@dataclass
class Bench:
    """A table with what is on it; `held` is a block, and the gripper from its middle."""

    areas: dict[str, Any]
    walls: dict[str, Any]
    sizes: dict[str, Any]
    positions: dict[str, Point]
    reach: Sequence[float]
    lift: float
    gripper: Point
    held: tuple[str, Point] | None = None
    carried: list[str] = field(default_factory=list)

    @staticmethod
    def of(cells: Any) -> "Bench":
        """The table that the cells of an initial state describe."""
        found: dict[str, dict[str, Any]] = {}
        for (feature, objects), value in cells.items():
            found.setdefault(feature, {})["".join(objects)] = value
        return Bench(
            found["area"],
            found.get("wall", {}),
            found["size"],
            dict(found["position"]),
            found["reach"][""],
            found["lift"][""],
            found["gripper"][""],
        )

    def step(self, controller: str | None, arguments: Sequence[Any]) -> None:
        """One call. Raises CrashError where it cannot be carried out."""
        match controller, *arguments:
            case "move", place:
                self.need(self.held is None, "moves without a path while it holds something")
                self.go(place)
            case "grip", block, grasp:
                self.grip(block, grasp)
            case "carry", block, path:
                self.carry(block, path)
            case "release", block:
                self.release(block)
            case _:
                raise CrashError(f"nobody knows {controller}{tuple(arguments)}")

    def need(self, holds: bool, said: str) -> None:
        if not holds:
            raise CrashError(f"{said}: {self}")

    def go(self, place: Point) -> None:
        self.need(is_within((*place, *place), self.reach), f"{place} is out of reach")
        self.gripper = place

    def grip(self, block: str, grasp: Point) -> None:
        (x, y), (width, depth, _) = self.positions[block], self.sizes[block]
        self.need(self.held is None, "the gripper is not empty")
        off = abs(self.gripper[0] - x - grasp[0]) + abs(self.gripper[1] - y - grasp[1])
        self.need(off < ROUNDING, f"the gripper is not where {block} is gripped")
        self.need(2 * abs(grasp[0]) <= width and 2 * abs(grasp[1]) <= depth, "it grips air")
        self.held = block, grasp

    def carry(self, block: str, path: Sequence[Point]) -> None:
        self.need(self.held is not None and self.held[0] == block, f"{block} is not held")
        assert self.held is not None
        self.need(path[0] == self.positions[block], "it begins somewhere else")
        size, (x, y) = self.sizes[block], self.held[1]
        high = {o: p for o, p in self.others(block).items() if self.sizes[o][2] > self.lift}
        boxes = [*self.walls.values(), *(footprint(p, self.sizes[o]) for o, p in high.items())]
        for a, b in pairwise(path):
            self.need(
                not any(meets(a, b, size, box) for box in boxes), f"collision from {a} to {b}"
            )
            self.need(is_within(footprint(b, size), self.areas["table"]), f"{b} is off the table")
            self.go((b[0] + x, b[1] + y))
            self.positions[block] = b
        self.carried.append(block)

    def release(self, block: str) -> None:
        self.need(self.held is not None and self.held[0] == block, f"{block} is not held")
        place, size = self.positions[block], self.sizes[block]
        boxes = [*self.walls.values()]
        boxes += [footprint(p, self.sizes[o]) for o, p in self.others(block).items()]
        self.need(
            not any(meets(place, place, size, box) for box in boxes), f"{block} is in another"
        )
        self.held = None

    def others(self, block: str) -> dict[str, Point]:
        return {o: place for o, place in self.positions.items() if o != block}

    def is_inside(self, block: str, region: str) -> bool:
        own = footprint(self.positions[block], self.sizes[block])
        return self.held is None and is_within(own, self.areas[region])


def carried_out(
    cells: Any, steps: Iterable[tuple[str | None, Sequence[Any]]], goal: Iterable[str] = ()
) -> Bench:
    """The end of a plan that takes some blocks into `red`. Raises CrashError where it does not."""
    bench = Bench.of(cells)
    for controller, arguments in steps:
        bench.step(controller, arguments)
    for block in goal:
        bench.need(bench.is_inside(block, "red"), f"{block} is not inside")
    return bench
