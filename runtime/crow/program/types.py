"""The types of CDL values (language.md §2, Appendix D.2).

Object types are nominal and quantifiable; every other type is a value type. A value `typedef` is
nominal as well but converts to and from its base.
"""

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True, slots=True)
class ObjectType:
    """A type of objects: the only types that quantifiers and `foreach` range over."""

    name: str

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True, slots=True)
class Primitive:
    """`bool`, `int32`, `int64`, `float32`, `float64`, `string` or `pyobject`."""

    name: str

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True, slots=True)
class VectorType:
    """`vector[element, length]`; a length of None is fixed only when the program runs."""

    element: "Type"
    length: int | None

    def __str__(self) -> str:
        return (
            f"vector[{self.element}]"
            if self.length is None
            else f"vector[{self.element}, {self.length}]"
        )


@dataclass(frozen=True, slots=True)
class ListType:
    """`T[]`, a list of values of one type."""

    element: "Type"

    def __str__(self) -> str:
        return f"{self.element}[]"


@dataclass(frozen=True, slots=True)
class NamedType:
    """A value `typedef`: nominal, with the type it stands for."""

    name: str
    base: "Type"

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True, slots=True)
class UnknownType:
    """The type of an expression in error: compatible with everything, in no checked program."""

    def __str__(self) -> str:
        return "?"


Type = ObjectType | Primitive | VectorType | ListType | NamedType | UnknownType

OBJECT: Final = ObjectType("object")
BOOL: Final = Primitive("bool")
INT32: Final = Primitive("int32")
INT64: Final = Primitive("int64")
FLOAT32: Final = Primitive("float32")
FLOAT64: Final = Primitive("float64")
STRING: Final = Primitive("string")
PYOBJECT: Final = Primitive("pyobject")
UNKNOWN: Final = UnknownType()

PRIMITIVES: Final = {t.name: t for t in (BOOL, INT32, INT64, FLOAT32, FLOAT64, STRING, PYOBJECT)}

_WIDENING: Final = (INT32, INT64, FLOAT32, FLOAT64)


def underlying(type_: Type) -> Type:
    """The type with every value `typedef` on its outside unfolded."""
    while isinstance(type_, NamedType):
        type_ = type_.base
    return type_


def is_opaque(type_: Type) -> bool:
    """Whether values of a type are passed on as they are, be they tuples of numbers or not."""
    plain = underlying(type_)
    while isinstance(plain, ListType):
        plain = underlying(plain.element)
    return isinstance(plain, ObjectType) or plain == PYOBJECT


def is_object(type_: Type) -> bool:
    """Whether values of the type are objects of the problem."""
    return isinstance(type_, ObjectType)


def is_boolean(type_: Type) -> bool:
    """Whether the type is `bool` under its typedefs; true of an unknown type too."""
    return underlying(type_) in (BOOL, UNKNOWN)


def is_integer(type_: Type) -> bool:
    """Whether the type is an integer under its typedefs."""
    return underlying(type_) in (INT32, INT64)


def is_number(type_: Type) -> bool:
    """Whether the type is an integer or float under its typedefs."""
    return underlying(type_) in _WIDENING


def wider_number(left: Type, right: Type) -> Type:
    """The type of an arithmetic result: the later of the two in int32, int64, float32, float64."""
    return max(underlying(left), underlying(right), key=_rank)


def promotes(source: Type, target: Type) -> bool:
    """Whether a number of type `source` may stand where `target` is wanted: int to float only.

    Widths convert freely within a kind: a value outside the width is an error when it is stored.
    """
    if is_integer(target):
        return is_integer(source)
    return is_number(source) and is_number(target)


def _rank(type_: Type) -> int:
    return next(rank for rank, number in enumerate(_WIDENING) if number == type_)
