"""Rewriting expressions: one function applied to each node, innermost first."""

from collections.abc import Callable, Mapping
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

# What has operands to look into.
_PARENTS = (
    And, Apply, Arithmetic, Builtin, Compare, Conditional, Negative, Not, Or, Quantified, Read,
    Vector, Xor,
)  # fmt: skip


def rewrite(expression: Expression, rule: Callable[[Expression], Expression]) -> Expression:
    """The expression with `rule` applied to every node, innermost first."""
    if not isinstance(expression, _PARENTS):
        return rule(expression)
    changed: dict[str, Any] = {}
    cls: Any = type(expression)
    for name in _expression_fields(cls):
        old = getattr(expression, name)
        if isinstance(old, tuple):
            new: object = tuple(rewrite(item, rule) for item in old)
            if any(a is not b for a, b in zip(cast("tuple[object, ...]", new), old, strict=True)):
                changed[name] = new
        else:
            new = rewrite(old, rule)
            if new is not old:
                changed[name] = new
    return rule(cast("Expression", replace(expression, **changed)) if changed else expression)


@cache
def _expression_fields(cls: Any) -> tuple[str, ...]:
    names = ("operand", "operands", "left", "right", "arguments", "elements", "condition", "then",
             "otherwise", "body")  # fmt: skip
    return tuple(f.name for f in fields(cls) if f.name in names)


def substitute(expression: Expression, values: Mapping[str, Expression]) -> Expression:
    """The expression with variables replaced; quantified variables hide outer ones.

    The caller keeps free variables of `values` apart from quantified variables of the expression.
    """
    if isinstance(expression, Quantified):
        hidden = {variable.name for variable in expression.variables}
        inner = {name: value for name, value in values.items() if name not in hidden}
        return replace(expression, body=substitute(expression.body, inner))
    if isinstance(expression, Variable):
        return values.get(expression.name, expression)
    if not isinstance(expression, _PARENTS):
        return expression
    changed: dict[str, Any] = {}
    cls: Any = type(expression)
    for name in _expression_fields(cls):
        old = getattr(expression, name)
        if isinstance(old, tuple):
            changed[name] = tuple(substitute(item, values) for item in old)
        else:
            changed[name] = substitute(old, values)
    return cast("Expression", replace(expression, **changed))
