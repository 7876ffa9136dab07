"""Plans of PDDL planners as transitions of the CDL program."""

import re
from collections.abc import Mapping
from dataclasses import dataclass

from cdlc.backends.pddl.actions import Source
from cdlc.backends.pddl.emit import PddlTask
from cdlc.backends.pddl.parts import Part
from crow.problem import World
from crow.program import Behavior, Parameter, Type
from crow.values import Value


@dataclass(frozen=True, slots=True)
class PlannedTransition:
    """A part of a behavior with arguments and binds; `also` are other behaviors it might have been.

    Of a part that goes on with what another has begun, the binds include its locals.
    """

    part: Part
    arguments: tuple[Value, ...]
    bindings: Mapping[str, Value]
    also: tuple[str, ...] = ()

    @property
    def behavior(self) -> Behavior:
        """The behavior it is a part of."""
        return self.part.whole


class PlanFormatError(ValueError):
    """A line of a plan that names no action or object of the task; `line` counts from 1."""

    def __init__(self, message: str, line: int) -> None:
        super().__init__(message)
        self.line = line


def read_plan(text: str) -> list[tuple[int, str, tuple[str, ...]]]:
    """The steps of a PDDL plan, `(stack a b)` a line, with their line numbers.

    Comments from `;` on and times before a step are dropped. Raises PlanFormatError.
    """
    steps = []
    for number, line in enumerate(text.split("\n"), 1):
        content = re.sub(r"^\s*\d+(\.\d+)?\s*:", "", line.split(";")[0]).strip()
        content = re.sub(r"\[[\d.]+\]\s*$", "", content).strip()
        if not content:
            continue
        match = re.fullmatch(r"\(\s*([^\s()]+)((?:\s+[^\s()]+)*)\s*\)", content)
        if match is None:
            raise PlanFormatError(f"not a step of a PDDL plan: `{content}`", number)
        steps.append((number, match[1], tuple(match[2].split())))
    return steps


def to_step(
    task: PddlTask, world: World, action: str, arguments: tuple[str, ...], line: int
) -> PlannedTransition:
    """The behavior behind a PDDL step: the first in source order that the action stands for.

    Raises PlanFormatError for an unknown action or object, or a wrong number of arguments.
    """
    found = task.actions_by_name.get(action.lower())
    if found is None:
        raise PlanFormatError(f"no action `{action}` in the emitted domain", line)
    if len(arguments) != len(found.parameters):
        wanted = len(found.parameters)
        raise PlanFormatError(f"`{action}` takes {wanted} arguments, not {len(arguments)}", line)
    first, *others = found.sources
    used = {c.parameter for source in found.sources for c in source.variables}
    values = {
        parameter.name: _object(task, world, name, parameter.type, line)
        for parameter, name in zip(found.parameters, arguments, strict=True)
        if parameter.name in used  # others only hold what is read
    }
    return _transition(world, first, values, tuple(o.behavior for o in others), line)


def _object(task: PddlTask, world: World, name: str, type_: Type, line: int) -> str:
    origin = task.names.origin("object", name)
    if origin is None:
        raise PlanFormatError(f"no object `{name}` in the problem", line)
    if not world.is_of(origin, type_):
        own = world.objects[origin]
        raise PlanFormatError(f"`{name}` is a `{own}`, not a `{type_}`", line)
    return origin


def _transition(
    world: World, source: Source, values: dict[str, str], also: tuple[str, ...], line: int
) -> PlannedTransition:
    behavior = source.part.whole
    own: dict[str, str] = {}
    for chosen in source.variables:
        variable = chosen.variable
        if chosen.parameter is not None:
            own[variable.name] = values[chosen.parameter]
        elif chosen.object is not None:
            own[variable.name] = chosen.object
        else:
            own[variable.name] = _any_object(world, behavior.name, variable, line)
    arguments = tuple(
        own.pop(p.name) if p.name in own else _any_object(world, behavior.name, p, line)
        for p in behavior.parameters
    )
    return PlannedTransition(source.part, arguments, own, also)


def _any_object(world: World, behavior: str, variable: Parameter, line: int) -> str:
    """What the transition does not depend on may be any object of its type."""
    objects = world.objects_of(variable.type)
    if not objects:
        needed = f"`{behavior}` needs an object of type `{variable.type}`"
        raise PlanFormatError(f"{needed}, and there is none", line)
    return objects[0]
