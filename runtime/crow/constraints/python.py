"""What the solver asks of the user's Python: functions, and generators of values."""

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol

from crow.problem import Cell
from crow.program import Location
from crow.values import Value

if TYPE_CHECKING:
    from numpy.random import Generator as Random

Cells = Mapping[Cell, object]
Row = tuple[Value, ...]


class PythonFunction(Protocol):
    """An external function; `reads` are the features it reads, None if it reads no state."""

    @property
    def reads(self) -> frozenset[str] | None: ...  # noqa: D102

    @property
    def is_vectorized(self) -> bool:
        """Whether `column` may be called."""

    def value(self, cells: Cells, arguments: Row, location: Location | None = None) -> Value:
        """The value for some arguments, of the type of the function."""

    def column(self, cells: Cells, columns: Sequence[Any], location: Location | None = None) -> Any:
        """The values, as an array, for arguments given as arrays of as many rows."""


class PythonGenerator(Protocol):
    """A generator of values (App. B.1)."""

    @property
    def reads(self) -> frozenset[str] | None: ...  # noqa: D102

    @property
    def is_complete(self) -> bool:
        """Whether it ends, and yields every solution."""

    @property
    def is_batch(self) -> bool:
        """Whether it yields tuples of arrays with a row for each candidate."""

    @property
    def limit(self) -> int | None:
        """The most values asked of one call."""

    def draw(
        self, cells: Cells, inputs: Row, random: "Random", location: Location | None = None
    ) -> Iterator[tuple[Any, ...]]:
        """Tuples of outputs, in the order in which the program declares them."""


class Python(Protocol):
    """All Python of one world, by name."""

    @property
    def functions(self) -> Mapping[str, PythonFunction]: ...  # noqa: D102

    @property
    def generators(self) -> Mapping[str, PythonGenerator]: ...  # noqa: D102
