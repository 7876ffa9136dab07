"""Traces in a plan's JSON, read back so that every item can be replayed (semantics.md §1)."""

from typing import Any

from cdlc.diagnostics import Collector
from cdlc.frontend import syntax
from cdlc.frontend.check import CheckedDomain
from cdlc.frontend.check_expressions import check_condition
from cdlc.frontend.parser import parse
from cdlc.frontend.scope import Context, Scope
from cdlc.source import SourceFile
from crow.problem import World
from crow.program import (
    BOOL,
    FLOAT64,
    INT64,
    UNKNOWN,
    Expression,
    Parameter,
    Type,
    VectorType,
)
from crow.trace import AssertItem, DoItem, EffItem, Trace, TraceItem
from crow.values import Value


class TraceFormatError(ValueError):
    """A trace item that cannot be read; the message says which and why."""


def read_trace(items: list[Any], domain: CheckedDomain, world: World) -> Trace:
    """The items of a trace, their conditions parsed and checked against the domain.

    Raises TraceFormatError.
    """
    trace = []
    for number, item in enumerate(items, 1):
        try:
            trace.append(_item(item, domain, world))
        except (KeyError, TypeError, AttributeError):
            raise TraceFormatError(
                f"item {number} of the trace is no `do`, `assert` or `eff`"
            ) from None
        except TraceFormatError as error:
            raise TraceFormatError(f"item {number} of the trace: {error}") from None
    return tuple(trace)


def _item(item: dict[str, Any], domain: CheckedDomain, world: World) -> TraceItem:
    match item:
        case {"do": str(name), "arguments": list(arguments)}:
            return DoItem(name, tuple(map(_value, arguments)))
        case {"assert": str(text), "variables": dict(variables)}:
            values = {name: _value(value) for name, value in variables.items()}
            return AssertItem(_condition(text, values, domain, world), values, text)
        case {"eff": str(owner), "variables": dict(variables)}:
            values = {name: _value(value) for name, value in variables.items()}
            return _effect(owner, values, world)
        case _:
            raise TypeError


def _effect(owner: str, values: dict[str, Value], world: World) -> EffItem:
    defined = world.behaviors.get(owner) or world.controllers.get(owner)
    if defined is None or defined.effect is None:
        raise TraceFormatError(f"`{owner}` has no effect")
    missing = [p.name for p in defined.parameters if p.name not in values]
    if missing:
        raise TraceFormatError(f"no value for `{missing[0]}` of `{owner}`")
    return EffItem(owner, defined.effect, defined.parameters, values)


def _condition(
    text: str, values: dict[str, Value], domain: CheckedDomain, world: World
) -> Expression:
    """Parse a condition as the goal of a file of its own, and check it with typed variables."""
    found = Collector()
    source = SourceFile("<trace>", f"goal: {text}\n")
    goals = [d for d in parse(source, found).definitions if isinstance(d, syntax.Goal)]
    if len(goals) != 1 or found.has_errors:
        raise TraceFormatError(f"`{text}` is no condition")
    scope = Scope()
    for name, value in values.items():
        scope = scope.add(Parameter(name, _type_of(value, world)), "parameter")
    context = Context(source, domain.declarations, found)
    condition = check_condition(goals[0].condition, scope, context)
    if found.has_errors:
        raise TraceFormatError(f"`{text}`: {found.sorted()[0].message()}")
    return condition


def _value(value: Any) -> Value:
    return tuple(map(_value, value)) if isinstance(value, list) else value


def _type_of(value: Value, world: World) -> Type:
    match value:
        case str() if value in world.objects:
            return world.objects[value]
        case bool():
            return BOOL
        case int():
            return INT64
        case float():
            return FLOAT64
        case tuple():
            return VectorType(FLOAT64, len(value))
        case _:
            return UNKNOWN
