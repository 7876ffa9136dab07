"""Statements of bodies, effects, derived functions and `init` (language.md §3)."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, cast

from crow.program import (
    INT64,
    UNKNOWN,
    Achieve,
    Arithmetic,
    Assert,
    Assign,
    Bind,
    Break,
    Call,
    Commit,
    Compare,
    Continue,
    Do,
    Expression,
    Feature,
    ForEach,
    ForRange,
    Group,
    If,
    Let,
    Parameter,
    Return,
    SetLocal,
    Statement,
    Type,
    Variable,
)
from crow.program.types import is_number

from cdlc.frontend import errors, syntax
from cdlc.frontend.annotations import check_annotations
from cdlc.frontend.check_expressions import (
    check_arguments,
    check_call,
    check_condition,
    check_expression,
    check_value,
)
from cdlc.frontend.check_types import check_not_hiding, check_variables, resolve_type
from cdlc.frontend.ranges import check_range
from cdlc.frontend.scope import Context, LocalKind, Scope, is_condition

SectionKind = Literal["body", "effect", "function", "init"]

SECTION_NAMES: dict[SectionKind, str] = {
    "body": "a body",
    "effect": "an effect",
    "function": "a derived function",
    "init": "the initial state",
}


@dataclass(frozen=True, slots=True)
class Section:
    """Where statements stand: the kind of section, and in a function the type to return."""

    kind: SectionKind
    returns: Type = UNKNOWN


def check_block(
    statements: tuple[syntax.Statement, ...], scope: Scope, section: Section, context: Context
) -> tuple[Statement, ...]:
    """The typed statements of a block; each sees the variables that earlier ones introduced."""
    return check_sequence(statements, scope, section, context)[0]


def check_sequence(
    statements: tuple[syntax.Statement, ...], scope: Scope, section: Section, context: Context
) -> tuple[tuple[Statement, ...], Scope]:
    """As check_block, with the scope after the last statement."""
    checked: list[Statement] = []
    for statement in statements:
        typed, scope = _check_statement(statement, scope, section, context)
        if typed is None:
            continue
        if statement.annotations:
            typed = replace(typed, annotations=check_annotations(statement.annotations, context))
        checked.append(typed)
    return tuple(checked), scope


Checked = tuple[Statement | None, Scope]


def _check_statement(
    node: syntax.Statement, scope: Scope, section: Section, context: Context
) -> Checked:
    if (wrong := _misplaced(node, section)) is not None:
        what, advice = wrong
        _report_misplaced(node, what, section, advice, context)
        return None, scope
    match node:
        case syntax.Let():
            return _let(node, scope, context)
        case syntax.Bind():
            return _bind(node, scope, context)
        case syntax.ErrorStatement():
            return None, scope
        case _:
            return _check_plain(node, scope, section, context), scope


def _check_plain(
    node: syntax.Statement, scope: Scope, section: Section, context: Context
) -> Statement | None:
    """A statement that introduces no variable."""
    location = context.location(node.span)
    match node:
        case syntax.Assert(condition=condition):
            return Assert(check_condition(condition, scope, context), location=location)
        case syntax.Achieve(condition=condition, once=once):
            return Achieve(check_condition(condition, scope, context), once, location=location)
        case syntax.Return(value=value):
            return Return(check_value(value, section.returns, scope, context), location=location)
        case syntax.CallStatement():
            return _call(node, scope, context)
        case syntax.Assignment():
            return _assignment(node, scope, section, context)
        case syntax.Word():
            return _word(node, scope, context)
        case syntax.Group(order=order, body=body):
            return Group(order, check_block(body, scope, section, context), location=location)
        case syntax.Promotable():
            reason = "`promotable:` stands at the top level of a body, once"
            context.found.add(errors.MisplacedPromotable(location=location, reason=reason))
            return None
        case syntax.ForEach():
            return _foreach(node, scope, section, context)
        case syntax.ForRange():
            return _for_range(node, scope, section, context)
        case syntax.If():
            return _if(node, node.branches, scope, section, context)
        case _:
            raise AssertionError(node)


# ---------------------------------------------------------------------------- what may stand where

_EVERYWHERE: tuple[SectionKind, ...] = ("body", "effect", "function", "init")
_DOING = "effects and functions only compute; move it into `body:`"
_CHANGING = "only effects change features; move it into `eff:`"


def _misplaced(node: syntax.Statement, section: Section) -> tuple[str, str] | None:
    """The statement in words and a cure, when it cannot stand in this kind of section."""
    what, allowed, advice = _placement(node)
    return None if section.kind in allowed else (what, advice)


def _placement(node: syntax.Statement) -> tuple[str, tuple[SectionKind, ...], str]:
    match node:
        case syntax.Assert():
            return "`assert`", ("body",), _DOING
        case syntax.Achieve(once=once):
            return ("`achieve_once`" if once else "`achieve`"), ("body",), _DOING
        case syntax.CallStatement():
            return "a call", ("body",), _DOING
        case syntax.Bind():
            return "`bind`", ("body",), _DOING
        case syntax.Group(order=order):
            return f"`{order}:`", ("body",), _DOING
        case syntax.Promotable():
            return "`promotable:`", ("body",), _DOING
        case syntax.Word(word="commit"):
            return "`commit`", ("body",), _DOING
        case syntax.Word(word="break" | "continue" as word):
            advice = "in a body, `for` repeats its block a fixed number of times; use `if`"
            return f"`{word}`", ("effect", "function"), advice
        case syntax.Return():
            return "`return`", ("function",), "only a `def` returns a value"
        case syntax.Assignment(target=syntax.Call()):
            return "an assignment to a feature", ("effect", "init"), _CHANGING
        case _:
            return "", _EVERYWHERE, ""


def _report_misplaced(
    node: syntax.Statement, what: str, section: Section, advice: str, context: Context
) -> None:
    context.found.add(
        errors.MisplacedStatement(
            location=context.location(node.span),
            statement=what,
            section=SECTION_NAMES[section.kind],
            advice=advice,
        )
    )


# -------------------------------------------------------------------------------------- variables


def _introduce(
    variables: tuple[Parameter, ...], kind: LocalKind, scope: Scope, context: Context
) -> Scope:
    """Add variables to the scope, warning of earlier ones they shadow."""
    for variable in variables:
        earlier = scope.get(variable.name)
        if earlier is not None and variable.location is not None:
            context.found.add(
                errors.Shadowing(
                    location=variable.location,
                    name=variable.name,
                    first=earlier.variable.location,
                )
            )
        scope = scope.add(variable, kind)
    return scope


def _let(node: syntax.Let, scope: Scope, context: Context) -> Checked:
    if node.type is not None:
        type_ = resolve_type(node.type, context)
        value = check_value(node.value, type_, scope, context)
    else:
        value = check_expression(node.value, scope, context)
        type_ = value.type
    check_not_hiding(node.name, context)
    variable = Parameter(node.name.text, type_, location=context.location(node.name.span))
    after = _introduce((variable,), "local", scope, context)
    return Let(variable, value, location=context.location(node.span)), after


def _bind(node: syntax.Bind, scope: Scope, context: Context) -> Checked:
    location = context.location(node.span)
    if node.variables[-1].type is None:
        return _untyped_bind(node, scope, context)
    variables = check_variables(node.variables, context, only_objects=False)
    if node.condition is None:
        after = _introduce(variables, "bound", scope, context)
        return Bind(variables, None, location=location), after
    if node.form == "equal":
        return _bind_equal(node, variables, scope, context)
    after = _introduce(variables, "bound", scope, context)
    condition = check_condition(node.condition, after, context)
    return Bind(variables, condition, location=location), after


def _bind_equal(
    node: syntax.Bind, variables: tuple[Parameter, ...], scope: Scope, context: Context
) -> Checked:
    """`bind v: T = e`: a condition over `v` if `e` is Boolean and `T` is not, else `v == e`."""
    assert node.condition is not None
    location = context.location(node.span)
    after = _introduce(variables, "bound", scope, context)
    value = check_expression(node.condition, after, context, variables[-1].type)
    if is_condition(value.type) and not is_condition(variables[-1].type):
        return Bind(variables, value, location=location), after
    return _bind_to_value(node, variables, value, context), after


def _bind_to_value(
    node: syntax.Bind,
    variables: tuple[Parameter, ...],
    value: Expression,
    context: Context,
) -> Statement:
    location = context.location(node.span)
    last = variables[-1]
    if not context.declarations.fits(value.type, last.type):
        context.found.add(
            errors.WrongType(
                location=value.location or location,
                expected=f"`{last.type}`",
                found=value.type,
                declared=last.location,
            )
        )
    variable = Variable(last.name, last.type, location=last.location)
    return Bind(variables, Compare("==", variable, value, location=location), location=location)


def _untyped_bind(node: syntax.Bind, scope: Scope, context: Context) -> Checked:
    """`bind v = f(a, v)` or `bind v: f(a, v)`: the type is that of the parameter `v` stands for."""
    *_, last = node.variables
    location = context.location(last.span)
    type_ = _type_in_call(last.name.text, node.condition, context)
    if type_ is None and node.form == "equal" and node.condition is not None:
        type_ = check_expression(node.condition, scope, context).type
    if type_ is None or len(node.variables) > 1:
        context.found.add(errors.MissingType(location=location, name=last.name.text))
        type_ = UNKNOWN
    check_not_hiding(last.name, context)
    variable = Parameter(last.name.text, type_, location=location)
    after = _introduce((variable,), "bound", scope, context)
    if node.condition is None:
        return Bind((variable,), None, location=location), after
    value = check_expression(node.condition, after, context)
    if is_condition(value.type) and not is_condition(type_):
        return Bind((variable,), value, location=context.location(node.span)), after
    return _bind_to_value(node, (variable,), value, context), after


def _type_in_call(name: str, node: syntax.Expression | None, context: Context) -> Type | None:
    match node:
        case syntax.Call(name=called, arguments=arguments):
            declared = context.declarations
            function = declared.functions.get(called.text) or declared.features.get(called.text)
            if function is None:
                return None
            for parameter, argument in zip(function.parameters, arguments, strict=False):
                if isinstance(argument, syntax.NameExpression) and argument.name == name:
                    return parameter.type
            return None
        case _:
            return None


# ------------------------------------------------------------------------------------------ calls


def _call(node: syntax.CallStatement, scope: Scope, context: Context) -> Statement | None:
    name, declared = node.call.name.text, context.declarations
    location = context.location(node.span)
    target = declared.controllers.get(name) or declared.behaviors.get(name)
    if target is None:
        _report_no_command(node, context)
        return None
    arguments = check_arguments(
        name,
        target.parameters,
        declared.places.get(name),
        node.call.arguments,
        node.call,
        scope,
        context,
    )
    if name in declared.controllers:
        return Do(name, arguments, location=location)
    return Call(name, arguments, location=location)


def _report_no_command(node: syntax.CallStatement, context: Context) -> None:
    name, declared = node.call.name.text, context.declarations
    location = context.location(node.call.name.span)
    kind = declared.kind(name)
    if kind is None:
        known = [*declared.controllers, *declared.behaviors]
        context.found.add(errors.UnknownCommand(location=location, name=name, known=known))
        return
    advice = {
        "feature": f"to make it true: `achieve {name}(…)`; to require it: `assert {name}(…)`",
        "function": f"to bind its value: `let v = {name}(…)`; to require it: `assert {name}(…)`",
    }
    context.found.add(
        errors.WrongKind(
            location=location,
            name=name,
            is_a=kind,
            wanted="controller or behavior",
            advice=advice.get(kind, ""),
            defined=declared.places.get(name),
        )
    )


# ------------------------------------------------------------------------------------ assignments


def _assignment(
    node: syntax.Assignment, scope: Scope, section: Section, context: Context
) -> Statement | None:
    match node.target:
        case syntax.NameExpression(name=name) if scope.get(name) is not None:
            return _set_local(node, name, scope, context)
        case syntax.NameExpression(name=name) as target:
            if section.kind in ("body", "function") and name in context.declarations.features:
                what = "an assignment to a feature"
                _report_misplaced(node, what, section, _CHANGING, context)
                return None
            call = syntax.Call(
                syntax.Name(name, span=target.span), (), bracketed=True, span=target.span
            )
            return _assign(node, call, scope, context)
        case syntax.Call(bracketed=False) as target:
            text = context.source.text[target.span.start : target.span.end]
            cell = f"{target.name.text}[{text[len(target.name.text) + 1 : -1] or '...'}]"
            location = context.location(target.span)
            context.found.add(errors.CallForIndex(location=location, cell=cell))
            return _assign(node, target, scope, context)
        case syntax.Call() as target:
            return _assign(node, target, scope, context)


def _assign(
    node: syntax.Assignment, target: syntax.Call, scope: Scope, context: Context
) -> Statement | None:
    name, declared = target.name.text, context.declarations
    feature = declared.features.get(name)
    if feature is None:
        _report_not_assignable(target, scope, context)
        return None
    cell = check_call(target, scope, context)
    value = _assigned_value(node, feature, scope, context)
    arguments = getattr(cell, "arguments", ())
    location = context.location(node.span)
    return Assign(name, arguments, node.operator, value, location=location)


def _assigned_value(
    node: syntax.Assignment, feature: Feature, scope: Scope, context: Context
) -> Expression:
    if node.operator != "=" and not _can_augment(feature.type):
        context.found.add(
            errors.WrongType(
                location=context.location(node.target.span),
                expected=f"a number for `{node.operator}`",
                found=feature.type,
                declared=feature.location,
            )
        )
        return check_expression(node.value, scope, context)
    return check_value(node.value, feature.type, scope, context, feature)


def _can_augment(type_: Type) -> bool:
    return is_number(type_) or str(type_).startswith("vector")


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
    context.found.add(errors.UnknownFeature(location=location, name=name, known=known))


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
    value = check_value(node.value, type_, scope, context, local.variable)
    if node.operator != "=":
        operator = cast("Literal['+', '-', '*', '/']", node.operator[0])
        variable = Variable(name, type_, location=context.location(node.target.span))
        value = Arithmetic(operator, variable, value, type_, location=location)
    return SetLocal(name, value, location=location)


# ---------------------------------------------------------------------------------------- control

_WORDS: dict[str, Callable[..., Statement]] = {
    "commit": Commit,
    "break": Break,
    "continue": Continue,
}


def _word(node: syntax.Word, scope: Scope, context: Context) -> Statement | None:
    if node.word == "pass":
        return None
    location = context.location(node.span)
    if node.word in ("break", "continue") and not scope.in_for:
        context.found.add(
            errors.OutsideLoop(location=location, word=node.word, in_foreach=scope.depth > 0)
        )
        return None
    return _WORDS[node.word](location=location)


def _foreach(node: syntax.ForEach, scope: Scope, section: Section, context: Context) -> Statement:
    variables = check_variables(node.variables, context, only_objects=True)
    inner = _introduce(variables, "loop", scope.inside_foreach(), context)
    body = check_block(node.body, inner, section, context)
    return ForEach(variables, body, location=context.location(node.span))


def _for_range(
    node: syntax.ForRange, scope: Scope, section: Section, context: Context
) -> Statement:
    bounds = check_range(node, scope, context)
    check_not_hiding(node.variable, context)
    location = context.location(node.variable.span)
    variable = Parameter(node.variable.text, INT64, location=location)
    inner = _introduce((variable,), "loop", scope.inside_for(), context)
    body = check_block(node.body, inner, section, context)
    return ForRange(variable, *bounds, body, location=context.location(node.span))


def _if(
    node: syntax.If,
    branches: tuple[tuple[syntax.Expression, tuple[syntax.Statement, ...]], ...],
    scope: Scope,
    section: Section,
    context: Context,
) -> Statement:
    """The branches from the first on: `elif` becomes an `if` in the `else` of the one before."""
    (condition, then), *rest = branches
    checked = check_condition(condition, scope, context)
    then_block = check_block(then, scope, section, context)
    otherwise: tuple[Statement, ...] = ()
    if rest:
        otherwise = (_if(node, tuple(rest), scope, section, context),)
    elif node.otherwise is not None:
        otherwise = check_block(node.otherwise, scope, section, context)
    location = context.location(node.span)
    return If(checked, then_block, otherwise, location=location)
