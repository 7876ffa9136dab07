"""Which behaviors an `achieve` can be refined by (semantics.md §2, unification).

The question here is whether a goal *could* match for some run-time objects; the runtime decides it
for the objects at hand.
"""

from typing import Final

from crow.program import (
    BOOL,
    Apply,
    Compare,
    Constant,
    Expression,
    Hierarchy,
    Not,
    Object,
    ObjectType,
    Read,
    Variable,
)

MIRRORED: Final = {"==": "==", "!=": "!=", "<": ">", "<=": ">=", ">": "<", ">=": "<="}
NEGATED: Final = {"==": "!=", "!=": "==", "<": ">=", "<=": ">", ">": "<=", ">=": "<"}


def may_match(goal: Expression, wanted: Expression, hierarchy: Hierarchy) -> bool:
    """Whether a behavior's goal can unify with a literal, equation or comparison."""
    match _plain(goal), _plain(wanted):
        case Not(operand=left), Not(operand=right):
            return _terms_match(left, right, hierarchy)
        case (Read() | Apply()) as left, (Read() | Apply()) as right:
            return _terms_match(left, right, hierarchy)
        case Compare() as left, Compare() as right:
            return _comparisons_match(left, right, hierarchy)
        case _:
            return False


def _plain(condition: Expression) -> Expression:
    """A comparison with a truth value as a literal, and a negated comparison as its opposite."""
    match condition:
        case Compare(operator="==" | "!=" as op, left=left, right=Constant(value=bool(value))):
            return left if value == (op == "==") else Not(left)
        case Compare(operator="==" | "!=" as op, left=Constant(value=bool(value)), right=right):
            return right if value == (op == "==") else Not(right)
        case Not(operand=Compare(operator=op, left=left, right=right)):
            return Compare(NEGATED[op], left, right)  # type: ignore[arg-type]
        case _:
            return condition


def _comparisons_match(goal: Compare, wanted: Compare, hierarchy: Hierarchy) -> bool:
    straight = goal.operator == wanted.operator
    mirrored = goal.operator == MIRRORED[wanted.operator]
    return (
        straight
        and _terms_match(goal.left, wanted.left, hierarchy)
        and _terms_match(goal.right, wanted.right, hierarchy)
    ) or (
        mirrored
        and _terms_match(goal.left, wanted.right, hierarchy)
        and _terms_match(goal.right, wanted.left, hierarchy)
    )


def _terms_match(goal: Expression, wanted: Expression, hierarchy: Hierarchy) -> bool:
    match goal, wanted:
        case Read(feature=name, arguments=left), Read(feature=other, arguments=right):
            pass
        case Apply(function=name, arguments=left), Apply(function=other, arguments=right):
            pass
        case (Read() | Apply(), _):
            return False
        case _:
            return _may_be_equal(goal, wanted, hierarchy)
    pairs = zip(left, right, strict=True)
    return name == other and all(_may_be_equal(a, b, hierarchy) for a, b in pairs)


def _may_be_equal(goal: Expression, wanted: Expression, hierarchy: Hierarchy) -> bool:
    """Whether an argument of a goal, a parameter or constant, can stand for an expression."""
    match goal, wanted:
        case (Object(name=name), Object(name=other)):
            return name == other
        case (Constant(), Constant()):
            return goal == wanted or (goal.type != BOOL and goal.value == wanted.value)
        case (Variable() | Object(), _) if isinstance(goal.type, ObjectType):
            return hierarchy.may_share_objects(goal.type, wanted.type)
        case _:
            return True
