"""How figures grow: least squares in logarithms, with how much of the variance they explain."""

from collections.abc import Sequence
from math import exp, log
from statistics import correlation, linear_regression
from typing import NamedTuple


class Fit(NamedTuple):
    """The parameter of a fitted curve, and its R²."""

    value: float
    quality: float


def power(sizes: Sequence[float], figures: Sequence[float]) -> Fit:
    """The b of figure = a · size^b. Both are positive."""
    return _line([log(x) for x in sizes], [log(y) for y in figures])


def exponential(sizes: Sequence[float], figures: Sequence[float]) -> Fit:
    """The b of figure = a · b^size. Figures are positive."""
    slope, quality = _line(sizes, [log(y) for y in figures])
    return Fit(exp(slope), quality)


def _line(xs: Sequence[float], ys: Sequence[float]) -> Fit:
    return Fit(linear_regression(xs, ys).slope, correlation(xs, ys) ** 2)
