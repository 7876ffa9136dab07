"""Statements of bodies, effects, derived functions and `init` (language.md §3)."""

from collections.abc import Callable
from dataclasses import replace

from cdlc.frontend import errors, syntax
from cdlc.frontend.annotations import check_annotations
from cdlc.frontend.check_assignments import check_assignment
from cdlc.frontend.check_binds import check_bind, check_let
from cdlc.frontend.check_expressions import check_arguments, check_condition, check_value
from cdlc.frontend.check_facts import check_fact
from cdlc.frontend.check_types import check_not_hiding, check_variables, introduce
from cdlc.frontend.ranges import check_range, copies
from cdlc.frontend.scope import Context, Loop, Scope
from cdlc.frontend.sections import Section, misplaced, report_misplaced
from crow.program import (
    INT64,
    UNKNOWN,
    Achieve,
    Assert,
    Break,
    Call,
    Commit,
    Continue,
    Do,
    ForEach,
    ForRange,
    Group,
    If,
    Parameter,
    Return,
    Statement,
)


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
    has_facts = section.kind == "init" and not scope.locals
    for statement in statements:
        if has_facts and (fact := check_fact(statement, context)) is not None:
            checked.append(fact)
            continue
        typed, scope = _check_statement(statement, scope, section, context)
        if typed is None:
            continue
        if statement.annotations:
            typed = replace(
                typed, annotations=check_annotations(statement.annotations, "statement", context)
            )
        checked.append(typed)
    return tuple(checked), scope


Checked = tuple[Statement | None, Scope]


def _check_statement(
    node: syntax.Statement, scope: Scope, section: Section, context: Context
) -> Checked:
    if (wrong := misplaced(node, section)) is not None:
        what, advice = wrong
        report_misplaced(node, what, section, advice, context)
        return None, scope
    match node:
        case syntax.Let():
            return check_let(node, scope, context)
        case syntax.Bind():
            return check_bind(node, scope, context)
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
            return check_assignment(node, scope, section, context)
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
    inner = introduce(variables, "loop", scope.inside_foreach(), context)
    body = check_block(node.body, inner, section, context)
    return ForEach(variables, body, location=context.location(node.span))


def _for_range(
    node: syntax.ForRange, scope: Scope, section: Section, context: Context
) -> Statement:
    bounds = check_range(node, scope, context)
    loop = Loop(context.location(node.span), copies(bounds))
    check_not_hiding(node.variable, context)
    location = context.location(node.variable.span)
    type_ = INT64 if node.function.text == "range" else UNKNOWN
    variable = Parameter(node.variable.text, type_, location=location)
    inner = introduce((variable,), "loop", scope.inside_for(loop), context)
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
