"""Building formulas: constructors that fold what is plainly decided, and nothing more."""

from collections.abc import Iterable, Iterator, Mapping

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
    Quantified,
    Read,
    Type,
    Variable,
    Xor,
)
from crow.program.types import is_boolean, is_object

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
    """All of the parts, each once; false if one of them is, or one and its negation."""
    kept = dict.fromkeys(part for whole in parts for part in conjuncts(whole))
    if FALSE in kept or any(negation(part) in kept for part in kept):
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
        case (Constant(value=a), Constant(value=b)):
            return TRUE if a == b else FALSE
        case (Object(name=a), Object(name=b)):
            return TRUE if a == b else FALSE
        case _:
            pass
    are_objects = is_object(left.type) and is_object(right.type)
    if are_objects and are_disjoint(left.type, right.type, hierarchy):
        return FALSE
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


def folded(node: Expression, hierarchy: Hierarchy) -> Expression:
    """A node built anew from its operands by the constructors here; other nodes stay."""
    match node:
        case And(operands=operands):
            return conjunction(operands)
        case Or(operands=operands):
            return disjunction(operands)
        case Not(operand=operand):
            return negation(operand)
        case Xor(left=left, right=right) if TRUE in (left, right) or FALSE in (left, right):
            return choice(left, negation(right), right)
        case Conditional(condition=condition, then=then, otherwise=otherwise):
            return choice(condition, then, otherwise)
        case Compare(operator="==", left=left, right=right):
            same = equality(left, right, hierarchy)
            return same if isinstance(same, Constant) else node
        case Compare(operator="!=", left=left, right=right):
            same = equality(left, right, hierarchy)
            return negation(same) if isinstance(same, Constant) else node
        case Quantified(quantifier="forall", body=body) if body == TRUE:
            return TRUE
        case Quantified(quantifier="exists", body=body) if body == FALSE:
            return FALSE
        case _:
            return node


# ------------------------------------------------------------------------------------ implication

_MOST_CASES = 1000


def follows(
    premises: Iterable[Expression], conclusion: Expression, hierarchy: Hierarchy
) -> bool | None:
    """Whether a conclusion is true whenever the premises are, their atoms taken as independent.

    None when that cannot tell: with an atom that is no Boolean read and no equality of objects, or
    with too many cases.
    """
    question = conjunction((*premises, negation(conclusion)))
    if _is_refuted(_decided(question, {}, hierarchy), hierarchy, [_MOST_CASES]):
        return True
    atoms = _atoms(_decided(conclusion, {}, hierarchy))
    return False if all(map(_is_plain, atoms)) else None


def _is_refuted(formula: Expression, hierarchy: Hierarchy, left: list[int]) -> bool:
    """Whether a formula cannot be true, by cases on its atoms."""
    atom = next(_atoms(formula), None)
    left[0] -= 1
    if atom is None or left[0] < 0:
        return formula == FALSE
    return all(
        _is_refuted(_decided(formula, {atom: value}, hierarchy), hierarchy, left)
        for value in (TRUE, FALSE)
    )


def _decided(
    formula: Expression, values: Mapping[Expression, Expression], hierarchy: Hierarchy
) -> Expression:
    """The formula folded, with the atoms in `values` replaced; quantified parts are atoms."""

    def decided(part: Expression) -> Expression:
        return _decided(part, values, hierarchy)

    match formula:
        case Not(operand=operand):
            return negation(decided(operand))
        case And(operands=operands):
            return conjunction(map(decided, operands))
        case Or(operands=operands):
            return disjunction(map(decided, operands))
        case Xor(left=left, right=right):
            return choice(decided(left), negation(decided(right)), decided(right))
        case Conditional(condition=condition, then=then, otherwise=otherwise):
            return choice(decided(condition), decided(then), decided(otherwise))
        case Compare(operator="!=", left=left, right=right):
            return negation(decided(Compare("==", left, right)))
        case Compare(operator="==", left=left, right=right) if is_boolean(left.type):
            return choice(decided(left), decided(right), negation(decided(right)))
        case Compare(operator="==", left=left, right=right):
            turned = Compare("==", right, left)
            return values.get(formula, values.get(turned, equality(left, right, hierarchy)))
        case _:
            return values.get(formula, formula)


def _atoms(formula: Expression) -> Iterator[Expression]:
    """The parts of a formula that no connective makes up, first ones first."""
    match formula:
        case Constant():
            return
        case Not(operand=operand):
            yield from _atoms(operand)
        case And(operands=operands) | Or(operands=operands):
            for operand in operands:
                yield from _atoms(operand)
        case Conditional(condition=condition, then=then, otherwise=otherwise):
            for part in (condition, then, otherwise):
                yield from _atoms(part)
        case _:
            yield formula


def _is_plain(atom: Expression) -> bool:
    match atom:
        case Read(arguments=arguments):
            return all(isinstance(a, Variable | Object) for a in arguments)
        case Compare(operator="==" | "!=", left=Variable() | Object(), right=Variable() | Object()):
            return True
        case _:
            return False
