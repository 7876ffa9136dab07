"""Partially ordered programs: nested sequences and unordered sets (App. A).

`sequence` and `unordered` make them, and leave out what is empty; so only what has no parts is.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
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


def sequence(parts: Iterable[Order]) -> Order:
    """Parts that follow one another; those of a sequence among them take its place."""
    return _grouped(Sequence, parts)


def unordered(parts: Iterable[Order]) -> Order:
    """Parts in any order; those of a set among them take its place."""
    return _grouped(Unordered, parts)


def _grouped(kind: type[Sequence] | type[Unordered], parts: Iterable[Order]) -> Order:
    own: list[Order] = []
    for part in parts:
        if isinstance(part, kind):
            own.extend(part.parts)
        elif not is_empty(part):
            own.append(part)
    return own[0] if len(own) == 1 else kind(tuple(own))


def is_empty(order: Order) -> bool:
    """Whether no statement is left."""
    return not isinstance(order, Leaf) and not order.parts


def tail(order: Order) -> Iterator[tuple[Leaf, Order]]:
    """The statements that may be the last one, each with the rest (the tail operator of App. A)."""
    match order:
        case Leaf():
            yield order, EMPTY
        case Sequence(parts=(*before, last)):
            for leaf, rest in tail(last):
                yield leaf, sequence((*before, rest))
        case Unordered(parts=parts):
            for index, part in enumerate(parts):
                for leaf, rest in tail(part):
                    yield leaf, unordered((*parts[:index], rest, *parts[index + 1 :]))


def leaves(order: Order) -> Iterator[Leaf]:
    """Every statement, in the order of the text."""
    if isinstance(order, Leaf):
        yield order
    else:
        for part in order.parts:
            yield from leaves(part)
