"""Arithmetic on numbers and vectors (language.md §4): integers exact, floats as doubles."""

import math
import operator
from collections.abc import Callable, Mapping

from crow.program import FLOAT64, Type, VectorType
from crow.program.expressions import ArithmeticOperator
from crow.program.types import is_integer, underlying
from crow.values import Value, ValueRangeError, converted

_FUNCTIONS: Mapping[str, Callable[[Value, Value], Value]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "//": operator.floordiv,
    "%": operator.mod,
    "**": operator.pow,
}
# No power of an integer but 0, 1 and -1 beyond this one fits into any type.
_LARGEST_EXPONENT = 64


def arithmetic(op: ArithmeticOperator, left: Value, right: Value, type_: Type) -> Value:
    """`left op right` as a value of a type; on vectors element by element.

    Raises ArithmeticError, with a message for people, for a division by zero and for a result that
    the type does not hold.
    """
    match left, right:
        case tuple(), tuple():
            if len(left) != len(right):
                message = f"one vector has {len(left)} elements, the other {len(right)}"
                raise ArithmeticError(message)
            pairs = list(zip(left, right, strict=True))
        case tuple(), _:
            pairs = [(element, right) for element in left]
        case _, tuple():
            pairs = [(left, element) for element in right]
        case _:
            return _on_numbers(op, left, right, type_)
    return tuple(_on_numbers(op, a, b, _element(type_)) for a, b in pairs)


def negated(value: Value, type_: Type) -> Value:
    """`-value`. Raises ArithmeticError for the integer whose opposite does not fit."""
    if isinstance(value, tuple):
        return tuple(negated(element, _element(type_)) for element in value)
    return converted(-value, type_)


def _element(type_: Type) -> Type:
    plain = underlying(type_)
    return plain.element if isinstance(plain, VectorType) else FLOAT64


def _on_numbers(op: ArithmeticOperator, left: Value, right: Value, type_: Type) -> Value:
    if right == 0 and op in ("/", "//", "%"):
        raise ArithmeticError("division by zero")
    if op == "**":
        return _power(left, right, type_)
    if is_integer(type_):
        return converted(_FUNCTIONS[op](left, right), type_)
    return _real(_FUNCTIONS[op](float(left), float(right)))


def _power(base: Value, exponent: Value, type_: Type) -> Value:
    if base == 0 and exponent < 0:
        raise ArithmeticError("division by zero")
    if not is_integer(type_):
        try:
            return _real(float(base) ** float(exponent))
        except OverflowError:
            raise ArithmeticError("the result is too large") from None
    if exponent < 0:
        raise ArithmeticError("a negative power of an integer is no integer")
    if abs(base) <= 1:
        exponent = min(exponent, 2 - exponent % 2)  # same parity, and 0 stays 0
    elif exponent > _LARGEST_EXPONENT:
        raise ValueRangeError(f"{base} ** {exponent} does not fit into `{underlying(type_)}`")
    return converted(base**exponent, type_)


def _real(value: Value) -> Value:
    if isinstance(value, complex) or math.isnan(value):
        raise ArithmeticError("the result is not a real number")
    if math.isinf(value):
        raise ArithmeticError("the result is too large")
    return value
