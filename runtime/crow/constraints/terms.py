"""Expressions with everything known worked out: what is left are terms over unknowns.

A ground is a value, an unknown, a term (`Open`), or the failure of a computation. Failures are kept
until they are needed: what a condition guards is not computed where the condition is false.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any, Final

from crow.constraints.python import Cells
from crow.program import Location, Type
from crow.unknowns import Unknown, has_unknown
from crow.values import Value

Ground = Any
"""A value without unknowns in it, an Unknown, an Open or a Failed."""


@dataclass(frozen=True, slots=True, eq=False)
class Open:
    """An operation whose value depends on unknowns.

    `operator` is that of the language, or `and`, `or`, `not`, `xor`, `if`, `vector`, `builtin`,
    `convert`, `store`; or `call` (an external function: its arguments, then the unknowns of the
    cells it reads), `read` (a cell of an unknown object), `run` (a derived function that is no
    expression: its arguments, then an unknown it stopped at), and `named` (a derived function or
    cell that a generator may be for: its meaning, then its arguments). `is_partial`: it may fail.
    """

    operator: str
    operands: tuple[Ground, ...]
    type: Type
    location: Location | None = None
    name: str = ""
    cells: Cells | None = None
    is_partial: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Failed:
    """A computation that has no value, and why."""

    error: Exception


ARITHMETIC: Final = ("+", "-", "*", "/", "//", "%", "**")
_MAY_FAIL: Final = frozenset(
    (*ARITHMETIC, "negative", "builtin", "convert", "store", "run", "read")
)
_OPEN: Final = (Open, Unknown, Failed)


def is_known(ground: Ground) -> bool:
    """Whether a ground is a value."""
    return not isinstance(ground, _OPEN)


def is_partial(ground: Ground) -> bool:
    """Whether a ground may turn out to have no value."""
    return type(ground) is Failed or (type(ground) is Open and ground.is_partial)


def opened(
    operator: str,
    operands: tuple[Ground, ...],
    type_: Type,
    location: Location | None = None,
    name: str = "",
    cells: Cells | None = None,
) -> Open:
    """The term of an operation."""
    may_fail = operator in _MAY_FAIL or any(map(is_partial, operands))
    return Open(operator, operands, type_, location, name, cells, may_fail)


def parts(ground: Ground) -> Iterator[Ground]:
    """A ground and all within it, from left to right."""
    pending = [ground]
    while pending:
        part = pending.pop()
        yield part
        if type(part) is Open:
            pending.extend(reversed(part.operands))


def unknowns_of(ground: Ground) -> tuple[Unknown, ...]:
    """The unknowns in a ground, each once, from left to right."""
    return tuple({part: None for part in parts(ground) if type(part) is Unknown})


def is_late(ground: Ground) -> bool:
    """Whether what a ground depends on shows only as it is worked out."""
    return any(type(part) is Open and part.operator in ("read", "run") for part in parts(ground))


def meaning(ground: Ground) -> Ground:
    """A ground without the name that a generator may be for."""
    while type(ground) is Open and ground.operator == "named":
        ground = ground.operands[0]
    return ground


def first_failure(grounds: Iterable[Ground]) -> Failed | None:
    """The first of some grounds that has failed."""
    return next((g for g in grounds if type(g) is Failed), None)


def lifted(value: Value, type_: Type) -> Ground:
    """A value, perhaps with unknowns in it, as a ground."""
    if type(value) is tuple and has_unknown(value):
        from crow.program.types import UNKNOWN, underlying

        element = getattr(underlying(type_), "element", UNKNOWN)
        return opened("vector", tuple([lifted(v, element) for v in value]), type_)
    return value
