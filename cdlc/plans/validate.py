"""Checking plans that somebody else made: text or JSON as `plan` prints it, or PDDL."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from cdlc.backends.functions import as_reads
from cdlc.backends.pddl.course import Course
from cdlc.backends.pddl.emit import PddlTask
from cdlc.backends.pddl.parts import Part, parts_of
from cdlc.backends.pddl.plans import PlannedTransition
from cdlc.backends.pddl.sexpr import NotPddl
from cdlc.diagnostics import Collector
from cdlc.frontend.check import CheckedDomain, CheckedProblem
from cdlc.plans.calls import BadStepError
from cdlc.plans.errors import BadPlan, BadStep, GoalNotReached, OtherCalls
from cdlc.plans.reading import Call, PlanStep, line_of, read
from cdlc.plans.simulate import step_failed
from cdlc.plans.traces import TraceFormatError, read_trace
from cdlc.source import SourceFile
from crow.plan import call_text
from crow.problem import Problem, State
from crow.program import Location, Program
from crow.replay import goal_item, replay
from crow.trace import AssertItem, DoItem, TraceItem
from crow.transition import Ambiguous, Transition, Unmet


class Compiled(Protocol):
    """What is needed of a compilation; the PDDL only for a PDDL plan."""

    @property
    def problem(self) -> Problem:
        """The problem that the plan is for."""

    @property
    def checked(self) -> CheckedProblem | CheckedDomain:
        """The checked problem."""

    @property
    def pddl(self) -> PddlTask:
        """The PDDL of the problem."""


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


def validate(compiled: Compiled, source: SourceFile, found: Collector) -> Validation:
    """Apply a plan's transitions from the initial state, replay its trace, and test the goal.

    Where the program binds values, a plan with a trace is only replayed: its items say when each
    value had to be what it is, which the steps of methods do not. Problems of the plan are reported
    to `found`.
    """
    problem = compiled.problem
    try:
        plan = read(source, problem.world, lambda: compiled.pddl)
    except BadStepError as error:
        found.add(error.diagnostic)
        return Validation(0, 0)
    has_trace = plan.trace is not None and plan.trace != []
    state: State | None = None
    if not has_trace or problem.world.chosen_value is None:
        state = _apply_all(problem, plan.steps, found)
        if state is None:
            return Validation(len(plan.steps), 0)
    items = 0
    if has_trace:
        items, replayed = _check_trace(compiled, plan.trace, plan.steps, state, source, found)
        state = state or replayed
    if state is not None:
        _check_goal(problem, state, source, found)
    return Validation(len(plan.steps), items)


# ---------------------------------------------------------------------------------------- applying


def _apply_all(problem: Problem, steps: Sequence[PlanStep], found: Collector) -> State | None:
    """The state after all steps, or None, with a diagnostic, at the first that fails."""
    course = Course(problem.world, problem.initial)
    position = 0
    while position < len(steps):
        step = steps[position]
        applied, after = _applied(course, steps[position:])
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
                course = after
        if not _makes_calls(steps[position:], applied):
            found.add(
                OtherCalls(
                    location=step.location,
                    behavior=step.text,
                    expected=_listed(_made(applied)),
                    found=_listed(_claimed(steps[position:], applied)),
                )
            )
            return None
        position += _width(step, applied)
    if course.begun:
        name = next(iter(course.begun.values())).behavior
        reason = f"`{name}` has begun, and the plan does not end it"
        found.add(BadStep(location=steps[-1].location, reason=reason))
        return None
    return course.state


def _applied(course: Course, steps: Sequence[PlanStep]) -> tuple[Transition, Course]:
    """What the first step does: the part of its behavior that makes the calls it claims.

    Where there is none, the first one that can be carried out, or else the first.
    """
    step, tried = steps[0], list[tuple[Transition, Course]]()
    for planned in _candidates(course, step):
        applied, after = course.after(planned)
        if applied.problem is None and _makes_calls(steps, applied):
            return applied, after
        tried.append((applied, after))
    return next((t for t in tried if t[0].problem is None), tried[0])


def _candidates(course: Course, step: PlanStep) -> Iterator[PlannedTransition]:
    if step.planned is not None:
        yield step.planned
        return
    behavior, bindings = step.behavior, step.bindings
    try:
        parts = parts_of(course.world.program, behavior)
    except NotPddl:
        parts = ()
    for part in sorted(parts, key=lambda part: part.needs is None):  # what has begun goes on first
        known = {p.name for p in behavior.parameters} | bindings.keys()
        if behavior.effect is not None or all(p.name in known for p in part.applied.parameters):
            yield from course.begun_for(part, step.arguments, bindings)
    if not any(part.applied is behavior for part in parts):
        yield PlannedTransition(Part(behavior, behavior, behavior), step.arguments, bindings)


def _makes_calls(steps: Sequence[PlanStep], applied: Transition) -> bool:
    """Whether the steps claim the calls that were made for the first of them."""
    return steps[0].calls is None or _claimed(steps, applied) == _made(applied)


def _made(applied: Transition) -> list[Call]:
    return [(c.controller, c.arguments) for c in applied.calls]


def _claimed(steps: Sequence[PlanStep], applied: Transition) -> list[Call]:
    first, width = steps[0], _width(steps[0], applied)
    same = (step for step in steps[:width] if step.is_same_application(first))
    return [call for step in same for call in step.calls or ()]


def _width(step: PlanStep, applied: Transition) -> int:
    """How many steps of a plan stand for what was done; in PDDL it is one."""
    return 1 if step.calls is None else max(1, len(applied.calls))


def _listed(calls: list[Call]) -> str:
    texts = [f"`{call_text(name, arguments, {})}`" for name, arguments in calls]
    return ", ".join(texts) or "no controller"


def _check_goal(problem: Problem, state: State, source: SourceFile, found: Collector) -> None:
    goal = goal_item(problem.goal)
    result = replay(problem.world, state, (goal,))
    if result.failure is None:
        return
    last = max(1, len(source.text.rstrip().split("\n")))
    found.add(
        GoalNotReached(
            location=line_of(source, last),
            goal=goal.text,
            goal_location=goal.location,
            reason=result.failure.reason,
        )
    )


# ------------------------------------------------------------------------------------------- trace


def _check_trace(
    compiled: Compiled,
    items: object,
    steps: Sequence[PlanStep],
    state: State | None,
    source: SourceFile,
    found: Collector,
) -> tuple[int, State | None]:
    """Replay every item, and see that the trace makes the calls and the state of the steps.

    Returns the number of items, and the state at the end unless one fails.
    """
    problem, checked = compiled.problem, compiled.checked
    domain = checked.domain if isinstance(checked, CheckedProblem) else checked
    start = Location(source.name, 1, 1, 1, 1)
    try:
        trace = read_trace(items, domain, problem.world)
    except TraceFormatError as error:
        found.add(BadPlan(location=start, reason=str(error)))
        return 0, None
    trace = tuple(_with_tables(item, domain.program, problem.world.program) for item in trace)
    made = [(item.controller, item.arguments) for item in trace if isinstance(item, DoItem)]
    claimed = [call for step in steps for call in step.calls or ()]
    replayed = replay(problem.world, problem.initial, trace)
    reason = None
    if replayed.failure is not None:
        failure = replayed.failure
        reason = f"item {failure.index + 1} of the trace, `{failure.condition}`: {failure.reason}"
    elif made != claimed:
        reason = "the trace makes other controller calls than the steps"
    elif state is not None and replayed.final != state:
        reason = "the trace ends in another state than the steps"
    if reason is not None:
        found.add(BadPlan(location=start, reason=reason))
        return len(trace), None
    return len(trace), replayed.final


def _with_tables(item: TraceItem, declared: Program, tabulated: Program) -> TraceItem:
    """A trace item with functions of Python as the features they have become."""
    if declared is tabulated or not isinstance(item, AssertItem):
        return item
    names = {f.name for f in tabulated.features} - {f.name for f in declared.features}
    return replace(item, condition=as_reads(item.condition, frozenset(names)))
