"""Checking plans that somebody else made: text or JSON as `plan` prints it, or PDDL."""

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from cdlc.backends.pddl.emit import PddlTask
from cdlc.backends.pddl.plans import PlanFormatError, read_plan, to_step
from cdlc.diagnostics import Collector
from cdlc.driver import Compilation
from cdlc.frontend.check import CheckedProblem
from cdlc.plans.calls import BadStepError, read_call, resolve_behavior, resolve_controller
from cdlc.plans.errors import BadPlan, BadStep, GoalNotReached, OtherCalls
from cdlc.plans.simulate import step_failed
from cdlc.plans.traces import TraceFormatError, read_trace
from cdlc.source import SourceFile, Span
from crow.problem import Problem, State
from crow.program import Behavior, Location
from crow.replay import goal_item, replay
from crow.trace import DoItem, Trace
from crow.transition import Ambiguous, Unmet, apply
from crow.values import Value

Call = tuple[str, tuple[Value, ...]]


@dataclass(frozen=True, slots=True)
class _PlanStep:
    """A behavior to apply, and the controller call the plan claims for it, if it claims one.

    `calls` is None in a PDDL plan, which names none, and empty for a behavior that runs none.
    """

    behavior: Behavior
    arguments: tuple[Value, ...]
    bindings: dict[str, Value]
    calls: tuple[Call, ...] | None
    text: str
    location: Location


@dataclass(frozen=True, slots=True)
class Validation:
    """What was checked: the number of steps, and of trace items where the plan carries a trace."""

    steps: int
    trace_items: int

    def summary(self) -> str:
        """One line for people, with what was not checked."""
        steps = f"{self.steps} step{'' if self.steps == 1 else 's'}"
        trace = f", {self.trace_items} trace items" if self.trace_items else ""
        return (
            f"valid: {steps}{trace}; the goal holds"
            " (whether the program would choose these steps was not checked)"
        )


def validate(compilation: Compilation, source: SourceFile, found: Collector) -> Validation:
    """Apply a plan's transitions from the initial state, replay its trace, and test the goal.

    Problems of the plan are reported to `found`.
    """
    problem = compilation.problem
    try:
        task = compilation.pddl if is_pddl_plan(source.text) else None
        steps = list(_read(problem, task, source))
        trace = _trace(compilation, source)
    except BadStepError as error:
        found.add(error.diagnostic)
        return Validation(0, 0)
    state = _apply_all(problem, steps, found)
    if state is not None:
        _check_goal(problem, state, source, found)
        _check_trace(problem, trace, steps, source, found)
    return Validation(len(steps), len(trace))


def _trace(compilation: Compilation, source: SourceFile) -> Trace:
    """The trace that a plan in JSON carries; other plans carry none."""
    if not source.text.lstrip().startswith("{"):
        return ()
    checked = compilation.checked
    assert isinstance(checked, CheckedProblem)
    items = json.loads(source.text).get("trace") or []
    try:
        return read_trace(items, checked.domain, compilation.problem.world)
    except TraceFormatError as error:
        location = Location(source.name, 1, 1, 1, 1)
        raise BadStepError(BadStep(location=location, reason=str(error))) from None


def _check_trace(
    problem: Problem,
    trace: Trace,
    steps: list[_PlanStep],
    source: SourceFile,
    found: Collector,
) -> None:
    """Replay every item, and see that the trace makes the controller calls of the steps."""
    if not trace:
        return
    location = Location(source.name, 1, 1, 1, 1)
    made = [(item.controller, item.arguments) for item in trace if isinstance(item, DoItem)]
    claimed = [call for step in steps for call in step.calls or ()]
    failure = replay(problem.world, problem.initial, trace).failure
    if made != claimed:
        reason = "the trace makes other controller calls than the steps"
        found.add(BadPlan(location=location, reason=reason))
    elif failure is not None:
        reason = f"item {failure.index + 1} of the trace, `{failure.condition}`: {failure.reason}"
        found.add(BadPlan(location=location, reason=reason))


def is_pddl_plan(text: str) -> bool:
    """Whether a plan's first step is written as PDDL."""
    lines = (line.split(";")[0].strip() for line in text.splitlines())
    first = next((line for line in lines if line), "")
    return re.match(r"(\d+(\.\d+)?\s*:)?\s*\(", first) is not None


# ----------------------------------------------------------------------------------------- reading

_TEXT_STEP = re.compile(r"\s*(?:\d+\.)?\s*(?P<call>-|.*?\))\s+by\s+(?P<behavior>.*\))\s*")


def _read(problem: Problem, task: PddlTask | None, source: SourceFile) -> Iterator[_PlanStep]:
    if source.text.lstrip().startswith("{"):
        return _read_json(problem, source)
    if is_pddl_plan(source.text):
        assert task is not None
        return _read_pddl(problem, task, source)
    return _read_text(problem, source)


