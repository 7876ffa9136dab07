"""Behaviors looked at as a whole."""

from collections.abc import Iterator

from crow.program import Behavior, Expression, Program, Statement
from crow.program.walk import expressions_of, statements_within, subexpressions


def body_of(behavior: Behavior) -> tuple[Statement, ...]:
    """The statements of L, M and R."""
    members = () if behavior.promotable is None else behavior.promotable.members
    return (*behavior.left, *members, *behavior.right)


def statements_of(program: Program) -> Iterator[Statement]:
    """Every statement of a program, nested ones too."""
    for function in program.functions:
        yield from statements_within(function.body or ())
    for controller in program.controllers:
        yield from statements_within(controller.effect or ())
    for behavior in program.behaviors:
        yield from statements_within((*body_of(behavior), *(behavior.effect or ())))


def parts_of(statements: tuple[Statement, ...]) -> Iterator[Expression]:
    """Every expression in statements, however deep."""
    for statement in statements_within(statements):
        for expression in expressions_of(statement):
            yield from subexpressions(expression)
