"""Which programs are imperative (semantics.md §5): nothing in them is left to search.

At most one behavior has a goal that is achieved, and no body that the goal of the problem comes to
has a promotable section, a bind, an assertion, an alternative, a commit or a compound condition to
achieve. Then there is one refinement, but for the order of unordered groups.
"""

from crow.conditions import Wanted, is_opaque, plain
from crow.problem import Problem
from crow.program import (
    Achieve,
    And,
    Apply,
    Assert,
    Behavior,
    Bind,
    Call,
    Commit,
    Compare,
    Expression,
    Group,
    Not,
    Or,
    Quantified,
    Read,
    Statement,
)
from crow.program.walk import statements_within
from crow.support import open_parameters

Key = tuple[frozenset[str], bool]
"""What a literal or comparison is about: names, and whether it is negated."""


def is_imperative(problem: Problem) -> bool:
    """Whether the program that achieves the goal of a problem leaves nothing to search."""
    world = problem.world
    conditions = Wanted(world)
    goals: dict[Key, list[Behavior]] = {}
    for behavior in world.program.behaviors:
        if behavior.goal is not None:
            goals.setdefault(_key(plain(behavior.goal)), []).append(behavior)
    pending: list[Statement] = [Achieve(problem.goal)]
    seen = set[str]()
    while pending:
        match pending.pop():
            case Achieve(condition=condition):
                normal = conditions.normal(condition)
                if isinstance(normal, And | Or | Quantified):
                    return False
                found = [] if is_opaque(normal) else goals.get(_key(normal), [])
                # Whatever writes what a comparison reads may be applied where no goal is like it.
                if len(found) > 1 or (isinstance(normal, Compare) and not found):
                    return False
            case Call(behavior=name):
                found = [world.behaviors[name]]
            case _:
                found = []
        new = [behavior for behavior in found if behavior.name not in seen]
        if any(map(_chooses, new)):
            return False
        seen.update(behavior.name for behavior in new)
        pending.extend(s for behavior in new for s in statements_within(behavior.body))
    return True


def _key(condition: Expression) -> Key:
    match condition:
        case Not(operand=operand):
            return _key(operand)[0], True
        case Compare(left=left, right=right):
            return _names(left) | _names(right), False
        case _:
            return _names(condition), False


def _names(side: Expression) -> frozenset[str]:
    match side:
        case Read(feature=name) | Apply(function=name):
            return frozenset((name,))
        case _:
            return frozenset()


def _chooses(behavior: Behavior) -> bool:
    """Whether the body of a behavior may leave something open, or fail."""
    if behavior.promotable is not None or open_parameters(behavior):
        return True
    return any(
        isinstance(s, Assert | Bind | Commit) or (isinstance(s, Group) and s.order == "alternative")
        for s in statements_within(behavior.body)
    )
