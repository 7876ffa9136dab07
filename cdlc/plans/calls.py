"""Calls, `r_clear(b, y=c)`: as users and plans write them, and what they stand for."""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from cdlc.diagnostics import Help, suggest
from cdlc.plans.errors import BadStep
from cdlc.plans.values import read_text
from cdlc.source import SourceFile, Span
from crow.problem import World
from crow.program import Behavior, Controller, Location, Parameter, Type
from crow.program.statements import Bind, Call
from crow.program.walk import statements_within
from crow.reading import WrongValueError
from crow.values import Value

_NAME = r"[A-Za-z_][A-Za-z0-9_]*"
_VALUE = rf'{_NAME}|-?[0-9]+(?:\.[0-9]*)?(?:[eE][+-]?[0-9]+)?|"[^"]*"|\[[^\]]*\]'
_ITEM = re.compile(rf"\s*(?:({_NAME})\s*=\s*)?({_VALUE})\s*")
_CALL = re.compile(rf"\s*({_NAME})\s*\((.*)\)\s*", re.DOTALL)

Reader = Callable[[Any, Type, World], Value]
"""From a value as written to one of a type. Raises WrongValueError."""


class BadStepError(Exception):
    """Carries the diagnostic of a step that cannot be read."""

    def __init__(self, location: Location, reason: str, hints: tuple[Help, ...] = ()) -> None:
        super().__init__(reason)
        self.diagnostic = BadStep(location=location, reason=reason, hints=hints)


@dataclass(frozen=True, slots=True)
class WrittenCall:
    """A call as written: its values have to be read yet; each has its place."""

    name: str
    positional: tuple[tuple[Any, Location], ...]
    named: tuple[tuple[str, Any, Location], ...]
    location: Location
    read: Reader


def read_call(source: SourceFile, span: Span) -> WrittenCall:
    """Split a call into its name and items. Raises BadStepError."""
    text = source.text[span.start : span.end]
    location = source.location(span)
    match = _CALL.fullmatch(text)
    if match is None:
        raise BadStepError(location, "a step is `behavior(a, b, name=c)`")
    positional, named = [], []
    position, end = match.start(2), match.start(2) + len(match[2].rstrip())
    while position < end:
        item = _ITEM.match(text, position, end)
        if item is None or (item.end() < end and text[item.end()] != ","):
            at = source.location(Span(span.start + position, span.start + end))
            raise BadStepError(at, "expected a value, or `name=value`")
        place = source.location(Span(span.start + item.start(2), span.start + item.end(2)))
        if item[1] is None:
            positional.append((item[2], place))
        else:
            named.append((item[1], item[2], place))
        position = item.end() + 1
    return WrittenCall(match[1], tuple(positional), tuple(named), location, read_text)


@dataclass(frozen=True, slots=True)
class BehaviorCall:
    """A behavior with values for its parameters and for some of its binds."""

    behavior: Behavior
    arguments: tuple[Value, ...]
    bindings: dict[str, Value]


def resolve_behavior(call: WrittenCall, world: World) -> BehaviorCall:
    """The behavior that a call names, its values checked against their types.

    Raises BadStepError for an unknown name, a wrong number of arguments or a wrong value.
    """
    behavior = world.behaviors.get(call.name)
    if behavior is None:
        raise _unknown(call, "behavior", list(world.behaviors))
    arguments = _arguments(call, behavior.parameters, world)
    binds = list(_bound(behavior, world))
    bindings: dict[str, Value] = {}
    for name, written, place in call.named:
        if name in bindings:
            raise BadStepError(place, f"`{name}` is given twice")
        types = [v.type for v in binds if re.fullmatch(rf"{v.name}(_[0-9]+)?", name)]
        if not types:
            hints = suggest(name, [v.name for v in binds], place)
            raise BadStepError(place, f"`{call.name}` binds no `{name}`", hints)
        bindings[name] = _first_fitting(call, written, types, world, place)
    return BehaviorCall(behavior, arguments, bindings)


def resolve_controller(call: WrittenCall, world: World) -> tuple[Controller, tuple[Value, ...]]:
    """The controller that a call names, with its arguments. Raises BadStepError."""
    controller = world.controllers.get(call.name)
    if controller is None:
        raise _unknown(call, "controller", list(world.controllers))
    if call.named:
        raise BadStepError(call.named[0][2], "arguments of a controller have no names")
    return controller, _arguments(call, controller.parameters, world)


def _unknown(call: WrittenCall, kind: str, known: list[str]) -> BadStepError:
    hints = suggest(call.name, known, call.location)
    return BadStepError(call.location, f"unknown {kind} `{call.name}`", hints)


def _arguments(
    call: WrittenCall, parameters: tuple[Parameter, ...], world: World
) -> tuple[Value, ...]:
    if len(call.positional) != len(parameters):
        plural = "" if len(parameters) == 1 else "s"
        given = len(call.positional)
        reason = f"`{call.name}` takes {len(parameters)} argument{plural}, not {given}"
        raise BadStepError(call.location, reason)
    return tuple(
        _first_fitting(call, written, [parameter.type], world, place)
        for (written, place), parameter in zip(call.positional, parameters, strict=True)
    )


def _bound(behavior: Behavior, world: World) -> Iterator[Parameter]:
    """The variables of the binds of a behavior, and of those it calls."""
    for statement in statements_within(behavior.body):
        match statement:
            case Bind(variables=variables):
                yield from variables
            case Call(behavior=name):
                yield from _bound(world.behaviors[name], world)
            case _:
                pass


def _first_fitting(
    call: WrittenCall, written: Any, types: list[Type], world: World, place: Location
) -> Value:
    """A value of the first type that it is of; two binds of one name may differ in theirs."""
    for type_ in types[:-1]:
        try:
            return call.read(written, type_, world)
        except WrongValueError:
            continue
    try:
        return call.read(written, types[-1], world)
    except WrongValueError as error:
        hints = suggest(str(written), list(error.known), place)
        raise BadStepError(place, str(error), hints) from None
