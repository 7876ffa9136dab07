"""A robot at the table, simulated on and on, for `crow.execute`."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import crow

from .world import Body, Setting, Simulation


class Robot:
    """An environment: it carries calls out in a simulation of its own, and sees where blocks are.

    `nudges` says what somebody does meanwhile: after so many calls, a block is pushed along x and
    y, in metres a second; at 1.0 it slides on for some 8 cm. `watch` is called after each call.
    """

    def __init__(
        self, problem: crow.Problem, nudges: Mapping[int, tuple[str, float, float]] | None = None
    ) -> None:
        cells: Mapping[Any, Any] = problem.initial.cells
        self.fixed = {cell: value for cell, value in cells.items() if cell[0] != "pose"}
        self.nudges = nudges or {}
        self.calls = 0
        self.watch: Callable[[], None] = lambda: None
        blocks = [name for name in problem.world.objects if ("pose", (name,)) in cells]
        bodies = [Body(b, cells["size", (b,)], cells["mass", (b,)]) for b in blocks]
        marked = [v for (name, r), v in cells.items() if name == "area" and r != ("table",)]
        self.simulation = Simulation(Setting(tuple(bodies), tuple(marked)))
        self.simulation.reset({b: cells["pose", (b,)] for b in blocks})
        self.simulation.settle()

    def observe(self) -> Mapping[tuple[str, tuple[str, ...]], object]:
        """Where the blocks are, with what does not change."""
        poses = self.simulation.poses()
        return {**self.fixed, **{("pose", (b,)): pose for b, pose in poses.items()}}

    def act(self, controller: str, arguments: Sequence[Any]) -> str:
        """Carry a call out; what has become of it is for `observe`."""
        match controller, *arguments:
            case "transfer", block, pose:
                self.simulation.transfer(block, pose)
            case "push", _, stroke:
                self.simulation.push(stroke)
            case _:
                raise ValueError(f"no controller `{controller}` of {len(arguments)} arguments")
        self.calls += 1
        if self.calls in self.nudges:
            self.nudge(*self.nudges[self.calls])
        self.watch()
        return "done"

    def nudge(self, block: str, x: float, y: float) -> None:
        """Give a block a push of its own."""
        joint = self.simulation.model.joint(block).dofadr[0]
        self.simulation.data.qvel[joint : joint + 2] = x, y
        self.simulation.settle()
