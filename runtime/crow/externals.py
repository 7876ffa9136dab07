"""The Python of one world: called with values of CDL, what it gives checked (semantics.md §4).

What a function has given for its arguments, and the cells it reads, it is not asked again.
"""

from collections import ChainMap
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final, TypeVar

from crow.budget import Stopped
from crow.functions import Registration
from crow.outside import given_out, taken_in
from crow.plan import call_text
from crow.problem import Cell, World
from crow.program import Function, Location, ObjectType, Parameter, Type
from crow.program.types import BOOL, underlying
from crow.python_files import user_traceback
from crow.reading import WrongValueError
from crow.values import Value, converted
from crow.views import StateView

if TYPE_CHECKING:
    from numpy.typing import NDArray

Row = tuple[Value, ...]
Cells = Mapping[Cell, object]
_T = TypeVar("_T")

MOST_REMEMBERED: Final = 100_000
"""What one function has given for so many arguments is kept."""


class FunctionError(Exception):
    """The user's Python raised, or gave what is no value of its type.

    `name` is that of the function, generator, effect or controller, `call` the call as text,
    `reason` says what happened, `location` is the place in the program, and `traceback` that of
    the user's own code, or empty.
    """

    def __init__(
        self, name: str, call: str, reason: str, location: Location | None, traceback: str = ""
    ) -> None:
        super().__init__(name, call, reason, location, traceback)
        self.name = name
        self.call = call
        self.reason = reason
        self.location = location
        self.traceback = traceback

    def __str__(self) -> str:
        place = "" if self.location is None else f"{self.location}: "
        return f"{place}`{self.call}` {self.reason}\n{self.traceback}".rstrip()


class FixedCells(ChainMap[Cell, object]):
    """The cells of a state that never changes, so that parts of it can be remembered with it."""

    def __init__(self, *maps: Any) -> None:
        super().__init__(*maps)
        self.parts: dict[frozenset[str], frozenset[tuple[Cell, object]]] = {}


def part_read(cells: Cells, reads: frozenset[str]) -> frozenset[tuple[Cell, object]]:
    """The cells of some features that differ from their defaults: all that the value depends on."""
    if not isinstance(cells, FixedCells):
        return _part_read(cells, reads)
    found = cells.parts.get(reads)
    if found is None:
        found = cells.parts[reads] = _part_read(cells, reads)
    return found


def _part_read(cells: Cells, reads: frozenset[str]) -> frozenset[tuple[Cell, object]]:
    return frozenset([item for item in cells.items() if item[0][0] in reads])


class Externals:
    """What is registered for a world, ready to be called."""

    def __init__(self, world: World) -> None:
        given = world.registered
        declared = {f.name: f for f in world.program.functions}
        self.functions: dict[str, ExternalFunction] = {
            name: ExternalFunction(world, declared[name], one)
            for name, one in given.functions.items()
            if name in declared
        }


