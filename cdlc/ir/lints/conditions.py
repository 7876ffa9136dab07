"""Conditions that are always true or always false."""

from collections.abc import Iterator

from cdlc.diagnostics import Collector
from cdlc.ir.behaviors import statements_of
from cdlc.ir.errors import ConstantCondition
from cdlc.ir.lints.subject import Subject
from cdlc.ir.pool import Pool
from crow.program import (
    Achieve,
    Assert,
    Bind,
    Conditional,
    Constant,
    Expression,
    If,
    Statement,
)
from crow.program.walk import expressions_of, subexpressions


def constant_conditions(subject: Subject, found: Collector) -> None:
    """Report conditions that folding decides, such as `assert True` and `if 1 < 2`."""
    pool = Pool(subject.hierarchy)
    for statement in statements_of(subject.program):
        for condition in _conditions(statement):
            value = pool.rebuild(condition, {})
            if isinstance(value, Constant) and condition.location is not None:
                is_true = value is pool.true
                found.add(ConstantCondition(location=condition.location, value=is_true))


def _conditions(statement: Statement) -> Iterator[Expression]:
    match statement:
        case Assert(condition=condition) | Achieve(condition=condition) | If(condition=condition):
            yield condition
        case Bind(condition=condition) if condition is not None:
            yield condition
        case _:
            pass
    for expression in expressions_of(statement):
        for part in subexpressions(expression):
            if isinstance(part, Conditional):
                yield part.condition
