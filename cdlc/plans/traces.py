"""Traces in a plan's JSON, read back so that every item can be replayed (semantics.md §1)."""

from collections.abc import Mapping, Sequence

from cdlc.diagnostics import Collector
from cdlc.frontend import syntax
from cdlc.frontend.check import CheckedDomain
from cdlc.frontend.check_expressions import check_condition, check_number
from cdlc.frontend.parser import parse
from cdlc.frontend.scope import Context, Scope
from cdlc.source import SourceFile
from crow.problem import World
from crow.program import (
    BOOL,
    FLOAT64,
    INT64,
    PYOBJECT,
    STRING,
    Behavior,
    Bind,
    Controller,
    Expression,
    Let,
    Parameter,
    Type,
    VectorType,
)
from crow.program.walk import expressions_of, free_variables, statements_within
from crow.reading import WrongValueError, read_json
from crow.trace import AssertItem, DoItem, EffItem, Trace, TraceItem
from crow.values import Value


class TraceFormatError(ValueError):
    """A trace item that cannot be read; the message says which and why."""


def read_trace(items: object, domain: CheckedDomain, world: World) -> Trace:
    """The items of a trace, their conditions parsed and checked against the domain.

    Raises TraceFormatError.
    """
    if not isinstance(items, list):
        raise TraceFormatError("the trace is no list")
    trace = []
    for number, item in enumerate(items, 1):
        try:
            trace.append(_item(item, domain, world))
        except (TraceFormatError, WrongValueError) as error:
            raise TraceFormatError(f"item {number} of the trace: {error}") from None
        except RecursionError:
            raise TraceFormatError(f"item {number} of the trace is nested too deeply") from None
    return tuple(trace)


def _item(item: object, domain: CheckedDomain, world: World) -> TraceItem:
    match item:
        case {"do": str(name), "arguments": list(arguments)}:
            return _do(name, arguments, world)
        case {"assert": str(text), "variables": dict(variables)}:
            typed = {n: typed_value(n, value, world) for n, value in variables.items()}
            values = {name: value for name, (value, _) in typed.items()}
            types = {name: type_ for name, (_, type_) in typed.items()}
            return AssertItem(read_condition(text, types, domain), values, text)
        case {"eff": str(owner), "variables": dict(variables)}:
            return _effect(owner, variables, world)
        case _:
            raise TraceFormatError("no `do`, `assert` or `eff`")


def _do(name: str, arguments: list[object], world: World) -> DoItem:
    controller = world.controllers.get(name)
    if controller is None:
        raise TraceFormatError(f"no controller `{name}`")
    if len(arguments) != len(controller.parameters):
        wanted = len(controller.parameters)
        raise TraceFormatError(f"`{name}` takes {wanted} arguments, not {len(arguments)}")
    pairs = zip(arguments, controller.parameters, strict=True)
    return DoItem(name, tuple(read_json(a, p.type, world) for a, p in pairs))


def _effect(owner: str, variables: dict[str, object], world: World) -> EffItem:
    defined = world.behaviors.get(owner) or world.controllers.get(owner)
    if defined is None or defined.effect is None:
        raise TraceFormatError(f"`{owner}` has no effect")
    types = _visible(defined)
    used = {
        name
        for statement in statements_within(defined.effect)
        for expression in expressions_of(statement)
        for name in free_variables(expression)
    }
    needed = {p.name for p in defined.parameters} | (used & types.keys())
    for name in types:
        if name in needed and name not in variables:
            raise TraceFormatError(f"no value for `{name}` of `{owner}`")
    values = {n: read_json(v, types[n], world) for n, v in variables.items() if n in types}
    return EffItem(owner, defined.effect, defined.parameters, values)


def _visible(owner: Behavior | Controller) -> dict[str, Type]:
    """The variables that an effect sees: parameters, and what the body binds at its top level."""
    types = {p.name: p.type for p in owner.parameters}
    for statement in owner.body if isinstance(owner, Behavior) else ():
        match statement:
            case Bind(variables=variables):
                types |= {v.name: v.type for v in variables}
            case Let(variable=variable):
                types[variable.name] = variable.type
            case _:
                pass
    return types


def read_condition(text: str, variables: Mapping[str, Type], domain: CheckedDomain) -> Expression:
    """Parse a condition as the goal of a file of its own, and check it with typed variables.

    Raises TraceFormatError.
    """
    return _read(text, variables, domain, "goal", "condition")


def read_number(text: str, variables: Mapping[str, Type], domain: CheckedDomain) -> Expression:
    """Parse a number, as `read_condition` does a condition. Raises TraceFormatError."""
    return _read(text, variables, domain, "minimize", "number")


def _read(
    text: str, variables: Mapping[str, Type], domain: CheckedDomain, section: str, kind: str
) -> Expression:
    found = Collector()
    source = SourceFile("<trace>", f"{section}: {text}\n")
    scope = Scope()
    for name, type_ in variables.items():
        scope = scope.add(Parameter(name, type_), "parameter")
    context = Context(source, domain.declarations, found)
    definitions = parse(source, found).definitions
    checked: Expression | None = None
    if not found.has_errors:
        match definitions:
            case (syntax.Goal(condition=written, equals=None),) if section == "goal":
                checked = check_condition(written, scope, context)
            case (syntax.Minimize(expression=written),) if section == "minimize":
                checked = check_number(written, scope, context)
    if checked is None:
        raise TraceFormatError(f"`{text:.200}` is no {kind}")
    if found.has_errors:
        raise TraceFormatError(f"`{text:.200}`: {found.sorted()[0].message()}")
    return checked


def typed_value(name: str, value: object, world: World) -> tuple[Value, Type]:
    """A value of no declared type, with the type it has by its looks."""
    match value:
        case str() if value in world.objects:
            type_: Type = world.objects[value]
        case bool():
            type_ = BOOL
        case int():
            type_ = INT64
        case float():
            type_ = FLOAT64
        case str():
            type_ = STRING
        case [list() | tuple(), *_]:
            type_ = PYOBJECT
        case list() | tuple():
            type_ = VectorType(_element_type(value), len(value))
        case _:
            raise TraceFormatError(f"`{name}` has no value of CDL")
    return read_json(value, type_, world), type_


def _element_type(items: Sequence[object]) -> Type:
    """The type of a vector's elements: whole numbers fit where any number is wanted."""
    if all(isinstance(item, str) for item in items) and items:
        return STRING
    is_whole = all(isinstance(item, int) and not isinstance(item, bool) for item in items)
    return INT64 if is_whole else FLOAT64
