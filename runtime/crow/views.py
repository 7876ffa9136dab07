"""A state as Python functions of the user see it: read-only, and only what was declared."""

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from crow.problem import Cell, World
from crow.program import Feature
from crow.values import Value, given_out

if TYPE_CHECKING:
    from collections.abc import Set as AbstractSet


class StateError(Exception):
    """Python asked a state for what it does not have, or what was not declared to be read."""


class StateView:
    """The state in which a function is called.

    `state.on("a", "b")` or `state["on", "a", "b"]` is the value of a cell,
    `state.objects("block")` are the names of objects of a type, and `state.cells("on")` the cells
    that have a value (of a Boolean feature, the true ones), from their objects to values. Raises
    StateError for a feature that is none, or that `reads` does not name.
    """

    __slots__ = ("_cells", "_reads", "_wanted_by", "_world")

    def __init__(
        self,
        world: World,
        cells: Mapping[Cell, object],
        reads: "AbstractSet[str]",
        wanted_by: str,
    ) -> None:
        self._world = world
        self._cells = cells
        self._reads = reads
        self._wanted_by = wanted_by

    def __getitem__(self, cell: str | tuple[str, ...]) -> Value:
        name, *objects = (cell,) if isinstance(cell, str) else cell
        return self._value(self._feature(name), tuple(objects))

    def __getattr__(self, name: str) -> Callable[..., Value]:
        # AttributeError is for Python itself, which asks for such names when it copies or inspects.
        if name.startswith("__"):
            raise AttributeError(name)
        feature = self._feature(name)
        return lambda *objects: self._value(feature, objects)

    def objects(self, type_: str = "object") -> tuple[str, ...]:
        """The names of the objects of a type and its subtypes, in order of declaration."""
        from crow.program import ObjectType

        known = {t.name for t in self._world.program.types if t.is_object} | {"object"}
        if type_ not in known:
            raise StateError(f"there is no object type `{type_}`")
        return self._world.objects_of(ObjectType(type_))

    def cells(self, name: str) -> dict[tuple[str, ...], Value]:
        """The cells of a feature that have a value; of a Boolean feature, those that are true."""
        feature, unset = self._feature(name), self._world.defaults[name]
        if unset is not None and unset is not False:
            return {cell: self._value(feature, cell) for cell in self._world.cells(feature)}
        ranks = {name: rank for rank, name in enumerate(self._world.objects)}
        found = [c for (own, c), value in self._cells.items() if own == name and value is not False]
        ordered = sorted(found, key=lambda arguments: [ranks[a] for a in arguments])
        return {arguments: given_out(self._cells[name, arguments]) for arguments in ordered}

    def _feature(self, name: str) -> Feature:
        feature = self._world.features.get(name)
        if feature is None:
            raise StateError(f"there is no feature `{name}`")
        if name not in self._reads:
            raise StateError(
                f"`{self._wanted_by}` reads `{name}`, and does not say so: `[[reads={name}]]`"
            )
        return feature

    def _value(self, feature: Feature, objects: tuple[str, ...]) -> Value:
        if len(objects) != len(feature.parameters):
            count = len(feature.parameters)
            plural = "" if count == 1 else "s"
            raise StateError(f"`{feature.name}` takes {count} object{plural}, not {len(objects)}")
        for name, parameter in zip(objects, feature.parameters, strict=True):
            if not self._world.is_of(name, parameter.type):
                raise StateError(f"`{feature.name}`: no object `{name}` of type `{parameter.type}`")
        cell = (feature.name, objects)
        value = self._cells.get(cell, self._world.defaults[feature.name])
        if value is None:
            raise StateError(f"`{feature.name}({', '.join(objects)})` has no value")
        return given_out(value)
