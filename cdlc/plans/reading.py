"""Plans in files, as text, as JSON or in PDDL: their steps, and the trace of one in JSON."""

import json
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from cdlc.backends.pddl.emit import PddlTask
from cdlc.backends.pddl.plans import PlanFormatError, PlannedTransition, read_plan, to_step
from cdlc.plans.calls import (
    BadStepError,
    WrittenCall,
    read_call,
    resolve_behavior,
    resolve_controller,
)
from cdlc.source import SourceFile, Span
from crow.plan import call_text
from crow.problem import World
from crow.program import Behavior, Location
from crow.reading import read_json
from crow.values import Value

Call = tuple[str, tuple[Value, ...]]


@dataclass(frozen=True, slots=True)
class PlanStep:
    """A behavior to apply, and the controller call the plan claims for it, if it claims one.

    `calls` is empty for a behavior that runs none, and None in a PDDL plan, which names none and
    has `planned` instead.
    """

    behavior: Behavior
    arguments: tuple[Value, ...]
    bindings: dict[str, Value]
    calls: tuple[Call, ...] | None
    text: str
    location: Location
    planned: PlannedTransition | None = None

    def is_same_application(self, other: "PlanStep") -> bool:
        """Whether two steps are of one behavior with the same arguments and binds."""
        mine = (self.behavior.name, self.arguments, self.bindings)
        return mine == (other.behavior.name, other.arguments, other.bindings)


@dataclass(frozen=True, slots=True)
class WrittenPlan:
    """The steps of a plan, and the items of the trace it carries, still as JSON."""

    steps: tuple[PlanStep, ...]
    trace: object = None


def read(source: SourceFile, world: World, task: Callable[[], PddlTask]) -> WrittenPlan:
    """A plan in any of the three forms; `task` makes the PDDL that names of a PDDL plan are from.

    Raises BadStepError.
    """
    if source.text.lstrip().startswith("{"):
        return _read_json(source, world)
    if _is_pddl(source.text):
        return WrittenPlan(tuple(_read_pddl(source, world, task())))
    return WrittenPlan(tuple(_read_text(source, world)))


def line_of(source: SourceFile, number: int) -> Location:
    """A whole line, counted from 1."""
    width = len(source.line(number))
    return Location(source.name, number, 1, number, width + 1)


def _is_pddl(text: str) -> bool:
    """Whether a plan's first step is written as PDDL."""
    lines = (line.split(";")[0].strip() for line in text.split("\n"))
    first = next((line for line in lines if line), "")
    return re.match(r"([0-9]+(\.[0-9]+)?\s*:)?\s*\(", first) is not None


def _step(call: WrittenCall, world: World, text: str, claimed: tuple[Call, ...] | None) -> PlanStep:
    found = resolve_behavior(call, world)
    return PlanStep(found.behavior, found.arguments, found.bindings, claimed, text, call.location)


# ------------------------------------------------------------------------------------------- text

# A line that ends in a parenthesis; so neither part can be tried in more than one way.
_TEXT_STEP = re.compile(r"(?:[0-9]+\.\s*)?(?P<call>-|.*?\))\s+by\s+(?P<behavior>.*\))")


def _read_text(source: SourceFile, world: World) -> Iterator[PlanStep]:
    start = 0
    for line in source.text.split("\n"):
        content = line.split("#")[0].rstrip()
        indentation = len(content) - len(content.lstrip())
        if content:
            begin = start + indentation
            yield _text_step(source, Span(begin, start + len(content)), world)
        start += len(line) + 1


def _text_step(source: SourceFile, span: Span, world: World) -> PlanStep:
    content = source.text[span.start : span.end]
    match = _TEXT_STEP.fullmatch(content) if content.endswith(")") else None
    if match is None:
        reason = "a step is `controller(a) by behavior(a, bind=b)`"
        raise BadStepError(source.location(span), reason)
    claimed: tuple[Call, ...] = ()
    if match["call"] != "-":
        place = Span(span.start + match.start("call"), span.start + match.end("call"))
        controller, arguments = resolve_controller(read_call(source, place), world)
        claimed = ((controller.name, arguments),)
    place = Span(span.start + match.start("behavior"), span.start + match.end("behavior"))
    return _step(read_call(source, place), world, match["behavior"], claimed)


# ------------------------------------------------------------------------------------------- PDDL


def _read_pddl(source: SourceFile, world: World, task: PddlTask) -> Iterator[PlanStep]:
    try:
        for line, action, arguments in read_plan(source.text):
            planned = to_step(task, world, action, arguments, line)
            yield PlanStep(
                planned.behavior,
                planned.arguments,
                dict(planned.bindings),
                None,
                source.line(line).strip(),
                line_of(source, line),
                planned,
            )
    except PlanFormatError as error:
        raise BadStepError(line_of(source, error.line), str(error)) from None


# ------------------------------------------------------------------------------------------- JSON


def _read_json(source: SourceFile, world: World) -> WrittenPlan:
    start = Location(source.name, 1, 1, 1, 1)
    try:
        document = json.loads(source.text)
    except (ValueError, RecursionError):
        raise BadStepError(start, "the plan is no JSON") from None
    match document:
        case {"steps": list(items)}:
            steps = tuple(_json_step(i, item, start, world) for i, item in enumerate(items, 1))
            return WrittenPlan(steps, document.get("trace"))
        case _:
            raise BadStepError(start, "the plan is no JSON that `cdlc plan` prints: no `steps`")


def _json_step(number: int, item: object, start: Location, world: World) -> PlanStep:
    match item:
        case {
            "behavior": str(behavior),
            "behavior_arguments": list(values),
            "bindings": dict(bindings),
            "controller": None | str() as controller,
            "arguments": list(arguments),
        }:
            pass
        case _:
            raise BadStepError(start, f"step {number}: not as `cdlc plan` prints it")
    try:
        claimed: tuple[Call, ...] = ()
        if controller is not None:
            found, read = resolve_controller(_written(controller, arguments, {}, start), world)
            claimed = ((found.name, read),)
        call = _written(behavior, values, bindings, start)
        step = _step(call, world, behavior, claimed)
    except BadStepError as error:
        raise BadStepError(start, f"step {number}: {error.diagnostic.reason}") from None
    text = call_text(step.behavior.name, step.arguments, step.bindings)
    return PlanStep(step.behavior, step.arguments, step.bindings, claimed, text, start)


def _written(name: str, values: list[Any], named: dict[str, Any], place: Location) -> WrittenCall:
    positional = tuple((value, place) for value in values)
    bindings = tuple((n, value, place) for n, value in named.items())
    return WrittenCall(name, positional, bindings, place, read_json)
