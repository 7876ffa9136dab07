"""The projected state at each item of a trace, as what changed since the one before."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from crow.evaluate import execute, shown_cell
from crow.problem import Cell, Problem, State, World
from crow.trace import EffItem, Trace
from crow.values import default_value, shown

MOST_CELLS = 20_000
"""More cells that never change are left out of a page."""

Change = tuple[int, str, str]
"""The number of a cell, and its values before and after; `False` and `unset` are not listed."""


@dataclass(frozen=True, slots=True)
class States:
    """Cells by number, their values at first, and what each item of the trace changes.

    `left_out` counts the cells that are not shown, none of which changes.
    """

    cells: tuple[str, ...]
    initial: tuple[tuple[int, str], ...]
    changes: tuple[tuple[Change, ...], ...]
    left_out: int

    def json(self) -> dict[str, Any]:
        """The states as JSON."""
        return {
            "cells": self.cells,
            "initial": self.initial,
            "changes": self.changes,
            "leftOut": self.left_out,
        }


def states_of(problem: Problem, trace: Trace) -> States:
    """The states that a sound trace goes through from the initial state."""
    world, state = problem.world, problem.initial
    steps = []
    for item in trace:
        after = state
        if isinstance(item, EffItem):
            after = execute(world, state, item.statements, item.variables)
        steps.append(_changed(state, after))
        state = after
    changing = {cell for step in steps for cell in step}
    still = [cell for cell in problem.initial.cells if cell not in changing]
    kept = sorted(changing) + still[: max(0, MOST_CELLS - len(changing))]
    number = {cell: index for index, cell in enumerate(kept)}
    return States(
        tuple(map(shown_cell, kept)),
        _initial(world, problem.initial, number),
        tuple(
            tuple((number[cell], *values) for cell, values in sorted(_texts(world, step).items()))
            for step in steps
        ),
        len(changing | set(still)) - len(kept),
    )


def _changed(before: State, after: State) -> dict[Cell, tuple[object, object]]:
    if before is after:
        return {}
    cells = {cell for cell, _ in before.cells.items() ^ after.cells.items()}
    return {cell: (before.cells.get(cell), after.cells.get(cell)) for cell in cells}


def _initial(world: World, state: State, number: Mapping[Cell, int]) -> tuple[tuple[int, str], ...]:
    found = []
    for cell, value in state.cells.items():
        text = _text(world, cell, value)
        if cell in number:
            found.append((number[cell], text))
    return tuple(found)


def _texts(world: World, step: Mapping[Cell, tuple[object, object]]) -> dict[Cell, tuple[str, str]]:
    return {
        cell: (_text(world, cell, before), _text(world, cell, after))
        for cell, (before, after) in step.items()
    }


def _text(world: World, cell: Cell, value: Any) -> str:
    """A value as CDL writes it; None is the default."""
    type_ = world.features[cell[0]].type
    own = default_value(type_) if value is None else value
    return "unset" if own is None else shown(own, type_)
