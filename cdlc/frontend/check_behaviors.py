"""Controllers, behaviors, generators and derived functions: their sections put together."""

from typing import Literal

from cdlc.frontend import errors, syntax
from cdlc.frontend.annotations import Owner, check_annotations
from cdlc.frontend.check_expressions import check_condition, check_number
from cdlc.frontend.check_statements import check_block, check_sequence
from cdlc.frontend.check_writes import check_writes
from cdlc.frontend.scope import Context, Scope
from cdlc.frontend.sections import Section
from cdlc.source import Span
from crow.program import (
    UNKNOWN,
    Achieve,
    Assert,
    Behavior,
    Bind,
    Break,
    Call,
    Commit,
    Compare,
    Constant,
    Continue,
    Controller,
    Do,
    Expression,
    ForEach,
    ForRange,
    Function,
    Generator,
    Group,
    If,
    Let,
    Not,
    Object,
    Parameter,
    Promotable,
    Read,
    Return,
    Statement,
    Variable,
)
from crow.program.expressions import Apply
from crow.program.walk import statements_within

_SECTIONS = {
    "controller": ("eff",),
    "behavior": ("goal", "body", "eff"),
    "action": ("goal", "body", "eff"),
    "generator": ("goal", "in", "out"),
}


def check_controller(node: syntax.Procedure, context: Context) -> Controller:
    """A controller with its effect, if it carries one."""
    declared = context.declarations.controllers[node.name.text]
    sections = _by_name(node, context)
    return Controller(
        declared.name,
        declared.parameters,
        _effect(sections.get("eff"), _scope_of(declared.parameters), context),
        annotations=check_annotations(node.annotations, "controller", context),
        location=context.location(node.name.span),
    )


def check_behavior(node: syntax.Procedure, context: Context) -> Behavior:
    """A behavior as `<L, M, R>` with goal and effect (App. A)."""
    signature = context.declarations.behaviors[node.name.text]
    scope = _scope_of(signature.parameters)
    sections = _by_name(node, context)
    goal = _goal(sections.get("goal"), scope, context)
    body = sections.get("body")
    statements = body.statements if isinstance(body, syntax.Body) else ()
    left, promotable, right, after = _split(statements, scope, context)
    return Behavior(
        node.name.text,
        signature.parameters,
        goal,
        left,
        promotable,
        right,
        _effect(sections.get("eff"), after, context),
        annotations=check_annotations(node.annotations, "behavior", context),
        location=context.location(node.name.span),
    )


def check_generator(node: syntax.Procedure, context: Context) -> Generator | None:
    """A generator: `in:` and `out:` name parameters of its own."""
    signature = context.declarations.generators[node.name.text]
    scope = _scope_of(signature.parameters)
    sections = _by_name(node, context)
    goal = _goal(sections.get("goal"), scope, context, is_generator=True)
    location = context.location(node.name.span)
    names = {word: _directions(sections.get(word), scope, context) for word in ("in", "out")}
    if goal is None:
        if not _has_error_section(node):
            context.found.add(errors.MissingSection(location=location, section="goal"))
        return None
    if not names["out"] and not _has_error_section(node):
        context.found.add(errors.MissingSection(location=location, section="out"))
    elif all(scope.get(name) is not None for name in (*names["in"], *names["out"])):
        _check_directions(signature.parameters, names, context)
    return Generator(
        node.name.text,
        signature.parameters,
        goal,
        names["in"],
        names["out"],
        annotations=check_annotations(node.annotations, "generator", context),
        location=context.location(node.name.span),
    )


def check_function(node: syntax.Function, context: Context) -> Function:
    """A function; a derived one must return on every path."""
    declared = context.declarations.functions[node.name.text]
    owner: Owner = "external function" if node.body is None else "derived function"
    body = None
    if node.body is not None:
        section = Section("function", declared.type)
        before = context.found.errors
        body = check_block(node.body, _scope_of(declared.parameters), section, context)
        _report_returns_in_foreach(body, context)
        # After another mistake a path may seem to end without `return`.
        clean = context.found.errors == before and not _has_errors(node.body)
        if not _returns(body) and clean:
            location = context.location(node.name.span)
            context.found.add(errors.MissingReturn(location=location, name=declared.name))
    return Function(
        declared.name,
        declared.parameters,
        declared.type,
        body,
        annotations=check_annotations(node.annotations, owner, context),
        location=declared.location,
    )


def _scope_of(parameters: tuple[Parameter, ...]) -> Scope:
    scope = Scope()
    for parameter in parameters:
        scope = scope.add(parameter, "parameter")
    return scope


