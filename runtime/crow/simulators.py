"""Effects of controllers that Python computes, with a simulator perhaps (§2.2)."""

from collections.abc import Mapping
from typing import Any

from crow.calls import Call, Cells, Remembered, Row, arguments_for, part_read
from crow.functions import Registration
from crow.outside import taken_in
from crow.problem import Cell, World
from crow.program import Controller, Location
from crow.reading import WrongValueError
from crow.values import Value, stored
from crow.views import StateView


class ExternalEffect:
    """The effect of one controller of a world.

    It may read and write each feature of the program; the same call in the same state has the same
    effect, computed once.
    """

    def __init__(self, world: World, declared: Controller, python: Registration) -> None:
        assert python.reads is not None
        self.world = world
        self.declared = declared
        self.python = python
        self.reads = python.reads
        self.types = tuple(p.type for p in declared.parameters)
        self._remembered = Remembered()

    def changes(
        self, cells: Cells, arguments: Row, location: Location | None = None
    ) -> Mapping[Cell, Value]:
        """What a call writes into the cells of a state.

        Raises FunctionError for what the Python raises, and where it returns anything but values
        for cells of the program; Touched where an argument or a cell is not known yet;
        ArithmeticError for an argument out of range.
        """
        own = arguments_for(arguments, self.types)
        key = (own, part_read(cells, self.reads))
        if key in self._remembered.known:
            known: Mapping[Cell, Value] = self._remembered.known[key]
            return known
        name = self.declared.name
        call = Call(name, own, location)
        state = StateView(self.world, cells, self.reads, name)
        given = call.with_values(self.python.call, (state,), own)
        return self._remembered.add(key, self._checked(call, given))

    def _checked(self, call: Call, given: Any) -> dict[Cell, Value]:
        if not isinstance(given, Mapping):
            raise call.wrong(f"returned `{given!r:.60}`, where a mapping from cells is wanted")
        found: dict[Cell, Value] = {}
        for named, value in given.items():
            cell = self._cell(call, named)
            if cell in found:
                raise call.wrong(f"gave two values for `{named}`")
            found[cell] = self._value(call, cell, value)
        return found

    def _cell(self, call: Call, named: object) -> Cell:
        from crow.stated import ProblemError, cell_of

        try:
            feature, cell = cell_of(self.world, named)
        except ProblemError as error:
            raise call.wrong(f"gave a value for what is no cell: {error}") from None
        if feature.name not in self.reads:  # a function of Python that has become a table
            raise call.wrong(f"gave a value for `{feature.name}`, which is no feature")
        return cell

    def _value(self, call: Call, cell: Cell, value: object) -> Value:
        type_ = self.world.features[cell[0]].type
        try:
            return stored(taken_in(value, type_, self.world), type_)
        except (WrongValueError, ArithmeticError) as error:
            shown = f"{cell[0]}({', '.join(cell[1])})"
            raise call.wrong(f"gave `{shown}` what does not fit: {error}") from None