def _read_text(problem: Problem, source: SourceFile) -> Iterator[_PlanStep]:
    start = 0
    for line in source.text.splitlines(keepends=True):
        content = line.split("#")[0].rstrip()
        match = _TEXT_STEP.fullmatch(content)
        if match is not None:
            spans = [
                Span(start + match.start(group), start + match.end(group))
                for group in ("call", "behavior")
            ]
            claimed: tuple[Call, ...] = ()
            if match["call"] != "-":
                controller, arguments = resolve_controller(
                    read_call(source, spans[0]), problem.world
                )
                claimed = ((controller.name, arguments),)
            yield _step(problem, source, spans[1], claimed)
        elif content.strip():
            location = source.location(Span(start, start + len(content)))
            reason = "a step is `controller(a) by behavior(a, bind=b)`"
            raise BadStepError(BadStep(location=location, reason=reason))
        start += len(line)


def _step(
    problem: Problem, source: SourceFile, span: Span, calls: tuple[Call, ...] | None
) -> _PlanStep:
    call = resolve_behavior(read_call(source, span), problem.world)
    text = source.text[span.start : span.end]
    location = source.location(span)
    return _PlanStep(call.behavior, call.arguments, call.bindings, calls, text, location)


def _read_pddl(problem: Problem, task: PddlTask, source: SourceFile) -> Iterator[_PlanStep]:
    try:
        for line, action, arguments in read_plan(source.text):
            planned = to_step(task, problem.world, action, arguments, line)
            behavior = problem.world.behaviors[planned.behavior]
            text = source.line(line).strip()
            location = _line(source, line)
            bindings: dict[str, Value] = dict(planned.bindings)
            yield _PlanStep(behavior, planned.arguments, bindings, None, text, location)
    except PlanFormatError as error:
        location = _line(source, error.line)
        raise BadStepError(BadStep(location=location, reason=str(error))) from None


def _line(source: SourceFile, number: int) -> Location:
    width = len(source.line(number))
    return Location(source.name, number, 1, number, width + 1)


def _read_json(problem: Problem, source: SourceFile) -> Iterator[_PlanStep]:
    """Each step is read as the text it stands for, so that it is checked in the same way."""
    start = Location(source.name, 1, 1, 1, 1)
    try:
        document = json.loads(source.text)
        steps = [_step_texts(step) for step in document["steps"]]
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        reason = "the plan is no JSON that `cdlc plan` prints"
        raise BadStepError(BadStep(location=start, reason=reason)) from None
    for number, (call, behavior) in enumerate(steps, 1):
        name = f"{source.name}, step {number}"
        claimed: tuple[Call, ...] = ()
        try:
            if call is not None:
                text = SourceFile(name, call)
                controller, values = resolve_controller(
                    read_call(text, Span(0, len(call))), problem.world
                )
                claimed = ((controller.name, values),)
            text = SourceFile(name, behavior)
            yield _step(problem, text, Span(0, len(behavior)), claimed)
        except BadStepError as error:
            reason = f"step {number}: {error.diagnostic.reason}"
            raise BadStepError(BadStep(location=start, reason=reason)) from None


def _step_texts(step: Any) -> tuple[str | None, str]:
    call = None
    if step["controller"] is not None:
        call = f"{step['controller']}({', '.join(map(_written, step['arguments']))})"
    parts = [_written(value) for value in step["behavior_arguments"]]
    parts += [f"{name}={_written(value)}" for name, value in step["bindings"].items()]
    return call, f"{step['behavior']}({', '.join(parts)})"


def _written(value: Any) -> str:
    return value if isinstance(value, str) else str(value)


# ---------------------------------------------------------------------------------------- applying


def _apply_all(problem: Problem, steps: list[_PlanStep], found: Collector) -> State | None:
    """The state after all steps, or None, with a diagnostic, at the first that fails."""
    state = problem.initial
    position = 0
    while position < len(steps):
        step = steps[position]
        applied = apply(problem.world, state, step.behavior, step.arguments, step.bindings)
        match applied.problem:
            case Unmet() as unmet:
                found.add(step_failed(step.location, step.text, position + 1, unmet))
                return None
            case Ambiguous() as open_:
                choices = " or ".join(f"`{c}`" for c in open_.choices)
                reason = f"`{open_.variable}` can be {choices}, and the plan does not say which"
                found.add(BadStep(location=step.location, reason=reason))
                return None
            case None:
                pass
        made = [(c.controller, c.arguments) for c in applied.calls]
        width = 1 if step.calls is None else max(1, len(made))
        claimed = [c for s in steps[position : position + width] for c in s.calls or ()]
        if step.calls is not None and claimed != made:
            found.add(
                OtherCalls(
                    location=step.location,
                    behavior=step.text,
                    expected=_listed(made),
                    found=_listed(claimed),
                )
            )
            return None
        state = applied.state
        position += width
    return state


def _listed(calls: list[Call]) -> str:
    texts = [f"`{name}({', '.join(map(str, arguments))})`" for name, arguments in calls]
    return ", ".join(texts) or "no controller"


def _check_goal(problem: Problem, state: State, source: SourceFile, found: Collector) -> None:
    goal = goal_item(problem.goal)
    result = replay(problem.world, state, (goal,))
    if result.failure is None:
        return
    last = max(1, len(source.text.splitlines()))
    found.add(
        GoalNotReached(
            location=_line(source, last),
            goal=goal.text,
            goal_location=goal.location,
            reason=result.failure.reason,
        )
    )
