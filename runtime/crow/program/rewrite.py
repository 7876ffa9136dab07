"""Rewriting expressions: one function applied to each node, and variables replaced."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import fields, replace
from functools import cache
from typing import Any, cast

from crow.program.expressions import (
    And,
    Apply,
    Arithmetic,
    Builtin,
    Compare,
    Conditional,
    Expression,
    Negative,
    Not,
    Or,
    Quantified,
    Read,
    Variable,
    Vector,
    Xor,
)
from crow.program.names import fresh_name
from crow.program.walk import free_variables

# What has operands to look into.
_PARENTS = (
    And, Apply, Arithmetic, Builtin, Compare, Conditional, Negative, Not, Or, Quantified, Read,
    Vector, Xor,
)  # fmt: skip


def rewrite(expression: Expression, rule: Callable[[Expression], Expression]) -> Expression:
    """The expression with `rule` applied to every node, innermost first."""
    return rule(_with_parts(expression, lambda part: rewrite(part, rule)))


@cache
def _expression_fields(cls: Any) -> tuple[str, ...]:
    names = ("operand", "operands", "left", "right", "arguments", "elements", "condition", "then",
             "otherwise", "body")  # fmt: skip
    return tuple(f.name for f in fields(cls) if f.name in names)


def substitute(expression: Expression, values: Mapping[str, Expression]) -> Expression:
    """The expression with free variables replaced.

    Quantified variables are renamed where a value would come under them by accident.
    """
    taken = frozenset[str]().union(*map(free_variables, values.values()))
    return _substituted(rename_quantified(expression, taken), values)


def _substituted(expression: Expression, values: Mapping[str, Expression]) -> Expression:
    match expression:
        case Variable(name=name):
            return values.get(name, expression)
        case Quantified(variables=variables, body=body):
            hidden = {variable.name for variable in variables}
            inner = {name: value for name, value in values.items() if name not in hidden}
            return replace(expression, body=_substituted(body, inner))
        case _:
            return _with_parts(expression, lambda part: _substituted(part, values))


def rename_quantified(expression: Expression, taken: Collection[str]) -> Expression:
    """The expression with names for its quantified variables that are not taken."""
    if not taken:
        return expression
    if not isinstance(expression, Quantified):
        return _with_parts(expression, lambda part: rename_quantified(part, taken))
    body = rename_quantified(expression.body, taken)
    used = {*taken, *free_variables(body), *(v.name for v in expression.variables)}
    renamed: dict[str, Expression] = {}
    variables = []
    for variable in expression.variables:
        name = variable.name
        if name in taken:
            name = fresh_name(name, used)
            used.add(name)
            renamed[variable.name] = Variable(name, variable.type)
        variables.append(replace(variable, name=name))
    return replace(expression, variables=tuple(variables), body=substitute(body, renamed))


def _with_parts(expression: Expression, change: Callable[[Expression], Expression]) -> Expression:
    """The expression with a function applied to each of its operands."""
    if not isinstance(expression, _PARENTS):
        return expression
    changed: dict[str, Any] = {}
    cls: Any = type(expression)
    for name in _expression_fields(cls):
        old = getattr(expression, name)
        if isinstance(old, tuple):
            new: object = tuple(map(change, old))
            if any(a is not b for a, b in zip(cast("tuple[object, ...]", new), old, strict=True)):
                changed[name] = new
        elif (new := change(old)) is not old:
            changed[name] = new
    return cast("Expression", replace(expression, **changed)) if changed else expression
