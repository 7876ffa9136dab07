"""Folding: what an expression comes to when only constants and identities are looked at."""

import operator
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from cdlc.ir.logic import FALSE, TRUE, choice, conjunction, disjunction, equality, negation
from crow.program import (
    BOOL,
    And,
    Compare,
    Conditional,
    Constant,
    Expression,
    Hierarchy,
    Negative,
    Not,
    Object,
    Or,
    Scalar,
    Variable,
    Xor,
)
from crow.program.rewrite import rewrite

_COMPARISONS: Mapping[str, Callable[[Any, Any], bool]] = {
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
}


def fold(
    expression: Expression,
    hierarchy: Hierarchy,
    known: Mapping[Expression, Expression] | None = None,
) -> Expression:
    """The expression with decided parts replaced; `known` gives values of parts as they stand.

    Nothing is reordered and no arithmetic is done, so the result reads like the source.
    """
    facts = known or {}

    def rule(node: Expression) -> Expression:
        folded = _folded(node, hierarchy)
        return facts.get(folded, folded)

    return rewrite(expression, rule)


def _folded(node: Expression, hierarchy: Hierarchy) -> Expression:
    match node:
        case And(operands=operands):
            return conjunction(operands)
        case Or(operands=operands):
            return disjunction(operands)
        case Not(operand=operand):
            return negation(operand)
        case Xor(left=left, right=right) if left == right:
            return FALSE
        case Xor(left=Constant(value=bool(a)), right=Constant(value=bool(b))):
            return truth(a is not b)
        case Compare():
            return _comparison(node, hierarchy)
        case Conditional(condition=condition, then=then, otherwise=otherwise):
            return choice(condition, then, otherwise)
        case Negative(operand=Constant(value=int() | float() as value)) if value is not True:
            return Constant(-value, node.type, location=node.location)
        case _:
            return node


def truth(value: bool) -> Expression:
    """The constant of a truth value."""
    return TRUE if value else FALSE


def _comparison(node: Compare, hierarchy: Hierarchy) -> Expression:
    left, right = node.left, node.right
    if node.operator in ("==", "!=") and left.type == BOOL and right in (TRUE, FALSE):
        return left if (right == TRUE) == (node.operator == "==") else negation(left)
    match left, right:
        case Constant(value=a), Constant(value=b) if _are_alike(a, b):
            return truth(_COMPARISONS[node.operator](a, b))
        case (Variable() | Object(), Variable() | Object()) if node.operator in ("==", "!="):
            same = equality(left, right, hierarchy)
            if same in (TRUE, FALSE):
                return same if node.operator == "==" else negation(same)
            return node
        case _ if left == right:
            return truth(node.operator in ("==", "<=", ">="))
        case Conditional(condition=condition, then=then, otherwise=otherwise), _:
            branches = (replace(node, left=then), replace(node, left=otherwise))
            return _branching(node, condition, branches, hierarchy)
        case _, Conditional(condition=condition, then=then, otherwise=otherwise):
            branches = (replace(node, right=then), replace(node, right=otherwise))
            return _branching(node, condition, branches, hierarchy)
        case _:
            return node


def _branching(
    node: Compare,
    condition: Expression,
    branches: tuple[Compare, Compare],
    hierarchy: Hierarchy,
) -> Expression:
    """A comparison with a conditional value, taken apart where that decides one of its branches."""
    then, otherwise = (_comparison(branch, hierarchy) for branch in branches)
    if {then, otherwise} & {TRUE, FALSE}:
        return choice(condition, then, otherwise)
    return node


def _are_alike(left: Scalar, right: Scalar) -> bool:
    numbers = isinstance(left, int | float) and isinstance(right, int | float)
    return numbers or type(left) is type(right)