def _has_errors(statements: tuple[syntax.Statement, ...]) -> bool:
    for statement in statements:
        match statement:
            case syntax.ErrorStatement():
                return True
            case syntax.If(branches=branches, otherwise=otherwise):
                blocks = [*(block for _, block in branches), otherwise or ()]
                if any(map(_has_errors, blocks)):
                    return True
            case syntax.ForEach(body=body) | syntax.ForRange(body=body):
                if _has_errors(body):
                    return True
            case _:
                pass
    return False


def _returns(statements: tuple[Statement, ...]) -> bool:
    """Whether every way through the statements ends in `return`."""
    for statement in statements:
        match statement:
            case Return():
                return True
            case If(then=then, otherwise=otherwise):
                if _returns(then) and _returns(otherwise):
                    return True
            case ForRange(body=body, start=start, stop=stop, step=step):
                runs = len(range(start, stop, step)) > 0
                if runs and _returns(body) and not _is_left_early(body):
                    return True
            case _:
                pass
    return False


def _is_left_early(body: tuple[Statement, ...]) -> bool:
    """Whether a `break` or `continue` of this loop may come before its `return`."""
    for statement in body:
        match statement:
            case Break() | Continue():
                return True
            case If(then=then, otherwise=otherwise):
                if _is_left_early(then) or _is_left_early(otherwise):
                    return True
            case Return():
                return False
            case _:
                pass
    return False


def _report_returns_in_foreach(body: tuple[Statement, ...], context: Context) -> None:
    for loop in statements_within(body):
        if isinstance(loop, ForEach):
            for statement in statements_within(loop.body):
                if isinstance(statement, Return) and statement.location is not None:
                    context.found.add(errors.ReturnInForeach(location=statement.location))


# ---------------------------------------------------------------------------------------- sections


def _by_name(node: syntax.Procedure, context: Context) -> dict[str, syntax.Section]:
    """The sections of a definition; a second one and one of another kind are reported."""
    allowed = _SECTIONS[node.keyword]
    sections: dict[str, syntax.Section] = {}
    for section in node.sections:
        name = _section_name(section)
        if name is None:
            continue
        location = context.location(section.span)
        if name not in allowed:
            context.found.add(
                errors.MisplacedSection(
                    location=location, section=name, owner=node.keyword, allowed=allowed
                )
            )
        elif name in sections:
            first = context.location(sections[name].span)
            context.found.add(errors.DuplicateSection(location=location, section=name, first=first))
        else:
            sections[name] = section
    return sections


def _section_name(section: syntax.Section) -> str | None:
    match section:
        case syntax.Goal():
            return "goal"
        case syntax.Body():
            return "body"
        case syntax.Effect():
            return "eff"
        case syntax.Direction(keyword=keyword):
            return keyword
        case syntax.ErrorStatement():
            return None


def _effect(
    section: syntax.Section | None, scope: Scope, context: Context
) -> tuple[Statement, ...] | None:
    if not isinstance(section, syntax.Effect):
        return None
    statements = check_block(section.statements, scope, Section("effect"), context)
    check_writes(statements, context.found)
    return statements


def _directions(section: syntax.Section | None, scope: Scope, context: Context) -> tuple[str, ...]:
    if not isinstance(section, syntax.Direction):
        return ()
    for name in section.names:
        if scope.get(name.text) is None:
            location = context.location(name.span)
            context.found.add(
                errors.UnknownName(
                    location=location, name=name.text, known=list(scope), what="parameter"
                )
            )
    return tuple(name.text for name in section.names)


def _check_directions(
    parameters: tuple[Parameter, ...], names: dict[str, tuple[str, ...]], context: Context
) -> None:
    """Each parameter of a generator is an input or an output."""
    for parameter in parameters:
        known, found = parameter.name in names["in"], parameter.name in names["out"]
        if known == found and parameter.location is not None:
            context.found.add(
                errors.BadDirection(location=parameter.location, name=parameter.name, is_both=known)
            )


def _has_error_section(node: syntax.Procedure) -> bool:
    return any(isinstance(section, syntax.ErrorStatement) for section in node.sections)


# -------------------------------------------------------------------------------------------- goal


def check_goal(
    section: syntax.Goal, scope: Scope, context: Context, *, is_generator: bool = False
) -> Expression:
    """The condition of a `goal:`; the paper writes the equation of a generator with one `=`."""
    if section.equals is None:
        return check_condition(section.condition, scope, context)
    left, right = section.condition.span, section.equals.span
    if not is_generator:
        sign = context.source.text.index("=", left.end)
        location = context.location(Span(sign, sign + 1))
        context.found.add(errors.EqualsInGoal(location=location))
    whole = Span(left.start, right.end)
    operands = (section.condition, section.equals)
    return check_condition(syntax.Comparison(("==",), operands, span=whole), scope, context)


