"""A robot among movable obstacles, simulated, for `crow.execute`."""

from collections.abc import Mapping
from typing import Any

import crow

from .scenes import CollisionError, Scene


class Robot:
    """An environment: it carries calls out cell by cell, and stops where something is in the way.

    `seen` has every scene so far.
    """

    def __init__(self, problem: crow.Problem) -> None:
        self.seen = [Scene.of(problem.initial)]

    @property
    def scene(self) -> Scene:
        """How things stand."""
        return self.seen[-1]

    def observe(self) -> Mapping[tuple[str, tuple[str, ...]], object]:
        """The values of the program's features."""
        return self.scene.observed()

    def act(self, controller: str, arguments: tuple[Any, ...]) -> str:
        """Carry a call out: `done`, or `failed` where something is in the way."""
        try:
            self.seen.extend(self.scene.after(controller, arguments))
        except CollisionError:
            return "failed"
        return "done"


class PushedBack(Robot):
    """A robot in a house where somebody puts an obstacle back, once, after it was moved away."""

    def __init__(self, problem: crow.Problem) -> None:
        super().__init__(problem)
        self.pushed: str | None = None

    def act(self, controller: str, arguments: tuple[Any, ...]) -> str:
        """As without the disturbance, which follows when the agent has gone back to its place."""
        outcome = super().act(controller, arguments)
        first, last = self.seen[0], self.scene
        if self.pushed is None and controller == "exec_traj" and not last.held:
            for obstacle, cell in first.positions.items():
                back = last.put(obstacle, cell)
                if back != last and back.is_possible():
                    self.seen.append(back)
                    self.pushed = obstacle
                    break
        return outcome
