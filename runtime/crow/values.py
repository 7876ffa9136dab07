"""Values of features and variables, and how they are stored and shown.

Objects are their names. Vectors are tuples of numbers. Opaque Python values stand for themselves.
"""

import struct
from typing import Any

from crow.program import FLOAT32, INT32, INT64, ListType, ObjectType, Type, VectorType
from crow.program.types import BOOL, is_number, underlying
from crow.unknowns import Unknown, kept

Value = Any
"""A bool, int, float, string, object name, tuple of numbers, or opaque Python value."""

_WIDTHS: dict[Type, int] = {INT32: 32, INT64: 64}


class Opaque:
    """A Python value that cannot be hashed, or is None: inside, it stands for that one object.

    It equals the value itself, and nothing else that looks like it.
    """

    __slots__ = ("value",)
    __array_ufunc__ = None  # numpy leaves `==` to this class

    def __init__(self, value: object) -> None:
        self.value = value

    def __eq__(self, other: object) -> bool:
        return self.value is (other.value if isinstance(other, Opaque) else other)

    def __hash__(self) -> int:
        return id(self.value)

    def __repr__(self) -> str:
        return " ".join(repr(self.value).split())


def given_out(value: Value) -> Value:
    """A value as the user's Python gets it."""
    return value.value if isinstance(value, Opaque) else value


def json_value(value: Value) -> object:
    """A value as documents have it: a vector as a list, an opaque value as its `repr`, marked."""
    match value:
        case None | bool() | int() | float() | str():
            return value
        case tuple():
            return [json_value(item) for item in value]
        case _:
            return {"opaque": " ".join(repr(value).split())}


class ValueRangeError(ArithmeticError):
    """A number that its type does not hold."""


def default_value(type_: Type) -> Value | None:
    """What a feature holds when `init` does not set it; None where it has to be set."""
    if underlying(type_) == BOOL:
        return False
    if is_number(type_):
        return 0.0 if underlying(type_) not in _WIDTHS else 0
    return None


def converted(value: Value, type_: Type) -> Value:
    """A value as an expression of that type has it: integers within their width, floats as double.

    Raises ValueRangeError for a number, or a vector, that the type does not hold, and Touched for
    an unknown whose value may change by it.
    """
    if isinstance(type_, ObjectType) or isinstance(value, bool):
        return value  # mostly
    if type(value) is Unknown:
        return kept(value, type_)
    plain = underlying(type_)
    if plain in _WIDTHS:
        return _within(value, plain)
    match plain:
        case VectorType(element, length):
            if length is not None and length != len(value):
                raise ValueRangeError(f"a vector of {len(value)} elements is no `{plain}`")
            return tuple(converted(item, element) for item in value)
        case ListType(element):
            return tuple(converted(item, element) for item in value)
        case _:
            return float(value) if is_number(plain) else value


def stored(value: Value, type_: Type) -> Value:
    """A value as a cell of that type holds it: as `converted`, and float32 is rounded.

    Raises ValueRangeError for a number, or a vector, that the type does not hold.
    """
    if isinstance(type_, ObjectType) or isinstance(value, bool):
        return value  # mostly
    return _rounded(converted(value, type_), underlying(type_))


def _within(value: Value, type_: Type) -> Value:
    bound = 1 << (_WIDTHS[type_] - 1)
    if not isinstance(value, int) or not -bound <= value < bound:
        raise ValueRangeError(f"{value} does not fit into `{type_}`")
    return value


def _rounded(value: Value, type_: Type) -> Value:
    if type(value) is Unknown:
        return kept(value, type_, is_stored=True)
    match type_:
        case VectorType(element=element) | ListType(element=element):
            return tuple(_rounded(item, underlying(element)) for item in value)
        case _:
            return _as_float32(value) if type_ == FLOAT32 else value


def _as_float32(value: float) -> float:
    try:
        rounded: float = struct.unpack("<f", struct.pack("<f", value))[0]
    except OverflowError:
        raise ValueRangeError(f"{value} does not fit into `float32`") from None
    return rounded


def _escaped(character: str) -> str:
    if character in '"\\':
        return "\\" + character
    if character.isprintable():
        return character
    return character.encode("unicode_escape").decode("ascii")


def shown(value: Value, type_: Type) -> str:
    """A value as CDL writes it."""
    if isinstance(type_, ObjectType):
        return str(value)
    match value, underlying(type_):
        case ((bool() | int() | float()), _):
            return str(value)
        case str(), _:
            return '"' + "".join(map(_escaped, value)) + '"'
        case tuple(), VectorType(element=element) | ListType(element=element):
            return "[" + ", ".join(shown(item, element) for item in value) + "]"
        case tuple(), _:
            return "[" + ", ".join(str(item) for item in value) + "]"
        case _:
            return repr(value)
