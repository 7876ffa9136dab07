"""Plans among movable obstacles carried out cell by cell, from a map and controller calls alone."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

Cell = tuple[int, int]
SIDES = ((0, 1), (1, 0), (0, -1), (-1, 0))


class CrashError(AssertionError):
    """What cannot be done, and why."""


@dataclass
class Simulation:
    """The agent, obstacles by their letters, and what is attached to the agent."""

    walls: frozenset[Cell]
    agent: Cell
    goal: Cell
    obstacles: dict[str, frozenset[Cell]]
    held: set[str] = field(default_factory=set)

    @staticmethod
    def of(text: str) -> "Simulation":
        """The simulation that a map shows."""
        seen: dict[str, set[Cell]] = {}
        for row, line in enumerate(text.split()):
            for column, letter in enumerate(line):
                seen.setdefault(letter, set()).add((row, column))
        rows, columns = len(text.split()), len(text.split()[0])
        around = {(r, c) for r in (-1, rows) for c in range(-1, columns + 1)}
        around |= {(r, c) for r in range(rows) for c in (-1, columns)}
        letters = sorted(letter for letter in seen if letter.islower())
        return Simulation(
            frozenset(seen.get("#", set()) | around),
            *seen["S"],
            *seen["G"],
            {letter: frozenset(seen[letter]) for letter in letters},
        )

    def step(self, controller: str, arguments: Sequence[Any]) -> None:
        """One call. Raises CrashError where it cannot be carried out."""
        match controller, *arguments:
            case "attach", name:
                self.attach(name)
            case "detach", name:
                if name not in self.held:
                    raise CrashError(f"{name} is not attached")
                self.held.remove(name)
            case "exec_traj", cells:
                self.follow([(row, column) for row, column in cells])
            case _:
                raise CrashError(f"nobody knows {controller}{tuple(arguments)}")

    def attach(self, name: str) -> None:
        row, column = self.agent
        if self.held:
            raise CrashError(f"{self.held} is attached, so {name} cannot be")
        if not any((row + r, column + c) in self.obstacles[name] for r, c in SIDES):
            raise CrashError(f"{name} at {sorted(self.obstacles[name])} is not beside {self.agent}")
        self.held.add(name)

    def follow(self, cells: list[Cell]) -> None:
        if cells[0] != self.agent:
            raise CrashError(f"the agent is at {self.agent}, and cannot set out from {cells[0]}")
        for row, column in cells[1:]:
            way = (row - self.agent[0], column - self.agent[1])
            if way not in SIDES:
                raise CrashError(f"from {self.agent} to {(row, column)} is no step")
            self.agent = (row, column)
            for name in self.held:
                self.obstacles[name] = frozenset(
                    (r + way[0], c + way[1]) for r, c in self.obstacles[name]
                )
            self.check()

    def check(self) -> None:
        """Nothing is where something else is."""
        taken = dict.fromkeys(self.walls, "a wall")
        for name, cells in [("the agent", [self.agent]), *self.obstacles.items()]:
            for cell in cells:
                if cell in taken:
                    raise CrashError(f"{name} ran into {taken[cell]} at {cell}")
                taken[cell] = name


def arrives(text: str, steps: Iterable[tuple[str, Sequence[Any]]]) -> Simulation:
    """The end of a plan that takes the agent to its goal. Raises CrashError where it does not."""
    simulation = Simulation.of(text)
    for controller, arguments in steps:
        simulation.step(controller, arguments)
    if simulation.agent != simulation.goal or simulation.held:
        raise CrashError(f"ended at {simulation.agent} with {simulation.held}")
    return simulation