class ExternalFunction:
    """An external function of one world."""

    def __init__(self, world: World, declared: Function, python: Registration) -> None:
        self.world = world
        self.declared = declared
        self.python = python
        self.reads = python.reads
        self.types = tuple(p.type for p in declared.parameters)
        self._known: dict[object, Value] = {}

    def value(self, cells: Cells, arguments: Row, location: Location | None = None) -> Value:
        """The value for some arguments in a state; `location` is that of the call.

        Raises FunctionError for what the Python raises and for what is no value of the type, and
        ArithmeticError for an argument that its parameter does not hold.
        """
        own = self._converted(arguments)
        key: object = own if self.reads is None else (own, part_read(cells, self.reads))
        try:
            return self._known[key]
        except KeyError:
            pass
        if self.python.mark.is_vectorized:
            (found,) = self._many(cells, [own], location)
        else:
            found = self._one(cells, own, location)
        return self._remember(key, found)

    def values(
        self, cells: Cells, rows: Sequence[Row], location: Location | None = None
    ) -> list[Value]:
        """The values for many rows of arguments; a vectorized function is called once.

        Raises as `value` does.
        """
        if not self.python.mark.is_vectorized:
            return [self.value(cells, row, location) for row in rows]
        own = [self._converted(row) for row in rows]
        part = None if self.reads is None else part_read(cells, self.reads)
        keys: list[object] = [row if self.reads is None else (row, part) for row in own]
        missing = {k: row for k, row in zip(keys, own, strict=True) if k not in self._known}
        found: dict[object, Value] = {}
        if missing:
            given = self._many(cells, list(missing.values()), location)
            found = dict(zip(missing, given, strict=True))
        values = [found[key] if key in found else self._known[key] for key in keys]
        for key, value in found.items():
            self._remember(key, value)
        return values

    def _remember(self, key: object, value: Value) -> Value:
        if len(self._known) >= MOST_REMEMBERED:
            self._known = {}
        self._known[key] = value
        return value

    def _converted(self, arguments: Row) -> Row:
        pairs = zip(arguments, self.types, strict=True)
        return tuple([value if _is_plain(type_) else converted(value, type_)
                      for value, type_ in pairs])  # fmt: skip

    def _state(self, cells: Cells) -> tuple[StateView, ...]:
        """The first argument, if it is the state."""
        if self.reads is None:
            return ()
        return (StateView(self.world, cells, self.reads, self.declared.name),)

    def _one(self, cells: Cells, arguments: Row, location: Location | None) -> Value:
        call = Call(self.declared.name, call_text(self.declared.name, arguments, {}), location)
        given = call.of(self.python.call, *self._state(cells), *map(given_out, arguments))
        return call.taken(given, self.declared.type, self.world)

    def _many(self, cells: Cells, rows: list[Row], location: Location | None) -> list[Value]:
        name = self.declared.name
        shown = call_text(name, rows[0], {}) if len(rows) == 1 else f"{name}(…)"
        call = Call(name, shown, location)
        columns = as_columns(rows, self.declared.parameters)
        given = call.of(lambda: list(self.python.call(*self._state(cells), *columns)))
        if len(given) != len(rows):
            raise call.wrong(f"gave {len(given)} results for {len(rows)} candidates")
        return [call.taken(one, self.declared.type, self.world) for one in given]


def _is_plain(type_: Type) -> bool:
    """Whether values of a type need no conversion."""
    return isinstance(type_, ObjectType) or underlying(type_) == BOOL


# -------------------------------------------------------------------------------------------- calls


class Call:
    """One call of the user's Python, and what goes wrong with it."""

    __slots__ = ("_location", "_name", "_shown")

    def __init__(self, name: str, shown: str, location: Location | None) -> None:
        self._name = name
        self._shown = shown if len(shown) <= 200 else f"{shown[:199]}…"
        self._location = location

    def of(self, python: Callable[..., _T], *arguments: object) -> _T:
        """What a Python function returns. Raises FunctionError for what it raises."""
        try:
            return python(*arguments)
        except (Stopped, MemoryError):  # limits of a search, which a timer may find here
            raise
        except Exception as error:  # noqa: BLE001 - whatever the user's code raises
            raise self.raised(error) from None

    def raised(self, error: Exception) -> FunctionError:
        """That the user's code raised."""
        told = f"{type(error).__name__}: {error}".removesuffix(": ")
        return self.wrong(f"raised {told}", user_traceback(error))

    def taken(self, value: object, type_: Type, world: World) -> Value:
        """The value of a type that was given. Raises FunctionError."""
        try:
            return taken_in(value, type_, world)
        except WrongValueError as error:
            raise self.wrong(f"gave what does not fit: {error}") from None

    def wrong(self, reason: str, traceback: str = "") -> FunctionError:
        """What goes wrong, with its place."""
        return FunctionError(self._name, self._shown, reason, self._location, traceback)


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

    if _is_numeric(values[0]) and not isinstance(type_, ObjectType):
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
