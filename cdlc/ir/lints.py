"""Warnings that need the meaning of a program, not only its types."""

from crow.program import Constant, Not, Program, Read
from crow.text import expression_text

from cdlc.diagnostics import Collector
from cdlc.ir.errors import GoalNotEstablished
from cdlc.ir.hoare import NotModelled, Triple, Update, establishes_goal, triple


def lint(program: Program, found: Collector) -> None:
    """Report behaviors whose effects do not establish their goals."""
    for behavior in program.behaviors:
        try:
            model = triple(program, behavior)
        except NotModelled:
            continue
        if model is not None and establishes_goal(program, model) is False:
            _report(model, found)


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
