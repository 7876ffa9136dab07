"""Variables without value yet (semantics.md §4), which stand where a value would.

An unknown can be passed on, kept in environments and cells, and found again by identity. Whatever
needs its value raises `Touched`, so that a computation stops exactly there.
"""

from collections.abc import Iterator, Mapping
from typing import NoReturn

from crow.program.types import (
    FLOAT32,
    FLOAT64,
    INT32,
    INT64,
    ListType,
    ObjectType,
    Type,
    VectorType,
    underlying,
)


class Touched(Exception):  # noqa: N818 - says where a computation has to wait
    """The value of an unknown was needed: `unknown` is which."""

    def __init__(self, unknown: "Unknown") -> None:
        super().__init__(f"the value of `{unknown.name}` is not known yet")
        self.unknown = unknown


class Unknown:
    """A variable of a type that has no value yet.

    `path` says which refinement made it, for people and for the random streams its values are drawn
    from: the same in each run, and another one for each unknown of a name (semantics.md §4).
    Compared and hashed by identity; comparing it with anything else raises Touched.
    """

    __slots__ = ("name", "path", "type")
    __array_ufunc__ = None  # numpy leaves operators to this class

    def __init__(self, name: str, type_: Type, path: str = "") -> None:
        self.name = name
        self.type = type_
        self.path = path

    def __repr__(self) -> str:
        return f"?{self.name}"

    __hash__ = object.__hash__

    def __eq__(self, other: object) -> bool:
        if other is self:
            return True
        raise Touched(self)

    def __ne__(self, other: object) -> bool:
        if other is self:
            return False
        raise Touched(self)

    def _touched(self, *_arguments: object) -> NoReturn:
        raise Touched(self)

    __lt__ = __le__ = __gt__ = __ge__ = _touched
    __bool__ = __int__ = __float__ = __index__ = __complex__ = __len__ = __iter__ = _touched
    __getitem__ = __contains__ = __call__ = _touched
    __neg__ = __pos__ = __abs__ = __invert__ = __round__ = __array__ = _touched
    __add__ = __sub__ = __mul__ = __truediv__ = __floordiv__ = __mod__ = __pow__ = _touched
    __radd__ = __rsub__ = __rmul__ = __rtruediv__ = __rfloordiv__ = __rmod__ = __rpow__ = _touched
    __and__ = __or__ = __xor__ = __rand__ = __ror__ = __rxor__ = __matmul__ = _touched


def is_same(left: object, right: object) -> bool:
    """Whether two values are equal, an unknown being equal to itself alone; raises nothing.

    For states and keys, where two unknowns are two things whatever values they will have.
    """
    if left is right:
        return True
    if isinstance(left, Unknown) or isinstance(right, Unknown):
        return False
    if isinstance(left, tuple) and isinstance(right, tuple):
        return len(left) == len(right) and all(map(is_same, left, right))
    return bool(left == right)


def unknowns_in(value: object) -> Iterator[Unknown]:
    """The unknowns that a value is or has among its elements, from left to right."""
    if isinstance(value, Unknown):
        yield value
    elif isinstance(value, tuple):
        for element in value:
            yield from unknowns_in(element)


def has_unknown(value: object) -> bool:
    """Whether a value is an unknown or has one among its elements."""
    if type(value) is Unknown:
        return True
    return type(value) is tuple and any(map(has_unknown, value))


def touch(value: object) -> None:
    """Raise Touched for what is an unknown or has one among its elements."""
    for unknown in unknowns_in(value):
        raise Touched(unknown)


def resolved(value: object, values: Mapping[Unknown, object]) -> object:
    """A value with the unknowns in it that have a value replaced by it."""
    if type(value) is Unknown:
        return values.get(value, value)
    if type(value) is tuple and has_unknown(value):
        return tuple(resolved(element, values) for element in value)
    return value


def kept(unknown: Unknown, type_: Type, *, is_stored: bool = False) -> Unknown:
    """An unknown where a value is converted to a type, or stored in a cell of it.

    Raises Touched where that may change the value: an integer becomes a float, a number may not fit
    into its width, a float is rounded.
    """
    if isinstance(type_, ObjectType) or _is_kept(unknown.type, type_, is_stored=is_stored):
        return unknown
    raise Touched(unknown)


def _is_kept(own: Type, wanted: Type, *, is_stored: bool) -> bool:
    own, wanted = underlying(own), underlying(wanted)
    match own, wanted:
        case VectorType(element=element), VectorType(element=other):
            is_long_enough = wanted.length in (None, own.length)
            return is_long_enough and _is_kept(element, other, is_stored=is_stored)
        case ListType(element=element), ListType(element=other):
            return _is_kept(element, other, is_stored=is_stored)
        case _:
            is_rounded = is_stored and wanted == FLOAT32
            return not is_rounded and (own == wanted or (own, wanted) in _INCLUDED)


# Each value of the first is the same value of the second. A float32 is rounded in cells alone.
_INCLUDED = ((INT32, INT64), (FLOAT32, FLOAT64), (FLOAT64, FLOAT32))
