"""Behaviors whose effects do not make their goals true."""

from cdlc.diagnostics import Collector
from cdlc.ir.behaviors import body_of
from cdlc.ir.errors import GoalNotEstablished
from cdlc.ir.graph import in_order
from cdlc.ir.hoare import Model
from cdlc.ir.lints.subject import Subject
from cdlc.ir.updates import NotModelled
from crow.program import (
    Achieve,
    Apply,
    Compare,
    Conditional,
    Constant,
    Expression,
    Not,
    Object,
    Quantified,
    Read,
    Statement,
    Variable,
)
from crow.program.triples import Triple, Update
from crow.program.walk import statements_within, subexpressions
from crow.text import expression_text


def goals_not_established(subject: Subject, found: Collector) -> None:
    """Report behaviors whose effects do not establish their goals.

    Quiet where that depends on external functions, conditions or arithmetic, about behaviors
    without an effect of their own, and where an `achieve_once` compares: it may exclude the
    arguments in question.
    """
    model = Model(subject.program)
    for behavior in subject.program.behaviors:
        if any(map(_compares_once, statements_within(body_of(behavior)))):
            continue
        try:
            for triple in model.triples(behavior)[:1]:
                if establishes_goal(model, triple) is False:
                    _report(triple, found)
        except NotModelled:
            continue


def _compares_once(statement: Statement) -> bool:
    if not isinstance(statement, Achieve) or not statement.once:
        return False
    return any(isinstance(part, Compare) for part in subexpressions(statement.condition))


def establishes_goal(model: Model, triple: Triple) -> bool | None:
    """Whether the goal holds after a transition; None when folding alone cannot tell.

    Raises NotModelled if the goal calls a function that has no value as a formula.
    """
    if triple.goal is None:
        return True
    pool = model.pool
    if any(part is pool.false for part in triple.pre):
        return True  # it can never be applied
    goal = model.formula(triple.goal, triple.parameters)
    before = pool.given(model.weakest_precondition(goal, triple), triple.pre)
    if before is pool.true:
        return True
    if before is pool.false or _is_plain(before, goal):
        return False
    return None


def _is_plain(before: Expression, goal: Expression) -> bool:
    """Whether what is left asks for nothing but the goal itself and equal arguments.

    Then there are states and arguments where it fails, and no condition of the author's that might
    exclude them.
    """
    wanted = {id(part) for part in in_order(goal)}
    for part in in_order(before):
        match part:
            case Apply() | Conditional() | Quantified():
                return False
            case Read() if id(part) not in wanted:
                return False
            case Compare(left=Variable() | Object(), right=Variable() | Object()):
                continue
            case Compare() if id(part) not in wanted:
                return False
            case _:
                continue
    return True


def _report(model: Triple, found: Collector) -> None:
    goal = model.goal
    assert goal is not None
    assert goal.location is not None
    other = near_miss(model)
    found.add(
        GoalNotEstablished(
            location=goal.location,
            behavior=model.behavior,
            goal=expression_text(goal),
            effect=None if other is None else other.location,
            suggestion=None if other is None else mended(model),
        )
    )


def near_miss(model: Triple) -> Update | None:
    """An update that would have established the goal for other arguments."""
    literal, wanted = _literal(model)
    if literal is None:
        return None
    writes = [u for u in model.post if u.feature == literal.feature]
    same_value = (u for u in writes if isinstance(u.value, Constant) and u.value.value is wanted)
    return next(same_value, None)


def mended(model: Triple) -> str | None:
    """The assignment that would establish a goal that is a literal."""
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
