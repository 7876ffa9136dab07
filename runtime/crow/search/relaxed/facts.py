"""Facts and operators of the delete relaxation, found as they are asked for and linked once."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from crow.evaluate import EvaluationError
from crow.problem import Cell
from crow.search.code import Code
from crow.search.expressions import Compiled, Environment
from crow.search.states import Snapshot
from crow.values import Value


class CellFact(NamedTuple):
    """A cell has a value, or has not where `is_equal` is False."""

    cell: Cell
    value: Value
    is_equal: bool


class OpaqueFact(NamedTuple):
    """A condition that is only evaluated; a write of any feature it reads may make it true."""

    holds: Compiled
    values: Environment
    reads: frozenset[str]


class Made(NamedTuple):
    """True only where an operator makes it so: a choice of conditions, or a behavior that runs."""

    what: Any


Fact = CellFact | OpaqueFact | Made


class Write(NamedTuple):
    """What an effect may write: None among the arguments is any object, as value any value."""

    feature: str
    arguments: tuple[Value, ...]
    value: Value
    is_certain: bool


@dataclass(slots=True, eq=False)
class Operator:
    """A way to make facts true: a behavior with arguments and bound objects, or a choice.

    `claims` are the facts that it is applied for; `adds`, others that its writes make true, grows
    as facts are found. `asked` are the facts it needs for which behaviors may be applied.
    """

    cost: int
    needs: tuple[int, ...]
    claims: list[int] = field(default_factory=list)
    adds: list[int] = field(default_factory=list)
    writes: tuple[Write, ...] = ()
    code: Code | None = None
    arguments: tuple[Value, ...] = ()
    values: Environment = ()
    asked: tuple[int, ...] = ()

    @property
    def made(self) -> list[int]:
        """All that it may make true."""
        return self.claims + self.adds


class Task:
    """The facts and operators known so far; both are numbered."""

    def __init__(self, defaults: dict[str, Value]) -> None:
        self.defaults = defaults
        self.facts: list[Fact] = []
        self.operators: list[Operator] = []
        self.consumers: list[list[int]] = []
        self.cells: list[tuple[int, Cell, Value, bool, Value]] = []
        self.opaque: list[tuple[int, OpaqueFact]] = []
        self.writers: dict[Cell, list[int]] = {}
        self._numbers: dict[Fact, int] = {}
        self._by_cell: dict[Cell, list[int]] = {}
        self._by_feature: dict[str, list[int]] = {}
        self._exact: dict[Cell, list[tuple[int, Write]]] = {}
        self._open: dict[str, list[tuple[int, Write]]] = {}
        self._all: dict[str, list[int]] = {}
        self._readers: dict[str, list[int]] = {}

    def fact(self, fact: Fact) -> int:
        """The number of a fact."""
        number = self._numbers.get(fact)
        if number is None:
            number = self._numbers[fact] = len(self.facts)
            self.facts.append(fact)
            self.consumers.append([])
            match fact:
                case CellFact():
                    self._add_cell(number, fact)
                case OpaqueFact():
                    self._add_opaque(number, fact)
                case Made():
                    pass
        return number

    def _add_cell(self, number: int, fact: CellFact) -> None:
        cell = fact.cell
        unset = self.defaults[cell[0]]
        self.cells.append((number, cell, fact.value, fact.is_equal, unset))
        self._by_cell.setdefault(cell, []).append(number)
        self._by_feature.setdefault(cell[0], []).append(number)
        for index, write in [*self._exact.get(cell, ()), *self._open.get(cell[0], ())]:
            self._link(index, write, number)

    def _add_opaque(self, number: int, fact: OpaqueFact) -> None:
        self.opaque.append((number, fact))
        for feature in fact.reads:
            self._readers.setdefault(feature, []).append(number)
            for index in self._all.get(feature, ()):
                self._adds(index, number)

    def operator(self, operator: Operator) -> int:
        """Take an operator in; its number."""
        index = len(self.operators)
        self.operators.append(operator)
        for need in operator.needs:
            self.consumers[need].append(index)
        for write in operator.writes:
            cell = (write.feature, write.arguments)
            if None in write.arguments:
                self._open.setdefault(write.feature, []).append((index, write))
                facts = self._by_feature.get(write.feature, ())
            else:
                self._exact.setdefault(cell, []).append((index, write))
                self.writers.setdefault(cell, []).append(index)
                facts = self._by_cell.get(cell, ())
            for number in facts:
                self._link(index, write, number)
            self._all.setdefault(write.feature, []).append(index)
            for number in self._readers.get(write.feature, ()):
                self._adds(index, number)
        return index

    def _link(self, index: int, write: Write, number: int) -> None:
        fact = self.facts[number]
        assert isinstance(fact, CellFact)
        fits = all(a is None or a == b for a, b in zip(write.arguments, fact.cell[1], strict=True))
        if fits and (write.value is None or (write.value == fact.value) == fact.is_equal):
            self._adds(index, number)

    def _adds(self, index: int, number: int) -> None:
        adds = self.operators[index].adds
        if number not in adds:
            adds.append(number)

    def destroyed(self, index: int) -> list[int]:
        """The facts that an operator makes false for certain."""
        return [
            number
            for write in self.operators[index].writes
            if write.is_certain and write.value is not None
            for number in self._by_cell.get((write.feature, write.arguments), ())
            if number not in self.operators[index].adds
            and number not in self.operators[index].claims
        ]

    def true_facts(self, state: Snapshot) -> Iterator[int]:
        """The facts that are true in a state."""
        delta, base = state.delta, state.base
        for number, cell, value, is_equal, unset in self.cells:
            own = delta[cell] if cell in delta else base.get(cell, unset)
            if (own == value) == is_equal:
                yield number
        for number, fact in self.opaque:
            try:
                if fact.holds(state, fact.values):
                    yield number
            except EvaluationError:
                pass

    def is_true(self, number: int, state: Snapshot) -> bool:
        """Whether one fact is true in a state."""
        match self.facts[number]:
            case CellFact(cell=cell, value=value, is_equal=is_equal):
                unset = self.defaults[cell[0]]
                own = state.delta[cell] if cell in state.delta else state.base.get(cell, unset)
                return bool((own == value) == is_equal)
            case OpaqueFact(holds=holds, values=values):
                try:
                    return bool(holds(state, values))
                except EvaluationError:
                    return False
            case _:
                return False


Needs = tuple[int, ...] | None
"""Facts that are all needed; None where that is impossible."""

Achievers = Callable[[Any], Any]
