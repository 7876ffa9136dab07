"""Which types operators take and what comes out (language.md §4)."""

from cdlc.frontend.scope import Declarations, are_related
from crow.program import (
    FLOAT64,
    UNKNOWN,
    ObjectType,
    Type,
    UnknownType,
    VectorType,
)
from crow.program.types import is_integer, is_number, underlying, wider_number


def arithmetic_type(operator: str, left: Type, right: Type, declared: Declarations) -> Type | None:
    """The type of a result: the wider number; element by element for vectors; None in error."""
    if isinstance(left, UnknownType) or isinstance(right, UnknownType):
        return UNKNOWN
    match underlying(left), underlying(right):
        case VectorType(), VectorType() if operator in "+-":
            return _sum_of_vectors(left, right, declared)
        case VectorType() as vector, scalar if operator in "*/" and is_number(scalar):
            return _scaled(left, vector, scalar, operator)
        case scalar, VectorType() as vector if operator == "*" and is_number(scalar):
            return _scaled(right, vector, scalar, operator)
        case a, b if is_number(a) and is_number(b):
            if operator in "+-%" and not are_related(left, right):
                return None
            if operator == "/" and is_integer(a) and is_integer(b):
                return FLOAT64
            return wider(left, right)
        case _:
            return None


def _sum_of_vectors(left: Type, right: Type, declared: Declarations) -> Type | None:
    """The type of a sum: where both would do, a typedef before a plain vector."""
    fits = declared.fits
    if fits(left, right) and (isinstance(left, VectorType) or not fits(right, left)):
        return right
    return left if fits(right, left) else None


def _scaled(type_: Type, vector: VectorType, scalar: Type, operator: str) -> Type:
    """The type of a vector times or divided by a number: integers may become floats."""
    if is_integer(vector.element) and (operator == "/" or not is_integer(scalar)):
        element = FLOAT64 if is_integer(scalar) else wider(vector.element, scalar)
        return VectorType(element, vector.length)
    return type_


def wider(left: Type, right: Type) -> Type:
    """The type of a number that is one of two types; unknown if either is."""
    if isinstance(left, UnknownType) or isinstance(right, UnknownType):
        return UNKNOWN
    return left if left == right else wider_number(left, right)


def is_arithmetic(type_: Type) -> bool:
    """Whether values of the type can be computed with."""
    return is_number(type_) or isinstance(underlying(type_), VectorType)


def are_comparable(operator: str, left: Type, right: Type, declared: Declarations) -> bool:
    """Whether an operator compares values of two types."""
    if isinstance(left, UnknownType) or isinstance(right, UnknownType):
        return True
    if is_number(left) and is_number(right):
        return are_related(left, right)
    if operator not in ("==", "!="):
        return False
    if isinstance(left, ObjectType) or isinstance(right, ObjectType):
        return declared.hierarchy.may_share_objects(left, right)
    return declared.fits(left, right) or declared.fits(right, left)


def common_type(left: Type, right: Type, declared: Declarations) -> Type | None:
    """The type that both branches of a conditional fit."""
    if is_number(left) and is_number(right):
        return wider(left, right) if are_related(left, right) else None
    if declared.fits(left, right):
        return right
    if declared.fits(right, left):
        return left
    if isinstance(left, ObjectType) and isinstance(right, ObjectType):
        hierarchy = declared.hierarchy
        others = hierarchy.ancestors(right.name)
        return ObjectType(next(a for a in hierarchy.ancestors(left.name) if a in others))
    return None
