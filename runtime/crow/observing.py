"""States as they are observed: checked, and taken for projected ones within tolerances (§2)."""

from collections.abc import Mapping
from functools import cache, cached_property

from crow.evaluate import shown_cell
from crow.outside import taken_in
from crow.problem import Cell, State, World
from crow.program import ListType, Type, VectorType
from crow.program.types import NamedType, is_number
from crow.reading import WrongValueError
from crow.values import Value, default_value, stored


class Observing:
    """Makes observations of one world into states."""

    def __init__(self, world: World) -> None:
        self.world = world
        self.tolerance = cache(self._tolerance)

    def state(self, observed: State | Mapping[Cell, object]) -> State:
        """The state with the given values; cells that are left out have the default of their type.

        Raises ValueError for a cell or a value that the program does not have.
        """
        cells = observed.cells if isinstance(observed, State) else observed
        known = {}
        for cell, value in cells.items():
            feature = self._feature_type(cell)
            held = self._value(cell, feature, value)
            if held != default_value(feature):
                known[cell] = held
        return State(known)

    def snapped(self, observed: State, expected: State) -> State:
        """The observed state; values within the tolerance of their type are the expected ones."""
        if not self._tolerant:
            return observed
        changes = {}
        for cell in {**observed.cells, **expected.cells}:
            type_ = self._tolerant.get(cell[0])
            if type_ is not None:
                unset = default_value(type_)
                seen, wanted = (s.cells.get(cell, unset) for s in (observed, expected))
                if seen != wanted and self._is_close(seen, wanted, type_, 0.0):
                    changes[cell] = wanted
        return self.world.updated(observed, changes) if changes else observed

    # -------------------------------------------------------------------------------- tolerances

    @cached_property
    def _tolerant(self) -> dict[str, Type]:
        """The features whose type has a tolerance, with that type."""
        features = self.world.program.features
        return {f.name: f.type for f in features if self._has_tolerance(f.type)}

    def _has_tolerance(self, type_: Type) -> bool:
        match type_:
            case NamedType(base=base):
                return bool(self.tolerance(type_)) or self._has_tolerance(base)
            case VectorType(element=element) | ListType(element=element):
                return self._has_tolerance(element)
            case _:
                return False

    def _tolerance(self, type_: Type) -> float:
        """What a `typedef [[tolerance=…]]` says; 0 without one."""
        if not isinstance(type_, NamedType):
            return 0.0
        definition = next(t for t in self.world.program.types if t.name == type_.name)
        said = (a.value for a in definition.annotations if a.name == "tolerance")
        return next((float(v) for v in said if isinstance(v, int | float)), 0.0)

    def _is_close(self, seen: Value, wanted: Value, type_: Type, tolerance: float) -> bool:
        """Whether a value differs from another by no more than its type tolerates, part by part."""
        while isinstance(type_, NamedType):
            tolerance = tolerance or self.tolerance(type_)
            type_ = type_.base
        match type_:
            case VectorType(element=element) | ListType(element=element):
                if seen is None or wanted is None or len(seen) != len(wanted):
                    return False
                pairs = zip(seen, wanted, strict=True)
                return all(self._is_close(s, w, element, tolerance) for s, w in pairs)
            case _ if is_number(type_):
                return abs(float(seen) - float(wanted)) <= tolerance
            case _:
                return bool(seen == wanted)

    # -------------------------------------------------------------------------------------- checks

    def _feature_type(self, cell: object) -> Type:
        if not (isinstance(cell, tuple) and len(cell) == 2 and isinstance(cell[1], tuple)):
            raise ValueError(f"{cell!r} is no cell: a feature's name and a tuple of objects")
        name, arguments = cell
        feature = self.world.features.get(name)
        if feature is None:
            raise ValueError(f"an observation of `{name}`, which is no feature")
        places = [p.type for p in feature.parameters]
        fits = len(places) == len(arguments) and all(map(self.world.is_of, arguments, places))
        if not fits:
            raise ValueError(f"an observation of `{shown_cell(cell)}`, which is no cell")
        return feature.type

    def _value(self, cell: Cell, type_: Type, value: object) -> Value:
        try:
            return stored(taken_in(value, type_, self.world), type_)
        except (WrongValueError, ArithmeticError):
            shown = f"the observed `{shown_cell(cell)}` is {value!r}"
            raise ValueError(f"{shown}, which is no `{type_}`") from None
