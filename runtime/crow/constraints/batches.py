"""Many candidates tested at once: terms over columns of numbers (semantics.md §4).

A row that is kept may still be wrong, for what comes next tries it by itself; one that is left out
is wrong by the same arithmetic. What has no such form, or might round or overflow otherwise, is not
tested here.
"""

import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from crow.constraints.knowledge import Knowledge
from crow.constraints.store import Requirement, Store
from crow.constraints.terms import Ground, Open, is_known, parts
from crow.program.types import Type, is_integer, is_number, is_opaque
from crow.unknowns import Unknown
from crow.values import given_out

_EXACT: Final = float(1 << 52)
"""Integers below this are the same as floats."""

_OPERATIONS: Final[Mapping[str, Callable[[Any, Any], Any]]] = {
    "+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv,
    "<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge,
}  # fmt: skip


class NotVectorizedError(Exception):
    """A term that cannot be computed for many rows at once."""


class Columns:
    """Candidates for some unknowns, as arrays of numbers with a row for each."""

    def __init__(
        self, knowledge: Knowledge, values: Any, columns: Mapping[Unknown, Any], count: int
    ) -> None:
        self.knowledge = knowledge
        self.values = values
        self.columns = columns
        self.count = count

    def passing(self, term: Ground, is_wanted: bool) -> Any:
        """Which rows a requirement lets pass, as an array. Raises NotVectorizedError."""
        with np.errstate(all="ignore"):
            found = np.asarray(self._of(term))
        if found.dtype != np.bool_:
            raise NotVectorizedError
        return np.broadcast_to(found == is_wanted, (self.count,))

    def _of(self, ground: Ground) -> Any:
        """A ground as an array: numbers have no axis but that of rows, vectors one more."""
        if type(ground) is Unknown:
            column = self.columns.get(ground)
            return self._of_value(self.values.get(ground)) if column is None else _checked(column)
        if is_known(ground):
            return self._of_value(ground)
        if type(ground) is not Open:
            raise NotVectorizedError
        match ground.operator:
            case "named":
                return self._of(ground.operands[0])
            case "call":
                return self._called(ground)
            case "convert":
                return self._converted(ground)
            case "and" | "or" | "not" | "xor" | "if":
                return self._logical(ground)
            case _:
                return self._computed(ground, [_checked(self._of(o)) for o in ground.operands])

    def _of_value(self, value: object) -> Any:
        if isinstance(value, bool | int | float):
            return np.asarray(value)
        if isinstance(value, tuple):
            array = np.asarray(value)
            if array.ndim == 1 and array.dtype.kind in "bif":
                return array[None, :]
        raise NotVectorizedError

    def _logical(self, ground: Open) -> Any:
        match ground.operator, [self._of(operand) for operand in ground.operands]:
            case "not", [operand]:
                return ~operand
            case "xor", [left, right]:
                return left != right
            case "if", [condition, left, right]:
                left, right = _aligned(left, right)
                is_vector = left.ndim == 2 or right.ndim == 2
                return np.where(condition[..., None] if is_vector else condition, left, right)
            case "and", operands:
                return np.logical_and.reduce(np.broadcast_arrays(*operands))
            case _, operands:
                return np.logical_or.reduce(np.broadcast_arrays(*operands))

    def _computed(self, ground: Open, operands: list[Any]) -> Any:
        match ground.operator, operands:
            case ("==" | "!=") as op, [left, right]:
                left, right = _aligned(left, right)
                if left.ndim == 2 and left.shape[-1] != right.shape[-1]:
                    raise NotVectorizedError
                same = left == right
                same = same.all(axis=-1) if same.ndim == 2 else same
                return same if op == "==" else ~same
            case op, [left, right] if op in _OPERATIONS:
                return _checked(_OPERATIONS[op](*_aligned(*_multiplicable(op, left, right))))
            case "negative", [operand]:
                return -operand
            case "builtin", _:
                return self._chosen(ground.name, operands)
            case "vector", _:
                rows = [np.broadcast_to(o, (self.count,)) for o in operands if o.ndim < 2]
                if len(rows) == len(operands):
                    return np.stack(rows, axis=-1)
        raise NotVectorizedError

    def _chosen(self, name: str, operands: list[Any]) -> Any:
        if any(o.ndim == 2 for o in operands):
            raise NotVectorizedError
        if name == "abs":
            return abs(operands[0])
        function = np.minimum if name == "min" else np.maximum
        return function.reduce(np.broadcast_arrays(*operands))

    def _converted(self, ground: Open) -> Any:
        column = self._of(ground.operands[0])
        if is_number(ground.type) and not is_integer(ground.type):
            return _checked(column).astype(float)
        return column

    def _called(self, ground: Open) -> Any:
        function = self.knowledge.python.functions[ground.name]
        parameters = self.knowledge.world.functions[ground.name].parameters
        if not function.is_vectorized:
            raise NotVectorizedError
        pairs = zip(ground.operands, parameters, strict=False)
        arguments = [self._argument(operand, p.type) for operand, p in pairs]
        assert ground.cells is not None
        cells = self.knowledge.resolved(ground.cells, self.values)
        return np.asarray(function.column(cells, arguments, ground.location))

    def _argument(self, ground: Ground, type_: Type) -> Any:
        """A column for the user's Python, with as many rows as there are."""
        value = self.values.get(ground, ground) if type(ground) is Unknown else ground
        is_plain = isinstance(value, bool | int | float | tuple) and not is_opaque(type_)
        if is_known(value) and not is_plain:
            column = np.empty(self.count, dtype=object)
            for row in range(self.count):  # a tuple is one value, not a row of them
                column[row] = given_out(value)
            return column
        found = self._of(ground)
        return np.broadcast_to(found, (self.count, *found.shape[1:]))


