"""Walking over programs: the parts of a statement or expression, in source order."""

from collections.abc import Iterable, Iterator
from dataclasses import fields
from functools import cache
from typing import Any

from crow.program.expressions import Expression, Quantified, Variable
from crow.program.location import Node
from crow.program.statements import Statement


@cache
def _child_fields(cls: Any) -> tuple[str, ...]:
    skipped = ("location", "annotations", "type")
    return tuple(f.name for f in fields(cls) if f.name not in skipped)


def children(node: Node) -> Iterator[Node]:
    """The nodes directly under a node, in the order of its fields."""
    cls: Any = type(node)
    for name in _child_fields(cls):
        value = getattr(node, name)
        if isinstance(value, tuple):
            yield from (item for item in value if isinstance(item, Node))
        elif isinstance(value, Node):
            yield value


def subexpressions(expression: Expression) -> Iterator[Expression]:
    """An expression and every expression within it, outermost first."""
    pending: list[Node] = [expression]
    while pending:
        node = pending.pop()
        if isinstance(node, Expression):
            yield node
        pending.extend(reversed(tuple(children(node))))


def free_variables(expression: Expression) -> frozenset[str]:
    """The names of the variables that no quantifier of the expression itself binds."""
    match expression:
        case Variable(name=name):
            return frozenset((name,))
        case Quantified(variables=variables, body=body):
            return free_variables(body) - {variable.name for variable in variables}
        case _:
            parts = (c for c in children(expression) if isinstance(c, Expression))
            return frozenset[str]().union(*map(free_variables, parts))


def statements_within(statements: Iterable[Statement]) -> Iterator[Statement]:
    """Statements and every statement nested in them, in source order."""
    for statement in statements:
        yield statement
        kind: Any = type(statement)
        if _nests(kind):
            nested = [child for child in children(statement) if isinstance(child, Statement)]
            yield from statements_within(nested)


@cache
def _nests(cls: Any) -> bool:
    """Whether statements of a class have others within them."""
    return any("Statement" in str(f.type) for f in fields(cls))


def expressions_of(statement: Statement) -> Iterator[Expression]:
    """The outermost expressions of one statement, without those of nested statements."""
    return (child for child in children(statement) if isinstance(child, Expression))
