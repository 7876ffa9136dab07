"""States of a search: what differs from the initial state, each state one object."""

from collections import ChainMap
from collections.abc import Hashable, Iterable, Iterator, Mapping
from functools import cached_property
from typing import Any

from crow.calls import FixedCells
from crow.problem import Cell, State, World
from crow.unknowns import has_unknown
from crow.values import Value, default_value


class Snapshot:
    """A state: the cells of `base` but for those in `delta`. Equal states are identical.

    Its store makes the states after it, and has the indexes of `base`.
    """

    __slots__ = ("_cells", "base", "delta", "store")

    def __init__(self, store: "Store", delta: dict[Cell, Value]) -> None:
        self.store = store
        self.base = store.base
        self.delta = delta
        self._cells: Mapping[Cell, object] | None = None

    @property
    def cells(self) -> Mapping[Cell, object]:
        """All cells, as the interpreter reads them."""
        if self._cells is None:
            self._cells = self.store.cells_of(self.delta, self.base)
        return self._cells


class Store:
    """The states of one search, and indexes of the cells of its initial state.

    `decided` is what the point that runs takes for true or false of values it does not know.
    """

    cells_of: type[ChainMap[Cell, object]] = FixedCells

    def __init__(self, world: World, initial: State) -> None:
        self.world = world
        self.base: dict[Cell, Value] = dict(initial.cells)
        self.defaults = {name: default_value(f.type) for name, f in world.features.items()}
        self.initial = Snapshot(self, {})
        self.decided: Mapping[Hashable, bool] = {}
        self.known: dict[frozenset[tuple[Cell, Value]], Snapshot] = {frozenset(): self.initial}
        self._indexes: dict[tuple[str, int], dict[str, list[tuple[str, ...]]]] = {}

    def after(self, before: Snapshot, written: Iterable[tuple[Cell, Value]]) -> Snapshot:
        """The state after some cells were written."""
        delta = dict(before.delta)
        for cell, value in written:
            # An unknown is as good as no value of the initial state, whatever it will turn out as.
            if not has_unknown(value) and self.base.get(cell, self.defaults[cell[0]]) == value:
                delta.pop(cell, None)
            else:
                delta[cell] = value
        key = frozenset(delta.items())
        found = self.known.get(key)
        if found is None:
            found = self.known[key] = Snapshot(self, delta)
        return found

    def rows(
        self, state: Snapshot, feature: str, position: int, argument: str
    ) -> Iterator[tuple[str, ...]]:
        """Arguments of the true cells of a feature that have an object at a position.

        A cell that became false since the start may be among them.
        """
        yield from self._index(feature, position).get(argument, ())
        for (name, arguments), value in state.delta.items():
            if name == feature and value and arguments[position] == argument:
                yield arguments

    def all_rows(self, state: Snapshot, feature: str) -> Iterator[tuple[str, ...]]:
        """Arguments of the true cells of a feature; with others, as `rows`."""
        for rows in self._index(feature, 0).values():
            yield from rows
        for (name, arguments), value in state.delta.items():
            if name == feature and value:
                yield arguments

    def _index(self, feature: str, position: int) -> dict[str, list[tuple[str, ...]]]:
        found = self._indexes.get((feature, position))
        if found is None:
            found = self._indexes[feature, position] = {}
            for arguments in self._true.get(feature, ()):
                found.setdefault(arguments[position], []).append(arguments)
        return found

    @cached_property
    def _true(self) -> dict[str, list[tuple[str, ...]]]:
        """The arguments of the true cells of the initial state, by feature."""
        found: dict[str, list[tuple[str, ...]]] = {}
        for (feature, arguments), value in self.base.items():
            if value:
                found.setdefault(feature, []).append(arguments)
        return found


def state_of(snapshot: Snapshot, world: World) -> State:
    """The state as everyone else knows it."""
    return world.updated(State(snapshot.base), dict(snapshot.delta))


Test = Any
"""A compiled expression: a function of a Snapshot and the values of slots."""
