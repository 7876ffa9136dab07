"""What the solver asks of the user's Python: functions, and generators of values."""

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol

from crow.problem import Cell, State
from crow.program import Location
from crow.values import Value

if TYPE_CHECKING:
    from numpy.random import Generator as Random

Cells = Mapping[Cell, object]
Row = tuple[Value, ...]


class PythonFunction(Protocol):
    """An external function; `reads` are the features it reads, None if it reads no state."""

    reads: frozenset[str] | None

    @property
    def is_vectorized(self) -> bool:
        """Whether `column` may be asked."""

    def value(self, cells: Cells, arguments: Row, location: Location | None = None) -> Value:
        """The value for some arguments, of the type of the function."""

    def column(self, cells: Cells, columns: Sequence[Any], location: Location | None = None) -> Any:
        """The values of a vectorized function, as an array, for arrays of arguments."""


class PythonGenerator(Protocol):
    """A generator of values (App. B.1).

    `is_complete`: it ends, and yields every solution. `limit`: the most values asked of one call.
    `is_batch`: it yields many candidates at once.
    """

    reads: frozenset[str] | None
    is_complete: bool
    is_batch: bool
    limit: int | None

    def draw(self, state: State, inputs: Row, rng: "Random | None" = None) -> Iterator[Row]:
        """Tuples of outputs, in the order in which the program declares them."""

    def arrays(
        self, state: State, inputs: Row, rng: "Random | None" = None
    ) -> Iterator[tuple[Any, ...]]:
        """For batches: tuples of arrays, a row for each candidate."""

    def row(self, arrays: tuple[Any, ...], index: int) -> Row:
        """One candidate of a batch as outputs."""


class Python(Protocol):
    """All Python of one world, by name."""

    functions: Mapping[str, PythonFunction]
    generators: Mapping[str, PythonGenerator]
