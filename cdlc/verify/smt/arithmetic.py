"""CDL's arithmetic in z3 (language.md §4): whole numbers exact, floats as real numbers."""

from fractions import Fraction
from typing import Any

import z3

from crow.program import INT32, Type
from crow.program.expressions import ArithmeticOperator
from crow.program.types import is_integer, underlying

# Powers with larger literal exponents stay uninterpreted.
LARGEST_EXPONENT = 16


def integer_range(type_: Type) -> tuple[int, int]:
    """The smallest and the largest number of an integer type."""
    bound = 1 << (31 if underlying(type_) == INT32 else 63)
    return -bound, bound - 1


def in_range(term: Any, type_: Type) -> Any:
    """That a whole number fits into a type."""
    low, high = integer_range(type_)
    return z3.And(low <= term, term <= high)


def real(value: float, ctx: Any) -> Any:
    """A literal as the exact value that a double has."""
    return z3.RealVal(str(Fraction(value)), ctx)


def widened(term: Any) -> Any:
    """A number as a real one."""
    return z3.ToReal(term) if z3.is_int(term) else term


def operation(op: ArithmeticOperator, left: Any, right: Any, type_: Type) -> Any:
    """`left op right` of a type; a division by zero has some value."""
    if not is_integer(type_):
        left, right = widened(left), widened(right)
    match op:
        case "+":
            return left + right
        case "-":
            return left - right
        case "*":
            return left * right
        case "/":
            return widened(left) / widened(right)
        case "//":
            return _floor(left, right)
        case "%":
            return _remainder(left, right)
        case "**":
            return _power(left, right)


def operation_is_defined(
    op: ArithmeticOperator, left: Any, right: Any, result: Any, type_: Type
) -> list[Any]:
    """What must hold for the interpreter to have a value for `left op right`."""
    conditions = []
    if op in ("/", "//", "%"):
        conditions.append(right != 0)
    if op == "**":
        negative = right >= 0 if is_integer(type_) else z3.Or(left != 0, right >= 0)
        conditions.append(negative)
    if is_integer(type_):
        conditions.append(in_range(result, type_))
    return conditions


def _floor(left: Any, right: Any) -> Any:
    """Python's `//`. z3's `div` rounds so that the remainder is not negative, so it is floor where
    the divisor is positive.
    """
    if not z3.is_int(left):
        return z3.ToReal(z3.ToInt(left / right))
    return z3.If(right > 0, left / right, (-left) / (-right))


def _remainder(left: Any, right: Any) -> Any:
    """Python's `%`, which has the sign of the divisor."""
    if not z3.is_int(left):
        return left - right * _floor(left, right)
    return z3.If(right > 0, left % right, -((-left) % (-right)))


def _power(left: Any, right: Any) -> Any:
    exponent = z3.simplify(right)
    if z3.is_int_value(exponent) or (z3.is_rational_value(exponent) and exponent.is_int()):
        number = exponent.as_long() if z3.is_int_value(exponent) else exponent.numerator_as_long()
        if 0 <= number <= LARGEST_EXPONENT:
            result = z3.IntVal(1, left.ctx) if z3.is_int(left) else z3.RealVal(1, left.ctx)
            for _ in range(number):
                result = result * left
            return result
    return z3.Function("**", left.sort(), right.sort(), left.sort())(left, right)
