"""Assignments to features and to locals (language.md §3)."""

from typing import Literal, cast

from cdlc.frontend import errors, syntax
from cdlc.frontend.check_expressions import (
    check_call,
    check_expression,
    check_number,
    check_value,
)
from cdlc.frontend.scope import Context, Scope
from cdlc.frontend.sections import CHANGING, Section, report_misplaced
from crow.program import (
    INT64,
    Arithmetic,
    Assign,
    Constant,
    Expression,
    Feature,
    Negative,
    SetLocal,
    Statement,
    Type,
    UnknownType,
    Variable,
    VectorType,
)
from crow.program.types import is_integer, is_number, underlying


def check_assignment(
    node: syntax.Assignment, scope: Scope, section: Section, context: Context
) -> Statement | None:
    """An assignment to a local or to a cell of a feature; None when it is neither."""
    match node.target:
        case syntax.NameExpression(name=name) if scope.get(name) is not None:
            return _set_local(node, name, scope, context)
        case syntax.NameExpression(name=name) as target:
            if section.kind in ("body", "function") and name in context.declarations.features:
                what = "an assignment to a feature"
                report_misplaced(node, what, section, CHANGING, context)
                return None
            call = syntax.Call(
                syntax.Name(name, span=target.span), (), bracketed=True, span=target.span
            )
            return _assign(node, call, scope, section, context)
        case syntax.Call(bracketed=False) as target:
            text = context.source.text[target.span.start : target.span.end]
            cell = f"{target.name.text}[{text[len(target.name.text) + 1 : -1] or '...'}]"
            location = context.location(target.span)
            context.found.add(errors.CallForIndex(location=location, cell=cell))
            return _assign(node, target, scope, section, context)
        case syntax.Call() as target:
            return _assign(node, target, scope, section, context)


def _assign(
    node: syntax.Assignment,
    target: syntax.Call,
    scope: Scope,
    section: Section,
    context: Context,
) -> Statement | None:
    name, declared = target.name.text, context.declarations
    feature = declared.features.get(name)
    if feature is None:
        _report_not_assignable(target, scope, context)
        return None
    cell = check_call(target, scope, context)
    value = _operand(node, feature.type, scope, context, feature)
    if section.kind == "init" and node.operator == "=":
        _check_bounds(feature, value, context)
    arguments = getattr(cell, "arguments", ())
    location = context.location(node.span)
    return Assign(name, arguments, node.operator, value, location=location)


def _operand(
    node: syntax.Assignment,
    type_: Type,
    scope: Scope,
    context: Context,
    declared: Feature | None = None,
) -> Expression:
    """The right side of an assignment to a place of a type, checked against its operator."""
    if node.operator == "=":
        return check_value(node.value, type_, scope, context, declared)
    is_vector = isinstance(underlying(type_), VectorType)
    if not is_vector and not is_number(type_) and not isinstance(type_, UnknownType):
        context.found.add(
            errors.WrongType(
                location=context.location(node.target.span),
                expected=f"a number for `{node.operator}`",
                found=type_,
                declared=None if declared is None else declared.location,
            )
        )
        return check_expression(node.value, scope, context)
    if node.operator == "/=" and is_integer(_scalar(type_)):
        context.found.add(
            errors.WrongType(
                location=context.location(node.target.span),
                expected="a float for `/=`",
                found=type_,
                reason="`/` gives a float, which does not fit an integer; `//` rounds down",
                declared=None if declared is None else declared.location,
            )
        )
        return check_expression(node.value, scope, context)
    if is_vector and node.operator in ("*=", "/="):
        if is_integer(_scalar(type_)):
            return check_value(node.value, INT64, scope, context)
        return check_number(node.value, scope, context)
    return check_value(node.value, type_, scope, context, declared)


def _scalar(type_: Type) -> Type:
    base = underlying(type_)
    return base.element if isinstance(base, VectorType) else base


def _check_bounds(feature: Feature, value: Expression, context: Context) -> None:
    """Report an initial constant outside the bounds of its feature."""
    low, high = feature.bounds
    number = _constant(value)
    if number is None or value.location is None:
        return
    if (low is not None and number < low) or (high is not None and number > high):
        context.found.add(
            errors.OutOfBounds(
                location=value.location,
                feature=feature.name,
                value=number,
                low=low,
                high=high,
                declared=feature.location,
            )
        )


def _constant(value: Expression) -> int | None:
    match value:
        case Constant(value=bool()):
            return None
        case Constant(value=int(number)):
            return number
        case Negative(operand=operand):
            inner = _constant(operand)
            return None if inner is None else -inner
        case _:
            return None


def _report_not_assignable(target: syntax.Call, scope: Scope, context: Context) -> None:
    name, declared = target.name.text, context.declarations
    location = context.location(target.name.span)
    kind = declared.kind(name)
    if scope.get(name) is not None:
        kind = "variable"
    if kind is not None:
        context.found.add(errors.NotAssignable(location=location, name=name, is_a=kind))
        return
    known = [*declared.features, *scope]
    is_bare = target.span == target.name.span
    context.found.add(
        errors.UnknownFeature(location=location, name=name, known=known, is_bare=is_bare)
    )


def _set_local(
    node: syntax.Assignment, name: str, scope: Scope, context: Context
) -> Statement | None:
    local = scope.get(name)
    assert local is not None
    location = context.location(node.span)
    if local.kind != "local":
        words = {"parameter": "parameter", "bound": "bound variable", "loop": "loop variable"}
        is_a = words.get(local.kind, "variable")
        target = context.location(node.target.span)
        context.found.add(errors.NotAssignable(location=target, name=name, is_a=is_a))
        return None
    if local.depth < scope.depth:
        first = local.variable.location
        context.found.add(errors.OuterLocal(location=location, name=name, first=first))
        return None
    type_ = local.variable.type
    if node.operator == "=":
        value = check_value(node.value, type_, scope, context, local.variable)
    else:
        value = _operand(node, type_, scope, context)
        operator = cast("Literal['+', '-', '*', '/']", node.operator[0])
        variable = Variable(name, type_, location=context.location(node.target.span))
        value = Arithmetic(operator, variable, value, type_, location=location)
    return SetLocal(name, value, location=location)
