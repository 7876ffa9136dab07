"""Calls of the user's Python: what it may see, raises and gives (semantics.md §4)."""

from collections import ChainMap
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Final, TypeVar

from crow.budget import Stopped
from crow.outside import taken_in
from crow.plan import call_text
from crow.problem import Cell, World
from crow.program import PYOBJECT, Location, ObjectType, Type
from crow.program.types import BOOL, underlying
from crow.python_files import user_traceback
from crow.reading import WrongValueError
from crow.unknowns import Touched, Unknown, unknowns_in
from crow.values import Value, converted, given_out

if TYPE_CHECKING:
    from numpy.typing import NDArray

Row = tuple[Value, ...]
Cells = Mapping[Cell, object]
Part = frozenset[tuple[Cell, object]]
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
        self.parts: dict[frozenset[str], Part | Unknown] = {}


def part_read(cells: Cells, reads: frozenset[str]) -> Part:
    """The cells of some features that differ from their defaults: what a call depends on.

    Raises Touched where one of them is not known yet: the user's code never sees an unknown.
    """
    found: Part | Unknown | None = None
    if isinstance(cells, FixedCells):
        found = cells.parts.get(reads)
    if found is None:
        found = _part_read(cells, reads)
        if isinstance(cells, FixedCells):
            cells.parts[reads] = found
    if isinstance(found, Unknown):
        raise Touched(found)
    return found


def _part_read(cells: Cells, reads: frozenset[str]) -> Part | Unknown:
    items = [item for item in cells.items() if item[0][0] in reads]
    unknown = next((u for _, value in items for u in unknowns_in(value)), None)
    return frozenset(items) if unknown is None else unknown


def arguments_for(values: Row, types: tuple[Type, ...]) -> Row:
    """Values as parameters of some types have them.

    Raises Touched for one that is not known yet, and ArithmeticError for one out of range.
    """
    return tuple([_argument(value, type_) for value, type_ in zip(values, types, strict=True)])


def _argument(value: Value, type_: Type) -> Value:
    if type(value) is Unknown:
        raise Touched(value)
    plain = underlying(type_)
    if isinstance(plain, ObjectType) or plain in (BOOL, PYOBJECT):
        return value
    if type(value) is tuple:
        for unknown in unknowns_in(value):
            raise Touched(unknown)
    return converted(value, type_)


class Remembered:
    """Values by keys, up to a number of them."""

    def __init__(self) -> None:
        self.known: dict[object, Any] = {}

    def add(self, key: object, value: _T) -> _T:
        """Keep a value; where there are too many, those before it are forgotten."""
        if len(self.known) >= MOST_REMEMBERED:
            self.known = {}
        self.known[key] = value
        return value


class Call:
    """One call of the user's Python, and what goes wrong with it."""

    __slots__ = ("_location", "_name", "_shown")

    def __init__(self, name: str, arguments: Row | None, location: Location | None) -> None:
        shown = f"{name}(…)" if arguments is None else call_text(name, arguments, {})
        self._name = name
        self._shown = shown if len(shown) <= 200 else f"{shown[:199]}…"
        self._location = location

    def with_values(
        self, python: Callable[..., _T], first: tuple[object, ...], arguments: Row, **named: object
    ) -> _T:
        """What a Python function returns for values of CDL. Raises FunctionError."""
        return self.of(python, *first, *map(given_out, arguments), **named)

    def of(self, python: Callable[..., _T], *arguments: object, **named: object) -> _T:
        """What a Python function returns. Raises FunctionError for what it raises."""
        try:
            return python(*arguments, **named)
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


def check_finite(call: Call, array: "NDArray[Any]", type_: Type, world: World) -> None:
    """Raise FunctionError for the first row of an array that has a number that is not finite."""
    import numpy as np

    if array.dtype.kind == "f" and not np.isfinite(array).all():
        call.taken(next(row for row in array if not np.isfinite(row).all()), type_, world)
