"""Behaviors whose effects do not make their goals true."""

from collections.abc import Mapping

from cdlc.diagnostics import Collector
from cdlc.ir.errors import GoalNotEstablished
from cdlc.ir.fold import fold
from cdlc.ir.hoare import NotModelled, Triple, Update, inline, regress, triple
from cdlc.ir.lints.subject import Subject
from cdlc.ir.logic import FALSE, TRUE
from crow.program import (
    Apply,
    Compare,
    Conditional,
    Constant,
    Expression,
    Hierarchy,
    Not,
    Object,
    Program,
    Quantified,
    Read,
    Variable,
)
from crow.program.walk import subexpressions
from crow.text import expression_text


def goals_not_established(subject: Subject, found: Collector) -> None:
    """Report behaviors whose effects do not establish their goals.

    Quiet where that depends on external functions, conditions or arithmetic, and about behaviors
    without an effect of their own.
    """
    for behavior in subject.program.behaviors:
        try:
            model = triple(subject.program, behavior)
            if model is not None and establishes_goal(subject.program, model) is False:
                _report(model, found)
        except NotModelled:
            continue


def establishes_goal(program: Program, model: Triple) -> bool | None:
    """Whether the goal holds after a behavior; None when folding alone cannot tell.

    Raises NotModelled if the goal calls a function that has no value as a formula.
    """
    if model.goal is None:
        return True
    hierarchy = Hierarchy.of(program.types)
    goal = inline(program, model.goal)
    known = _facts(model, hierarchy)
    before = fold(regress(goal, model.post, hierarchy), hierarchy, known)
    if before == TRUE:
        return True
    if before == FALSE or _is_plain(before, fold(goal, hierarchy)):
        return False
    return None


def _facts(model: Triple, hierarchy: Hierarchy) -> Mapping[Expression, Expression]:
    """The literals of the precondition with their truth, equations in both orientations."""
    known: dict[Expression, Expression] = {}
    for condition in model.pre:
        fact = fold(condition, hierarchy)
        value = TRUE
        if isinstance(fact, Not):
            fact, value = fact.operand, FALSE
        if isinstance(fact, Constant):
            continue
        known[fact] = value
        if isinstance(fact, Compare) and fact.operator == "==":
            known[Compare("==", fact.right, fact.left)] = value
    return known


def _is_plain(before: Expression, goal: Expression) -> bool:
    """Whether what is left asks for nothing but the goal itself and equal arguments.

    Then there are states and arguments where it fails, and no condition of the author's that might
    exclude them.
    """
    wanted = set(subexpressions(goal))
    for part in subexpressions(before):
        match part:
            case Apply() | Conditional() | Quantified():
                return False
            case Read() if part not in wanted:
                return False
            case Compare(left=Variable() | Object(), right=Variable() | Object()):
                continue
            case Compare() if part not in wanted:
                return False
            case _:
                continue
    return True


def _report(model: Triple, found: Collector) -> None:
    goal = model.goal
    assert goal is not None
    assert goal.location is not None
    other = _near_miss(model)
    found.add(
        GoalNotEstablished(
            location=goal.location,
            behavior=model.behavior,
            goal=expression_text(goal),
            effect=None if other is None else other.location,
            suggestion=None if other is None else _mended(model),
        )
    )


def _near_miss(model: Triple) -> Update | None:
    """An update that would have established the goal for other arguments."""
    literal, wanted = _literal(model)
    if literal is None:
        return None
    writes = [u for u in model.post if u.feature == literal.feature]
    same_value = (u for u in writes if isinstance(u.value, Constant) and u.value.value is wanted)
    return next(same_value, None)


def _mended(model: Triple) -> str | None:
    literal, wanted = _literal(model)
    if literal is None:
        return None
    arguments = ", ".join(expression_text(a) for a in literal.arguments) or "..."
    return f"{literal.feature}[{arguments}] = {wanted}"


def _literal(model: Triple) -> tuple[Read | None, bool]:
    match model.goal:
        case Read() as read:
            return read, True
        case Not(operand=Read() as read):
            return read, False
        case _:
            return None, True
