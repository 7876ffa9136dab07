"""Worlds for policies: blocks that are moved by controllers, and what may go wrong with them."""

from pathlib import Path

from programs import problem_of
from support import BLOCKS

from crow.execution import DONE, FAILED
from crow.problem import Cell, Problem

SUSSMAN = """
problem "p"
objects:
  A, B, C: block
init:
  on_table[A] = True
  on_table[B] = True
  on[C, A] = True
  clear[B] = True
  clear[C] = True
  handempty[...] = True
goal: on(A, B) and on(B, C)
"""


def blocks(problem: str = SUSSMAN) -> Problem:
    return problem_of(Path(BLOCKS / "blocks.cdl").read_text(), problem)


def _nothing(table: "Table") -> None:
    """No disturbance."""


class Table:
    """Blocks by what they stand on: another block, None for the table, or `hand`.

    `before` happens to the table before each observation.
    """

    def __init__(self, below: dict[str, str | None]) -> None:
        self.below = dict(below)
        self.acted: list[str] = []
        self.outcomes: list[str] = []
        self.before = _nothing

    def observe(self) -> dict[Cell, object]:
        self.before(self)
        seen: dict[Cell, object] = {("handempty", ()): "hand" not in self.below.values()}
        for block, below in self.below.items():
            if below == "hand":
                seen["holding", (block,)] = True
            elif below is None:
                seen["on_table", (block,)] = True
            else:
                seen["on", (block, below)] = True
            covered = block in self.below.values()
            seen["clear", (block,)] = not covered and below != "hand"
        return seen

    def act(self, controller: str, arguments: tuple[object, ...]) -> str:
        """Do what a gripper can do, and fail where it cannot; `outcomes` may say otherwise."""
        self.acted.append(controller)
        if self.outcomes and self.outcomes.pop(0) == FAILED:
            return FAILED
        x, y = str(arguments[0]), str(arguments[1]) if len(arguments) > 1 else None
        holds, is_clear = "hand" in self.below.values(), x not in self.below.values()
        taking = {"pickup_table": None, "unstack": y}
        if controller in taking:
            if holds or not is_clear or self.below[x] != taking[controller]:
                return FAILED
            self.below[x] = "hand"
            return DONE
        if self.below[x] != "hand" or (y is not None and y in self.below.values()):
            return FAILED
        self.below[x] = y
        return DONE


def table() -> Table:
    """The Sussman anomaly."""
    return Table({"A": None, "B": None, "C": "A"})


WANTED = {"A": "B", "B": "C", "C": None}
