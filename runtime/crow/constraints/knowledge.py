"""What all stores of one world share: its Python, and what was found out about its states."""

from collections import ChainMap
from collections.abc import Iterator, Mapping
from functools import cache, cached_property
from typing import Any

from crow.calls import FixedCells
from crow.conditions import unfold
from crow.constraints.python import Cells, Python
from crow.problem import Cell, World
from crow.program import Apply, Compare, Expression, Not, Read, Variable
from crow.unknowns import Unknown, has_unknown, resolved, unknowns_in
from crow.values import Value

_MOST_STATES = 10_000


class Knowledge:
    """A world with its Python; remembers states, and derived functions as expressions."""

    def __init__(self, world: World, python: Python | None = None) -> None:
        self.world = world
        self.python: Any = world.externals if python is None else python
        self.body = cache(self._body)
        self._states: dict[int, tuple[Cells, tuple[tuple[Cell, Value], ...]]] = {}
        self._resolved: dict[tuple[int, tuple[Value, ...]], tuple[Cells, Cells]] = {}

    @cached_property
    def goals(self) -> frozenset[str]:
        """The functions and features that generators are for."""
        found = set()
        for generator in self.world.program.generators:
            for term in goal_terms(generator.goal):
                found.add(term.function if isinstance(term, Apply) else term.feature)
        return frozenset(found)

    def _body(self, name: str) -> Expression | None:
        function = self.world.functions[name]
        own = tuple(Variable(p.name, p.type) for p in function.parameters)
        return unfold(function, own)

    def open_cells(self, cells: Cells) -> tuple[tuple[Cell, Value], ...]:
        """The cells of a state that hold unknowns."""
        found = self._states.get(id(cells))
        if found is None or found[0] is not cells:
            own = tuple(self._look_for_unknowns(cells))
            if len(self._states) >= _MOST_STATES:
                self._states = {}
            found = self._states[id(cells)] = (cells, own)
        return found[1]

    def _look_for_unknowns(self, cells: Cells) -> Iterator[tuple[Cell, Value]]:
        """The cells that hold unknowns; of maps above others, each is looked through once."""
        if not isinstance(cells, ChainMap):
            yield from ((c, v) for c, v in cells.items() if has_unknown(v))
            return
        for depth, part in enumerate(cells.maps):
            above = cells.maps[:depth]
            for cell, value in self.open_cells(part):
                if not any(cell in other for other in above):
                    yield cell, value

    def unknowns_read(self, cells: Cells, reads: frozenset[str] | None) -> Iterator[Unknown]:
        """The unknowns in the cells of some features."""
        if reads:
            for (feature, _), value in self.open_cells(cells):
                if feature in reads:
                    yield from unknowns_in(value)

    def resolved(self, cells: Cells, values: Mapping[Unknown, Value]) -> Cells:
        """The cells of a state with the values that unknowns have by now."""
        own = self.open_cells(cells)
        if not own:
            return cells
        given: tuple[Any, ...] = tuple([resolved(value, values) for _, value in own])
        key = (id(cells), given)
        found = self._resolved.get(key)
        if found is None or found[0] is not cells:
            if len(self._resolved) >= _MOST_STATES:
                self._resolved = {}
            changed = {c: v for (c, _), v in zip(own, given, strict=True)}
            found = self._resolved[key] = (cells, FixedCells(changed, cells))
        return found[1]


def goal_terms(goal: Expression) -> list[Apply | Read]:
    """The function or features that the goal of a generator is about."""
    match goal:
        case Not(operand=operand):
            return goal_terms(operand)
        case Compare(left=left, right=right):
            return [side for side in (left, right) if isinstance(side, Apply | Read)]
        case Apply() | Read():
            return [goal]
        case _:
            return []
