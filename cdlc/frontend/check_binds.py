"""`let` and `bind`: the statements that introduce variables (language.md §3, §2.4 of the paper)."""

from cdlc.frontend import errors, syntax
from cdlc.frontend.check_expressions import check_condition, check_expression, check_value
from cdlc.frontend.check_types import check_not_hiding, check_variables, introduce, resolve_type
from cdlc.frontend.infer import type_from_use
from cdlc.frontend.scope import Context, Scope, is_condition
from crow.program import (
    BOOL,
    UNKNOWN,
    Bind,
    Compare,
    Expression,
    Let,
    Parameter,
    Statement,
    Type,
    UnknownType,
    Variable,
)

Introduced = tuple[Statement, Scope]


def check_let(node: syntax.Let, scope: Scope, context: Context) -> Introduced:
    """`let v = e`; the variable is visible from the next statement on."""
    if node.type is not None:
        type_ = resolve_type(node.type, context)
        value = check_value(node.value, type_, scope, context)
    else:
        value = check_expression(node.value, scope, context)
        type_ = value.type
    check_not_hiding(node.name, context)
    variable = Parameter(node.name.text, type_, location=context.location(node.name.span))
    after = introduce((variable,), "local", scope, context)
    return Let(variable, value, location=context.location(node.span)), after


def check_bind(node: syntax.Bind, scope: Scope, context: Context) -> Introduced:
    """Every form of `bind`; the variables are visible in its own condition."""
    location = context.location(node.span)
    variables = check_variables(node.variables, context, only_objects=False)
    untyped = [item.name for item in node.variables[len(variables) :]]
    variables += tuple(_untyped(name, node, scope, context) for name in untyped)
    after = introduce(variables, "bound", scope, context)
    if node.condition is None:
        return Bind(variables, None, location=location), after
    if node.form == "where":
        condition = check_condition(node.condition, after, context)
        return Bind(variables, condition, location=location), after
    return _bind_to(node.condition, node, variables, after, context), after


def _untyped(name: syntax.Name, node: syntax.Bind, scope: Scope, context: Context) -> Parameter:
    """A variable without a type: it has that of the parameter it stands for in the condition.

    In `bind v = f(a)`, where `v` stands for none, it has that of the value.
    """
    location = context.location(name.span)
    type_: Type | None = None
    if node.condition is not None:
        type_ = type_from_use(name.text, node.condition, scope, context)
    if type_ is None and node.form == "equal" and len(node.variables) == 1:
        assert node.condition is not None
        type_ = check_expression(node.condition, scope, context).type
    if type_ is None:
        context.found.add(errors.MissingType(location=location, name=name.text))
        type_ = UNKNOWN
    check_not_hiding(name, context)
    return Parameter(name.text, type_, location=location)


def _bind_to(
    node: syntax.Expression,
    bind: syntax.Bind,
    variables: tuple[Parameter, ...],
    scope: Scope,
    context: Context,
) -> Bind:
    """`bind v: T = e`: a condition over `v` if `e` is Boolean and `T` is not, else `v == e`."""
    location = context.location(bind.span)
    last = variables[-1]
    if len(variables) > 1:
        return Bind(variables, check_condition(node, scope, context), location=location)
    value = check_expression(node, scope, context, last.type)
    if isinstance(last.type, UnknownType):
        return Bind(variables, value, location=location)
    if is_condition(value.type) and not is_condition(last.type):
        return Bind(variables, value, location=location)
    if bind.form == "call" and value.type != BOOL:
        _report(value, "`bool`", last, context)
    elif not context.declarations.fits(value.type, last.type):
        _report(value, f"`{last.type}`", last, context)
    variable = Variable(last.name, last.type, location=last.location)
    condition = Compare("==", variable, value, location=location)
    return Bind(variables, condition, location=location)


def _report(value: Expression, expected: str, variable: Parameter, context: Context) -> None:
    assert value.location is not None
    context.found.add(
        errors.WrongType(
            location=value.location,
            expected=expected,
            found=value.type,
            declared=variable.location,
        )
    )