def _goal(
    section: syntax.Section | None, scope: Scope, context: Context, *, is_generator: bool = False
) -> Expression | None:
    if not isinstance(section, syntax.Goal):
        return None
    goal = check_goal(section, scope, context, is_generator=is_generator)
    if goal.type != UNKNOWN and (reason := _why_no_goal(goal)) is not None:
        location = context.location(section.condition.span)
        context.found.add(errors.UnsupportedGoal(location=location, reason=reason))
    return goal


def _why_no_goal(goal: Expression) -> str | None:
    """What keeps an expression from being one literal, value equation or comparison."""
    match goal:
        case Not(operand=Read() | Apply() as read):
            return _why_no_term(read)
        case Read() | Apply():
            return _why_no_term(goal)
        case Compare(left=left, right=right):
            sides = [s for s in (left, right) if isinstance(s, Read | Apply)]
            if not sides:
                return "neither side reads a feature"
            others = [s for s in (left, right) if s is not sides[0]]
            return _why_no_term(sides[0]) or _why_no_argument(others[0])
        case Constant(type=type_) if type_ == UNKNOWN:
            return None
        case _:
            return "more than one literal"


def _why_no_term(term: Read | Apply) -> str | None:
    return next((r for r in map(_why_no_argument, term.arguments) if r is not None), None)


def _why_no_argument(argument: Expression) -> str | None:
    match argument:
        case Variable() | Object() | Constant():
            return None
        case _:
            return "an argument is neither a parameter nor a constant"


# -------------------------------------------------------------------------------------------- body

Split = tuple[tuple[Statement, ...], Promotable | None, tuple[Statement, ...], Scope]


def _split(statements: tuple[syntax.Statement, ...], scope: Scope, context: Context) -> Split:
    """A body as L, M and R; without a promotable section everything is R."""
    section = Section("body")
    index = next((i for i, s in enumerate(statements) if isinstance(s, syntax.Promotable)), None)
    if index is None:
        right, after = check_sequence(statements, scope, section, context)
        return (), None, right, after
    marker = statements[index]
    assert isinstance(marker, syntax.Promotable)
    left, scope = check_sequence(statements[:index], scope, section, context)
    # A `bind` or `let` in M is reported below, and still visible, so that it is one mistake.
    members, scope = check_sequence(marker.body, scope, section, context)
    right, after = check_sequence(statements[index + 1 :], scope, section, context)
    members, calls = _trailing_calls(members)
    for member in members:
        _check_member(member, context)
    if marker.order == "alternative":
        location = context.location(marker.span)
        reason = "`promotable:` is `unordered` or `sequential`"
        context.found.add(errors.MisplacedPromotable(location=location, reason=reason))
    order: Literal["sequential", "unordered"] = "unordered"
    if marker.order == "sequential":
        order = "sequential"
    promotable = Promotable(order, members, location=context.location(marker.span))
    return left, promotable, (*calls, *right), after


def _trailing_calls(
    members: tuple[Statement, ...],
) -> tuple[tuple[Statement, ...], tuple[Statement, ...]]:
    """Controller calls that end a promotable section are the beginning of R (semantics.md §2)."""
    end = len(members)
    while end > 0 and isinstance(members[end - 1], Do):
        end -= 1
    return members[:end], members[end:]


def _check_member(member: Statement, context: Context) -> None:
    match member:
        case Achieve() | Assert() | Call():
            return
        case Group(body=body) | ForEach(body=body):
            for inner in body:
                _check_member(inner, context)
        case If(then=then, otherwise=otherwise):
            for inner in (*then, *otherwise):
                _check_member(inner, context)
        case _:
            statement, move = _unpromotable(member)
            assert member.location is not None
            context.found.add(
                errors.NotPromotable(location=member.location, statement=statement, move=move)
            )


def _unpromotable(member: Statement) -> tuple[str, str]:
    match member:
        case Bind():
            return "`bind`", "before"
        case Let():
            return "`let`", "before"
        case Commit():
            return "`commit`", "before or after"
        case Do():
            return "a controller call followed by others", "after"
        case _:
            return "a loop over a range", "before or after"


def check_open_value(node: syntax.Expression, context: Context) -> Expression:
    """A number without locals, such as what a problem minimizes."""
    return check_number(node, Scope(), context)
