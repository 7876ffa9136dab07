"""How figures grow: least squares in logarithms."""

from collections.abc import Sequence
from math import exp, log
from statistics import linear_regression


def exponent(sizes: Sequence[float], figures: Sequence[float]) -> float:
    """The b of figure = a · size^b that fits best. Both are positive."""
    return linear_regression([log(x) for x in sizes], [log(y) for y in figures]).slope


def base(sizes: Sequence[float], figures: Sequence[float]) -> float:
    """The b of figure = a · b^size that fits best. Figures are positive."""
    return exp(linear_regression(sizes, [log(y) for y in figures]).slope)
