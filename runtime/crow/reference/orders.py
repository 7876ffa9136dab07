"""Partially ordered programs: nested sequences and unordered sets (App. A)."""

from collections.abc import Iterator
from dataclasses import dataclass
from operator import is_
from typing import Any


@dataclass(frozen=True, slots=True, eq=False)
class Leaf:
    """One statement; each occurrence is a leaf of its own."""

    content: Any


@dataclass(frozen=True, slots=True, eq=False)
class Sequence:
    """Parts that follow one another."""

    parts: "tuple[Order, ...]" = ()


@dataclass(frozen=True, slots=True, eq=False)
class Unordered:
    """Parts in any order."""

    parts: "tuple[Order, ...]" = ()


Order = Leaf | Sequence | Unordered

EMPTY = Sequence()


def is_empty(order: Order) -> bool:
    """Whether no statement is left."""
    return not isinstance(order, Leaf) and all(map(is_empty, order.parts))


def tail(order: Order) -> Iterator[Leaf]:
    """The statements that may be the last one (the tail operator of App. A)."""
    match order:
        case Leaf():
            yield order
        case Sequence(parts=parts):
            filled = [part for part in parts if not is_empty(part)]
            if filled:
                yield from tail(filled[-1])
        case Unordered(parts=parts):
            for part in parts:
                yield from tail(part)


def without(order: Order, leaf: Leaf) -> Order:
    """The order with one statement taken out, and with it what is empty."""
    if order is leaf:
        return EMPTY
    if isinstance(order, Leaf):
        return order
    parts = [without(part, leaf) for part in order.parts]
    filled = tuple(part for part in parts if isinstance(part, Leaf) or part.parts)
    if len(filled) == len(order.parts) and all(map(is_, filled, order.parts)):
        return order
    return type(order)(filled)


def leaves(order: Order) -> Iterator[Leaf]:
    """Every statement, in the order of the text."""
    if isinstance(order, Leaf):
        yield order
    else:
        for part in order.parts:
            yield from leaves(part)