def _aligned(left: Any, right: Any) -> tuple[Any, Any]:
    """Two arrays, of which one may have vectors and the other numbers."""
    if left.ndim < 2 and right.ndim == 2:
        left = left[..., None]
    elif right.ndim < 2 and left.ndim == 2:
        right = right[..., None]
    return left, right


def _checked(array: Any) -> Any:
    """Numbers that are exact as floats, and sums and products of which do not overflow."""
    if array.dtype.kind in "iu":
        if array.size and max(abs(int(array.max())), abs(int(array.min()))) >= _EXACT:
            raise NotVectorizedError
        if array.dtype != np.int64:
            return array.astype(np.int64)
    elif array.dtype.kind == "f" and array.dtype != np.float64:
        return array.astype(np.float64)
    return array


def _multiplicable(op: str, left: Any, right: Any) -> tuple[Any, Any]:
    """Factors whose product does not overflow."""
    are_integers = left.dtype.kind == right.dtype.kind == "i" and left.size and right.size
    if op == "*" and are_integers and _largest(left) * _largest(right) >= _EXACT:
        raise NotVectorizedError
    return left, right


def _largest(array: Any) -> float:
    return float(abs(array).max())


@dataclass(frozen=True, slots=True)
class Survivors:
    """Rows that may do, and how many rows each requirement has rejected."""

    rows: list[int]
    rejected: dict[Requirement, int]


def survivors(store: Store, columns: Mapping[Unknown, Any]) -> Survivors:
    """The rows of candidates that no requirement on them alone rejects."""
    count = len(next(iter(columns.values()))) if columns else 0
    arrays = {u: np.asarray(a) for u, a in columns.items()}
    own = {u: a for u, a in arrays.items() if a.dtype.kind in "bif"}
    rows = np.arange(count)
    rejected = {}
    for requirement in _decided(store, own):
        table = Columns(store.knowledge, store.values, own, len(rows))
        try:
            passing = table.passing(requirement.term, requirement.is_wanted)
        except NotVectorizedError:
            continue
        if not passing.all():
            rejected[requirement] = int(len(rows) - passing.sum())
            rows = rows[passing]
            own = {u: a[passing] for u, a in own.items()}
        if not len(rows):
            break
    return Survivors(rows.tolist(), rejected)


def _decided(store: Store, columns: Mapping[Unknown, Any]) -> list[Requirement]:
    """The requirements on candidates, with nothing else open, what Python computes last."""
    found = {
        requirement: None
        for unknown in columns
        for requirement in store.occurrences.get(unknown, ())
        if requirement in store.pending
        and all(u in columns or u in store.values for u in requirement.unknowns)
    }
    return sorted(found, key=_calls)


def _calls(requirement: Requirement) -> tuple[bool, int]:
    calls = (p for p in parts(requirement.term) if type(p) is Open and p.operator == "call")
    return any(calls), requirement.number
