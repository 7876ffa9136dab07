"""Generators in Python: called with inputs, what they yield checked as it comes (App. B.1)."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, Final

from crow.calls import Call, Row, arguments_for, check_finite, part_read
from crow.functions import Registration
from crow.outside import taken_in
from crow.problem import State, World
from crow.program import Expression, Generator, Parameter
from crow.program.types import PYOBJECT, underlying
from crow.reading import WrongValueError
from crow.views import StateView

if TYPE_CHECKING:
    from numpy.random import Generator as RandomGenerator
    from numpy.typing import NDArray

_END: Final = object()


class ExternalGenerator:
    """A generator of one world.

    `goal` is what its outputs make true given its inputs, both of which are parameters, by name and
    type. `is_complete` says that it ends and yields every solution, `limit` how many values of a
    call may be asked for, None for any number. `reads` are the features that it may read, None if
    it does not get the state.
    """

    def __init__(self, world: World, declared: Generator, python: Registration) -> None:
        parameters = {p.name: p for p in declared.parameters}
        self.world = world
        self.declared = declared
        self.name = declared.name
        self.goal: Expression = declared.goal
        self.inputs: tuple[Parameter, ...] = tuple(parameters[n] for n in declared.inputs)
        self.outputs: tuple[Parameter, ...] = tuple(parameters[n] for n in declared.outputs)
        self.python = python
        self.reads = python.reads
        self.takes_random = python.takes_random
        self.is_batch = python.mark.is_batch
        self.is_complete = python.mark.is_complete
        self.limit = python.mark.limit

    def draw(
        self, state: State, inputs: Row, rng: "RandomGenerator | None" = None
    ) -> Iterator[Row]:
        """The outputs for some inputs in a state, one after another as they are asked for.

        It may go on for ever, and does not look at `limit`. Raises FunctionError for what the
        Python raises, and for what it yields that is no tuple of outputs; Touched where an input,
        or a cell that is read, is not known yet; ArithmeticError for an input out of range.
        """
        for rows in self.batches(state, inputs, rng):
            yield from rows

    def batches(
        self, state: State, inputs: Row, rng: "RandomGenerator | None" = None
    ) -> Iterator[list[Row]]:
        """The outputs as they are yielded together; those of one that is no `batch` one by one.

        Raises as `draw` does.
        """
        for call, yielded in self._yielded(state, inputs, rng):
            yield self._rows(call, yielded) if self.is_batch else [self._row(call, yielded)]

    def arrays(
        self, state: State, inputs: Row, rng: "RandomGenerator | None" = None
    ) -> "Iterator[tuple[NDArray[Any], ...]]":
        """The outputs of a `batch` as they are yielded: arrays with a row for each solution.

        Their rows become values by `row`. Raises as `draw` does.
        """
        import numpy as np

        for call, yielded in self._yielded(state, inputs, rng):
            columns = tuple([call.of(np.asarray, c) for c in self._columns(call, yielded)])
            for column, output in zip(columns, self.outputs, strict=True):
                if len(column):  # all its rows have one type and shape
                    call.taken(column[0], output.type, self.world)
                check_finite(call, column, output.type, self.world)
            yield columns

    def row(self, arrays: "tuple[NDArray[Any], ...]", index: int) -> Row:
        """One solution of a `batch`. Raises FunctionError for what is no tuple of outputs."""
        call = Call(self.name, None, self.declared.location)
        pairs = zip(arrays, self.outputs, strict=True)
        return tuple([call.taken(a[index], output.type, self.world) for a, output in pairs])

    def _yielded(
        self, state: State, inputs: Row, rng: "RandomGenerator | None"
    ) -> Iterator[tuple[Call, Any]]:
        """What the Python yields, as it is."""
        own = arguments_for(inputs, tuple(p.type for p in self.inputs))
        first: tuple[StateView, ...] = ()
        if self.reads is not None:
            part_read(state.cells, self.reads)
            first = (StateView(self.world, state.cells, self.reads, self.name),)
        call = Call(self.name, own, self.declared.location)
        named = {"rng": rng} if self.takes_random else {}
        made = call.with_values(self.python.call, first, own, **named)
        if not hasattr(made, "__iter__"):
            raise call.wrong(f"returned `{made!r:.60}`, where a generator yields")
        solutions = call.of(iter, made)
        while (yielded := call.of(next, solutions, _END)) is not _END:
            yield call, yielded

    def _row(self, call: Call, yielded: Any) -> Row:
        """The outputs of one solution."""
        if len(self.outputs) == 1:
            return self._single(call, yielded)
        if not isinstance(yielded, tuple | list) or len(yielded) != len(self.outputs):
            raise call.wrong(f"yielded `{yielded!r:.60}`, where {self._wanted()} is wanted")
        pairs = zip(yielded, self.outputs, strict=True)
        return tuple([call.taken(one, output.type, self.world) for one, output in pairs])

    def _single(self, call: Call, yielded: Any) -> Row:
        """The one output: a tuple of one value, or the value itself."""
        type_ = self.outputs[0].type
        is_tuple = isinstance(yielded, tuple)
        if underlying(type_) == PYOBJECT and is_tuple:
            if len(yielded) != 1:
                raise call.wrong(
                    f"yielded a tuple of {len(yielded)} values and has one output; a value that is"
                    f" a tuple is yielded as `(value,)`"
                )
            return (call.taken(yielded[0], type_, self.world),)
        if is_tuple and len(yielded) == 1:
            try:
                return (taken_in(yielded, type_, self.world),)
            except WrongValueError:
                return (call.taken(yielded[0], type_, self.world),)
        return (call.taken(yielded, type_, self.world),)

    def _rows(self, call: Call, yielded: Any) -> list[Row]:
        """The outputs of many solutions, yielded as arrays with a row for each."""
        types = [output.type for output in self.outputs]
        return [
            tuple([call.taken(v, t, self.world) for v, t in zip(row, types, strict=True)])
            for row in zip(*self._columns(call, yielded), strict=True)
        ]

    def _columns(self, call: Call, yielded: Any) -> Sequence[Any]:
        """The arrays of many solutions, of as many rows."""
        columns: Sequence[Any] = yielded if isinstance(yielded, tuple) else (yielded,)
        if len(columns) != len(self.outputs):
            raise call.wrong(f"yielded {len(columns)} arrays, where {self._wanted()} is wanted")
        counts = [len(c) if hasattr(c, "__len__") else None for c in columns]
        if None in counts or len(set(counts)) > 1:
            raise call.wrong("yielded arrays that do not have as many rows")
        return columns

    def _wanted(self) -> str:
        names = ", ".join(output.name for output in self.outputs)
        count = len(self.outputs)
        return f"a tuple of {count} ({names})" if count > 1 else f"`{names}`"
