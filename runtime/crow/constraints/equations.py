"""Equations with one unknown left, solved by the inverses of what is built in (App. B.1).

Solutions are those of algebra: a float is the nearest one, or a neighbour for which the equation is
true as it is computed.
"""

import math
from collections.abc import Callable, Iterable, Iterator
from fractions import Fraction

from crow.constraints.terms import Ground, Open, is_known, meaning
from crow.program import FLOAT32, ListType, VectorType
from crow.program.types import Type, is_integer, is_number, underlying
from crow.unknowns import Unknown
from crow.values import Value

Test = Callable[[Value], bool]
"""Whether an equation is true with a value for its unknown."""


def solved(
    left: Ground, right: Ground, unknown: Unknown, is_true: Test
) -> tuple[Value, ...] | None:
    """The value of the one unknown of `left == right`: one, or none where there is none.

    None where it cannot be told without trying: the unknown is an argument of a function, or any
    value will do. `is_true` computes the equation.
    """
    candidates = _candidates(left, right, unknown)
    if candidates is None:
        return None
    for candidate in candidates:
        for value in _near(candidate, unknown.type):
            if is_true(value):
                return (value,)
    return ()


def repaired(candidate: Value, per_element: Callable[[int, Value], bool]) -> Value:
    """A vector, each element moved to a neighbour for which its part of the equation is true."""
    found = list(candidate)
    for index, element in enumerate(candidate):
        tried = _neighbours(element) if isinstance(element, float) else iter((element,))
        found[index] = next((e for e in tried if per_element(index, e)), element)
    return tuple(found)


def _candidates(left: Ground, right: Ground, unknown: Unknown) -> Iterable[Value] | None:
    for term, value in ((left, right), (right, left)):
        if is_known(value):
            found = _isolated(term, value)
            if found is not None:
                return _of_shape(found, unknown.type)
    if not is_number(unknown.type):
        return None
    return _linear_solution(left, right)


def _of_shape(candidates: tuple[Value, ...], type_: Type) -> tuple[Value, ...]:
    """What a vector says of an unknown number: that of each of its elements."""
    if isinstance(underlying(type_), VectorType | ListType):
        return candidates
    spread = [c if isinstance(c, tuple) else (c,) for c in candidates]
    return tuple({element: None for elements in spread for element in elements})


def _near(candidate: Value, type_: Type) -> Iterator[Value]:
    if is_integer(type_):
        if math.isfinite(candidate) and candidate == int(candidate):
            yield int(candidate)
    elif is_number(type_):
        yield from _neighbours(float(candidate)) if math.isfinite(candidate) else ()
    else:
        yield candidate


def _neighbours(value: float) -> Iterator[float]:
    """A float and those next to it, nearest first."""
    yield value
    above = below = value
    for _ in range(2):
        above, below = math.nextafter(above, math.inf), math.nextafter(below, -math.inf)
        yield above
        yield below


# --------------------------------------------------------------------------------------- inverses


def _isolated(term: Ground, value: Value) -> tuple[Value, ...] | None:
    """What the unknown must be for a term to have a value; None where that is not one value."""
    while type(term := meaning(term)) is Open:
        found = _inverted(term, value)
        if not isinstance(found, _Step):
            return found
        term, value = found
    return (value,)


class _Step(tuple[Ground, Value]):
    __slots__ = ()


def _inverted(term: Open, value: Value) -> _Step | tuple[()] | None:
    """The operand with the unknown, and what it must be; () where nothing will do."""
    match term.operator, term.operands:
        case "negative", (inner,):
            return _Step((inner, _each(lambda v, _: -v, value, 0)))
        case "convert", (inner,):
            return _Step((inner, value))
        case "store", (inner,) if not _is_rounded(term.type):
            return _Step((inner, value))
        case ("+" | "-" | "*" | "/") as op, (left, right) if is_known(left) != is_known(right):
            inner, known = (right, left) if is_known(left) else (left, right)
            inverse = _INVERSES[op, is_known(left)]
            try:
                return _Step((inner, _each(inverse, value, known)))
            except ZeroDivisionError:
                # 0 * x == 0 and 0 / x == 0 are true of any value, or almost any.
                return None if _is_zero(value) and (op == "*" or _is_zero(known)) else ()
            except (OverflowError, ValueError):
                return ()
        case _:
            return None


def _divided(left: Value, right: Value) -> Value:
    if isinstance(left, int) and isinstance(right, int) and right and left % right == 0:
        return left // right
    return left / right


_INVERSES: dict[tuple[str, bool], Callable[[Value, Value], Value]] = {
    ("+", False): lambda v, k: v - k,
    ("+", True): lambda v, k: v - k,
    ("-", False): lambda v, k: v + k,
    ("-", True): lambda v, k: k - v,
    ("*", False): _divided,
    ("*", True): _divided,
    ("/", False): lambda v, k: v * k,
    ("/", True): lambda v, k: _divided(k, v),
}
"""By operator, and whether it is the left operand that is known."""


def _each(function: Callable[[Value, Value], Value], left: Value, right: Value) -> Value:
    """A function of numbers on vectors, element by element. Raises ValueError for unequal ones."""
    if isinstance(left, tuple) and isinstance(right, tuple):
        return tuple(_each(function, a, b) for a, b in zip(left, right, strict=True))
    if isinstance(left, tuple):
        return tuple(_each(function, a, right) for a in left)
    if isinstance(right, tuple):
        return tuple(_each(function, left, b) for b in right)
    return function(left, right)


def _is_zero(value: Value) -> bool:
    return all(map(_is_zero, value)) if isinstance(value, tuple) else value == 0


def _is_rounded(type_: Type) -> bool:
    plain = underlying(type_)
    if isinstance(plain, VectorType | ListType):
        return _is_rounded(plain.element)
    return plain == FLOAT32


# ----------------------------------------------------------------------------------------- linear


def _linear_solution(left: Ground, right: Ground) -> tuple[Value, ...] | None:
    """The solution of an equation in which the unknown occurs more than once."""
    first, second = _linear(left), _linear(right)
    if first is None or second is None:
        return None
    (a, b), (c, d) = first, second
    if a == c:
        return None if b == d else ()
    found = (d - b) / (a - c)
    if found.denominator == 1:
        return (found.numerator,)
    try:
        return (float(found),)
    except OverflowError:
        return ()


def _linear(ground: Ground) -> tuple[Fraction, Fraction] | None:
    """A term as `a * unknown + b`, if it is of that form."""
    ground = meaning(ground)
    if type(ground) is Unknown:
        return Fraction(1), Fraction(0)
    if isinstance(ground, int | float) and not isinstance(ground, bool):
        return Fraction(0), Fraction(ground)
    if type(ground) is not Open:
        return None
    inner = [_linear(operand) for operand in ground.operands]
    known = [pair for pair in inner if pair is not None]
    return _combined(ground.operator, known) if len(known) == len(inner) else None


def _combined(
    operator: str, sides: list[tuple[Fraction, Fraction]]
) -> tuple[Fraction, Fraction] | None:
    match operator, sides:
        case "convert", [side]:
            return side
        case "negative", [(a, b)]:
            return -a, -b
        case "+", [(a, b), (c, d)]:
            return a + c, b + d
        case "-", [(a, b), (c, d)]:
            return a - c, b - d
        case "*", [(a, b), (c, d)] if not a or not c:
            return a * d + b * c, b * d
        case "/", [(a, b), (c, d)] if not c and d:
            return a / d, b / d
        case _:
            return None
