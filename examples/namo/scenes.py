"""How things stand, and how controllers move them, cell by cell: for robots and pictures."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import crow

from ..pictures import Call
from . import world
from .world import Cell


class CollisionError(Exception):
    """What cannot move as it was told to."""


@dataclass(frozen=True)
class Scene:
    """A map with where the agent and the obstacles are, and which of these are attached to it."""

    rows: tuple[str, ...]
    agent: Cell
    positions: Mapping[str, Cell]
    held: frozenset[str] = frozenset()

    @staticmethod
    def of(state: crow.State) -> "Scene":
        """The scene of a state."""
        cells = state.cells
        return Scene(
            cells["grid", ()],  # type: ignore[arg-type]
            cells["agent_position", ()],  # type: ignore[arg-type]
            {c[1][0]: v for c, v in cells.items() if c[0] == "position"},  # type: ignore[misc]
            frozenset(c[1][0] for c, v in cells.items() if c[0] == "attached" and v),
        )

    def observed(self) -> dict[tuple[str, tuple[str, ...]], object]:
        """The values of the program's features here."""
        return {
            ("grid", ()): self.rows,
            ("agent_position", ()): self.agent,
            **{("position", (o,)): cell for o, cell in self.positions.items()},
            **{("attached", (o,)): True for o in self.held},
        }

    def cells(self, obstacle: str) -> list[Cell]:
        """The cells of an obstacle."""
        shape = world.map_of(self.rows).shapes[obstacle]
        return world.moved(shape, self.positions[obstacle])

    def marked(self, mark: str) -> Cell:
        """The cell of a mark on the map, such as `G`."""
        row = next(number for number, text in enumerate(self.rows) if mark in text)
        return row, self.rows[row].index(mark)

    def is_possible(self) -> bool:
        """Whether everything is in a cell of its own, and nothing in a wall."""
        taken = [self.agent, *(cell for o in self.positions for cell in self.cells(o))]
        space = world.map_of(self.rows).open
        return len(set(taken)) == len(taken) and all(world.is_in(cell, space) for cell in taken)

    def put(self, obstacle: str, cell: Cell) -> "Scene":
        """The scene with an obstacle somewhere else."""
        return replace(self, positions={**self.positions, obstacle: cell})

    def moved(self, way: Cell) -> "Scene":
        """The scene with the agent, and what is attached to it, so many rows and columns further.

        Raises CollisionError.
        """
        (agent,) = world.moved([self.agent], way)
        held = {o: world.moved([self.positions[o]], way)[0] for o in self.held}
        new = replace(self, agent=agent, positions={**self.positions, **held})
        if not new.is_possible():
            raise CollisionError(f"something is in the way of {agent}")
        return new

    def after(self, controller: str | None, arguments: tuple[Any, ...]) -> Iterator["Scene"]:
        """What a controller makes of the scene, each scene on the way included.

        Raises CollisionError.
        """
        match controller, *arguments:
            case "attach", str(obstacle):
                if not any(world.is_beside(self.agent, cell) for cell in self.cells(obstacle)):
                    raise CollisionError(f"{obstacle} is out of reach of {self.agent}")
                yield replace(self, held=self.held | {obstacle})
            case "detach", str(obstacle):
                yield replace(self, held=self.held - {obstacle})
            case "exec_traj", trajectory:
                if trajectory[0] != self.agent:
                    raise CollisionError(f"the agent is at {self.agent}, not {trajectory[0]}")
                scene = self
                for a, b in pairwise(trajectory):
                    scene = scene.moved(world.minus(b, a))
                    yield scene
            case _:
                raise ValueError(f"no controller {controller} of {len(arguments)} arguments")


def scenes(start: Scene, calls: Iterable[Call]) -> Iterator[Scene]:
    """The scenes of a plan, cell by cell, the first included. Raises CollisionError."""
    yield start
    scene = start
    for call in calls:
        for later in scene.after(call.controller, call.arguments):
            scene = later
            yield scene
