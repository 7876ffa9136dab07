"""Values of features and variables, and how they are stored and shown.

Objects are their names. Vectors are tuples of numbers. Opaque Python values stand for themselves.
"""

import struct
from typing import Any

from crow.program import FLOAT32, INT32, INT64, ObjectType, Type, VectorType
from crow.program.types import BOOL, is_number, underlying

Value = Any
"""A bool, int, float, string, object name, tuple of numbers, or opaque Python value."""

_WIDTHS = {INT32: 32, INT64: 64}


class ValueRangeError(ArithmeticError):
    """A number that its type does not hold."""


def default_value(type_: Type) -> Value | None:
    """What a feature holds when `init` does not set it; None where it has to be set."""
    if underlying(type_) == BOOL:
        return False
    if is_number(type_):
        return 0.0 if underlying(type_) not in _WIDTHS else 0
    return None


def stored(value: Value, type_: Type) -> Value:
    """A value as a cell of that type holds it: float32 rounded, integers within their width.

    Raises ValueRangeError for a number that does not fit.
    """
    plain = underlying(type_)
    if plain in _WIDTHS:
        bound = 1 << (_WIDTHS[plain] - 1)
        if not -bound <= value < bound:
            raise ValueRangeError(f"{value} does not fit into `{plain}`")
        return value
    if plain == FLOAT32:
        return _as_float32(value)
    if isinstance(plain, VectorType):
        return tuple(stored(item, plain.element) for item in value)
    return float(value) if is_number(plain) else value


def _as_float32(value: float) -> float:
    try:
        rounded: float = struct.unpack("f", struct.pack("f", value))[0]
    except OverflowError:
        raise ValueRangeError(f"{value} does not fit into `float32`") from None
    return rounded


def shown(value: Value, type_: Type) -> str:
    """A value as CDL writes it."""
    if isinstance(type_, ObjectType):
        return str(value)
    match value:
        case bool() | int() | float():
            return str(value)
        case str():
            return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
        case tuple():
            return "[" + ", ".join(str(item) for item in value) + "]"
        case _:
            return repr(value)
