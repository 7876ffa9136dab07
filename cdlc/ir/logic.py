"""Building formulas: constructors that fold what is plainly decided, and nothing more."""

from collections.abc import Iterable, Iterator

from crow.program import (
    BOOL,
    And,
    Compare,
    Conditional,
    Constant,
    Expression,
    Hierarchy,
    Not,
    Object,
    Or,
    Type,
    Variable,
)

TRUE = Constant(True, BOOL)  # noqa: FBT003 - a value
FALSE = Constant(False, BOOL)  # noqa: FBT003 - a value


def conjuncts(condition: Expression) -> Iterator[Expression]:
    """The parts of a conjunction, nested ones too; a true condition has none."""
    if isinstance(condition, And):
        for operand in condition.operands:
            yield from conjuncts(operand)
    elif condition != TRUE:
        yield condition


def conjunction(parts: Iterable[Expression]) -> Expression:
    """All of the parts, each once; false if one of them is."""
    kept = dict.fromkeys(part for whole in parts for part in conjuncts(whole))
    if FALSE in kept:
        return FALSE
    if len(kept) <= 1:
        return next(iter(kept), TRUE)
    return And(tuple(kept))


def disjunction(parts: Iterable[Expression]) -> Expression:
    """Any of the parts, each once; true if one of them is, or one and its negation."""
    kept: dict[Expression, None] = {}
    for whole in parts:
        for part in whole.operands if isinstance(whole, Or) else (whole,):
            if part != FALSE:
                kept[part] = None
    if TRUE in kept or any(negation(part) in kept for part in kept):
        return TRUE
    if len(kept) <= 1:
        return next(iter(kept), FALSE)
    return Or(tuple(kept))


def negation(condition: Expression) -> Expression:
    """The opposite of a condition, without double negation."""
    match condition:
        case Not(operand=operand):
            return operand
        case Constant(value=True):
            return FALSE
        case Constant(value=False):
            return TRUE
        case _:
            return Not(condition)


def equality(left: Expression, right: Expression, hierarchy: Hierarchy) -> Expression:
    """`left == right`, decided where the sides are the same or can never be."""
    if left == right:
        return TRUE
    match left, right:
        case (Object(), Object()) | (Constant(), Constant()):
            return FALSE
        case (Variable() | Object(), Variable() | Object()):
            if are_disjoint(left.type, right.type, hierarchy):
                return FALSE
        case _:
            pass
    return Compare("==", left, right)


def are_disjoint(left: Type, right: Type, hierarchy: Hierarchy) -> bool:
    """Whether no object can be of both types."""
    return not hierarchy.may_share_objects(left, right)


def choice(condition: Expression, then: Expression, otherwise: Expression) -> Expression:
    """`then if condition else otherwise`; as a formula where the values are Boolean constants."""
    if condition == TRUE or then == otherwise:
        return then
    if condition == FALSE:
        return otherwise
    if then == TRUE:
        return disjunction((condition, otherwise))
    if then == FALSE:
        return conjunction((negation(condition), otherwise))
    if otherwise == FALSE:
        return conjunction((condition, then))
    if otherwise == TRUE:
        return disjunction((negation(condition), then))
    return Conditional(condition, then, otherwise, then.type)
