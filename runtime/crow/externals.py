"""The Python of one world, ready to be called, what it gives checked (semantics.md §4)."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from crow.calls import Call, Cells, Remembered, Row, arguments_for, check_finite, part_read
from crow.functions import Registration
from crow.generators import ExternalGenerator
from crow.problem import World
from crow.program import Function, Location, Parameter, Type
from crow.program.types import is_opaque
from crow.simulators import ExternalEffect
from crow.values import Value, given_out
from crow.views import StateView

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Externals:
    """What is registered for a world, ready to be called."""

    def __init__(self, world: World) -> None:
        given, program = world.registered, world.program
        functions = {f.name: f for f in program.functions}
        generators = {g.name: g for g in program.generators}
        # A function that has become a table is no longer called.
        self.functions: dict[str, ExternalFunction] = {
            name: ExternalFunction(world, functions[name], one)
            for name, one in given.functions.items()
            if name in functions
        }
        self.generators: dict[str, ExternalGenerator] = {
            name: ExternalGenerator(world, generators[name], one)
            for name, one in given.generators.items()
        }
        self.effects: dict[str, ExternalEffect] = {
            name: ExternalEffect(world, world.controllers[name], one)
            for name, one in given.effects.items()
        }


class ExternalFunction:
    """An external function of one world; what it has given it is not asked again."""

    def __init__(self, world: World, declared: Function, python: Registration) -> None:
        self.world = world
        self.declared = declared
        self.python = python
        self.reads = python.reads
        self.types = tuple(p.type for p in declared.parameters)
        self._remembered = Remembered()

    def value(self, cells: Cells, arguments: Row, location: Location | None = None) -> Value:
        """The value for some arguments in a state; `location` is that of the call.

        Raises FunctionError for what the Python raises and for what is no value of the type,
        ArithmeticError for an argument that its parameter does not hold, and Touched where an
        argument, or a cell that is read, is not known yet.
        """
        own = arguments_for(arguments, self.types)
        key: object = own if self.reads is None else (own, part_read(cells, self.reads))
        try:
            return self._remembered.known[key]
        except KeyError:
            pass
        if self.python.mark.is_vectorized:
            (found,) = self._many(cells, [own], location)
        else:
            call = Call(self.declared.name, own, location)
            given = call.with_values(self.python.call, self._state(cells), own)
            found = call.taken(given, self.declared.type, self.world)
        return self._remembered.add(key, found)

    def values(
        self, cells: Cells, rows: Sequence[Row], location: Location | None = None
    ) -> list[Value]:
        """The values for many rows of arguments; a vectorized function is called once.

        Raises as `value` does.
        """
        if not self.python.mark.is_vectorized:
            return [self.value(cells, row, location) for row in rows]
        own = [arguments_for(row, self.types) for row in rows]
        part = None if self.reads is None else part_read(cells, self.reads)
        keys = [(row, part) if self.reads is not None else row for row in own]
        known = self._remembered.known
        missing = {key: row for key, row in zip(keys, own, strict=True) if key not in known}
        found: dict[object, Value] = {}
        if missing:
            given = self._many(cells, list(missing.values()), location)
            found = dict(zip(missing, given, strict=True))
        values = [found[key] if key in found else known[key] for key in keys]
        for key, value in found.items():
            self._remembered.add(key, value)
        return values

    @property
    def is_vectorized(self) -> bool:
        """Whether it takes many candidates at once."""
        return self.python.mark.is_vectorized

    def column(
        self, cells: Cells, columns: "Sequence[NDArray[Any]]", location: Location | None = None
    ) -> "NDArray[Any]":
        """What a vectorized function gives for columns of arguments, as it gives it: an array.

        Raises FunctionError for what the Python raises, for another number of rows, and for
        numbers that are not finite.
        """
        import numpy as np

        call = Call(self.declared.name, None, location)
        given = np.asarray(call.of(self.python.call, *self._state(cells), *columns))
        if given.shape[:1] != (count := len(columns[0]),):
            told = f"{len(given)} results" if given.ndim else f"`{given!r:.60}`"
            raise call.wrong(f"gave {told} for {count} candidates")
        check_finite(call, given, self.declared.type, self.world)
        return given

    def _state(self, cells: Cells) -> tuple[StateView, ...]:
        """The first argument, if it is the state."""
        if self.reads is None:
            return ()
        return (StateView(self.world, cells, self.reads, self.declared.name),)

    def _many(self, cells: Cells, rows: list[Row], location: Location | None) -> list[Value]:
        call = Call(self.declared.name, rows[0] if len(rows) == 1 else None, location)
        columns = as_columns(rows, self.declared.parameters)
        given = call.of(self.python.call, *self._state(cells), *columns)
        if not hasattr(given, "__len__") or len(given) != len(rows):
            told = f"{len(given)} results" if hasattr(given, "__len__") else f"`{given!r:.60}`"
            raise call.wrong(f"gave {told} for {len(rows)} candidates")
        return [call.taken(one, self.declared.type, self.world) for one in given]


def as_columns(rows: Sequence[Row], parameters: Sequence[Parameter]) -> "list[NDArray[Any]]":
    """Rows of values as one numpy array for each parameter, a row of it for each row.

    Numbers and vectors have arrays of numbers; objects, strings and opaque values those of Python
    objects.
    """
    return [
        _column([row[index] for row in rows], parameter.type)
        for index, parameter in enumerate(parameters)
    ]


def _column(values: list[Value], type_: Type) -> "NDArray[Any]":
    import numpy as np

    if _is_numeric(values[0]) and not is_opaque(type_):
        try:
            return np.array(values)
        except ValueError:  # vectors of different lengths
            pass
    column = np.empty(len(values), dtype=object)
    for index, value in enumerate(values):
        column[index] = given_out(value)
    return column


def _is_numeric(value: Value) -> bool:
    if isinstance(value, tuple):
        return bool(value) and all(map(_is_numeric, value))
    return isinstance(value, bool | int | float)
