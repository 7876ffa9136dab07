"""Calls as text, `r_clear(b, y=c)`: the steps that users give and that plans show."""

import re
from dataclasses import dataclass

from cdlc.diagnostics import suggest
from cdlc.plans.errors import BadStep
from cdlc.source import SourceFile, Span
from crow.problem import World
from crow.program import Behavior, Controller, Location, ObjectType, Parameter, Type
from crow.program.statements import Bind
from crow.program.types import BOOL, is_integer, is_number, underlying
from crow.program.walk import statements_within
from crow.values import Value

_NAME = r"[A-Za-z_][A-Za-z0-9_]*"
_VALUE = rf'{_NAME}|-?[0-9]+(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?|"[^"]*"|\[[^\]]*\]'
_ITEM = re.compile(rf"\s*(?:({_NAME})\s*=\s*)?({_VALUE})\s*")
_CALL = re.compile(rf"\s*({_NAME})\s*\((.*)\)\s*", re.DOTALL)


class BadStepError(Exception):
    """Carries the diagnostic of a step that cannot be read."""

    def __init__(self, diagnostic: BadStep) -> None:
        super().__init__(diagnostic.message())
        self.diagnostic = diagnostic


@dataclass(frozen=True, slots=True)
class CallText:
    """A call as written: values are still text; each has its place."""

    name: str
    positional: tuple[tuple[str, Location], ...]
    named: tuple[tuple[str, str, Location], ...]
    location: Location


def read_call(source: SourceFile, span: Span) -> CallText:
    """Split a call into its name and items. Raises BadStepError."""
    text = source.text[span.start : span.end]
    location = source.location(span)
    match = _CALL.fullmatch(text)
    if match is None:
        raise BadStepError(BadStep(location=location, reason="a step is `behavior(a, b, name=c)`"))
    positional, named = [], []
    position, end = match.start(2), match.end(2)
    while position < end:
        item = _ITEM.match(text, position, end)
        at = source.location(Span(span.start + position, span.start + end))
        if item is None or (item.end() < end and text[item.end()] != ","):
            raise BadStepError(BadStep(location=at, reason="expected a value, or `name=value`"))
        place = source.location(Span(span.start + item.start(2), span.start + item.end(2)))
        if item[1] is None:
            positional.append((item[2], place))
        else:
            named.append((item[1], item[2], place))
        position = item.end() + 1
    return CallText(match[1], tuple(positional), tuple(named), location)


@dataclass(frozen=True, slots=True)
class BehaviorCall:
    """A behavior with values for its parameters and for some of its binds."""

    behavior: Behavior
    arguments: tuple[Value, ...]
    bindings: dict[str, Value]


def resolve_behavior(call: CallText, world: World) -> BehaviorCall:
    """The behavior that a call names, its values checked against their types.

    Raises BadStepError for an unknown name, a wrong number of arguments or a wrong value.
    """
    behavior = world.behaviors.get(call.name)
    if behavior is None:
        raise BadStepError(_unknown(call, "behavior", list(world.behaviors)))
    arguments = _arguments(call, behavior.parameters, world)
    binds = {v.name: v for b in _binds(behavior) for v in b.variables}
    bindings: dict[str, Value] = {}
    for name, text, place in call.named:
        if name not in binds:
            reason = f"`{call.name}` binds no `{name}`"
            hints = suggest(name, list(binds), place)
            raise BadStepError(BadStep(location=place, reason=reason, hints=hints))
        bindings[name] = _value(text, binds[name].type, world, place)
    return BehaviorCall(behavior, arguments, bindings)


def resolve_controller(call: CallText, world: World) -> tuple[Controller, tuple[Value, ...]]:
    """The controller that a call names, with its arguments. Raises BadStepError."""
    controller = world.controllers.get(call.name)
    if controller is None:
        raise BadStepError(_unknown(call, "controller", list(world.controllers)))
    return controller, _arguments(call, controller.parameters, world)


def _unknown(call: CallText, kind: str, known: list[str]) -> BadStep:
    hints = suggest(call.name, known, call.location)
    return BadStep(location=call.location, reason=f"unknown {kind} `{call.name}`", hints=hints)


def _arguments(
    call: CallText, parameters: tuple[Parameter, ...], world: World
) -> tuple[Value, ...]:
    if len(call.positional) != len(parameters):
        plural = "" if len(parameters) == 1 else "s"
        given = len(call.positional)
        reason = f"`{call.name}` takes {len(parameters)} argument{plural}, not {given}"
        raise BadStepError(BadStep(location=call.location, reason=reason))
    return tuple(
        _value(text, parameter.type, world, place)
        for (text, place), parameter in zip(call.positional, parameters, strict=True)
    )


def _binds(behavior: Behavior) -> list[Bind]:
    members = () if behavior.promotable is None else behavior.promotable.members
    body = (*behavior.left, *members, *behavior.right)
    return [s for s in statements_within(body) if isinstance(s, Bind)]


def _value(text: str, type_: Type, world: World, place: Location) -> Value:
    """A value written as text, of the wanted type."""
    if isinstance(type_, ObjectType):
        if world.is_of(text, type_):
            return text
        reason = f"no object `{text}`"
        if text in world.objects:
            reason = f"`{text}` is a `{world.objects[text]}`, not a `{type_}`"
        hints = suggest(text, list(world.objects_of(type_)), place)
        raise BadStepError(BadStep(location=place, reason=reason, hints=hints))
    if underlying(type_) == BOOL and text in ("True", "False"):
        return text == "True"
    if is_number(type_) and text[:1] in "-0123456789":
        return int(text) if is_integer(type_) and text.lstrip("-").isdigit() else float(text)
    reason = f"`{text}` is no value of type `{type_}`"
    raise BadStepError(BadStep(location=place, reason=reason))
