"""Sums of features with constant factors, computed exactly."""

import struct
from dataclasses import dataclass
from fractions import Fraction

from crow.program import FLOAT32, Arithmetic, Constant, Expression, Negative, Read, Type
from crow.program.types import underlying


@dataclass(frozen=True, slots=True)
class Linear:
    """`constant` and the sum of `factor * read` over its terms."""

    constant: Fraction
    terms: tuple[tuple[Read, Fraction], ...] = ()

    @staticmethod
    def of(constant: int | Fraction) -> "Linear":
        """A number."""
        return Linear(Fraction(constant))

    def plus(self, other: "Linear", factor: Fraction = Fraction(1)) -> "Linear":
        """The sum with a multiple of another one."""
        factors = {id(read): (read, own) for read, own in self.terms}
        for read, own in other.terms:
            _, before = factors.get(id(read), (read, Fraction(0)))
            factors[id(read)] = (read, before + factor * own)
        kept = tuple((read, own) for read, own in factors.values() if own)
        return Linear(self.constant + factor * other.constant, kept)

    def factor_of(self, feature: str) -> Fraction:
        """The factor of a feature, over all its cells."""
        return sum((f for read, f in self.terms if read.feature == feature), Fraction(0))

    def without(self, feature: str) -> "Linear":
        """The sum without the cells of a feature."""
        return Linear(self.constant, tuple(t for t in self.terms if t[0].feature != feature))


def linear(node: Expression) -> Linear | None:
    """A number as a sum, or None for one that is none."""
    match node:
        case Constant(value=int() | float() as value):
            return Linear.of(Fraction(str(value)))
        case Read():
            return Linear(Fraction(0), ((node, Fraction(1)),))
        case Negative(operand=operand):
            inner = linear(operand)
            return None if inner is None else Linear.of(0).plus(inner, Fraction(-1))
        case Arithmetic(operator="+" | "-" | "*" | "/" as operator, left=left, right=right):
            sides = linear(left), linear(right)
            return None if None in sides else _combined(operator, *sides)  # type: ignore[arg-type]
        case _:
            return None


def _combined(operator: str, left: Linear, right: Linear) -> Linear | None:
    match operator:
        case "+":
            return left.plus(right)
        case "-":
            return left.plus(right, Fraction(-1))
        case "*" if not left.terms:
            return Linear.of(0).plus(right, left.constant)
        case "*" if not right.terms:
            return Linear.of(0).plus(left, right.constant)
        case "/" if not right.terms and right.constant:
            return Linear.of(0).plus(left, 1 / right.constant)
        case _:
            return None


def exact(value: object, type_: Type) -> Fraction:
    """A stored number as the decimal number a person wrote for it."""
    assert isinstance(value, int | float)
    if underlying(type_) == FLOAT32:
        for digits in range(1, 10):
            written = f"{value:.{digits}g}"
            if struct.unpack("<f", struct.pack("<f", float(written)))[0] == value:
                return Fraction(written)
    return Fraction(str(value))
