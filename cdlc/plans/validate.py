"""Checking plans that somebody else made: text or JSON as `plan` prints it, or PDDL."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from cdlc.backends.functions import as_reads
from cdlc.backends.pddl.emit import PddlTask
from cdlc.backends.pddl.methods import method_steps
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
from crow.transition import Ambiguous, Transition, Unmet, apply


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

    Problems of the plan are reported to `found`.
    """
    problem = compiled.problem
    try:
        plan = read(source, problem.world, lambda: compiled.pddl)
    except BadStepError as error:
        found.add(error.diagnostic)
        return Validation(0, 0)
    state = _apply_all(problem, plan.steps, found)
    if state is None:
        return Validation(len(plan.steps), 0)
    _check_goal(problem, state, source, found)
    items = 0
    if plan.trace is not None and plan.trace != []:
        items = _check_trace(compiled, plan.trace, plan.steps, state, source, found)
    return Validation(len(plan.steps), items)


# ---------------------------------------------------------------------------------------- applying


def _apply_all(problem: Problem, steps: Sequence[PlanStep], found: Collector) -> State | None:
    """The state after all steps, or None, with a diagnostic, at the first that fails."""
    state = problem.initial
    position = 0
    while position < len(steps):
        step = steps[position]
        applied = _applied(problem, state, step)
        made = [(c.controller, c.arguments) for c in applied.calls]
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
                state = applied.state
        is_part = step.behavior.effect is None
        width = 1 if step.calls is None or is_part else max(1, len(made))
        if not _makes_calls(steps[position : position + width], made, found):
            return None
        position += width
    return state


def _applied(problem: Problem, state: State, step: PlanStep) -> Transition:
    """A behavior applied; of a method, which is no single step, the one that makes the call."""
    program, behavior = problem.world.program, step.behavior
    whole = apply(problem.world, state, behavior, step.arguments, step.bindings)
    if behavior.effect is not None or not step.calls:
        return whole
    names = [p.name for p in behavior.parameters]
    values = {**dict(zip(names, step.arguments, strict=True)), **step.bindings}
    tried = [whole]
    for part in method_steps(program, behavior):
        needed = [p.name for p in part.behavior.parameters]
        if all(name in values for name in needed):
            arguments = tuple(values[name] for name in needed)
            applied = apply(problem.world, state, part.behavior, arguments)
            if [(c.controller, c.arguments) for c in applied.calls] == list(step.calls):
                tried.append(applied)
    return next((t for t in reversed(tried) if t.problem is None), tried[-1])


def _makes_calls(steps: Sequence[PlanStep], made: list[Call], found: Collector) -> bool:
    """Whether the steps of one behavior claim the calls that it makes."""
    first = steps[0]
    same = [step for step in steps if step.is_same_application(first)]
    claimed = [call for step in same for call in step.calls or ()]
    if first.calls is None or claimed == made:
        return True
    found.add(
        OtherCalls(
            location=first.location,
            behavior=first.text,
            expected=_listed(made),
            found=_listed(claimed),
        )
    )
    return False


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
    state: State,
    source: SourceFile,
    found: Collector,
) -> int:
    """Replay every item, and see that the trace makes the calls and the state of the steps."""
    problem, checked = compiled.problem, compiled.checked
    domain = checked.domain if isinstance(checked, CheckedProblem) else checked
    start = Location(source.name, 1, 1, 1, 1)
    try:
        trace = read_trace(items, domain, problem.world)
    except TraceFormatError as error:
        found.add(BadPlan(location=start, reason=str(error)))
        return 0
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
    elif replayed.final != state:
        reason = "the trace ends in another state than the steps"
    if reason is not None:
        found.add(BadPlan(location=start, reason=reason))
    return len(trace)


def _with_tables(item: TraceItem, declared: Program, tabulated: Program) -> TraceItem:
    """A trace item with functions of Python as the features they have become."""
    if declared is tabulated or not isinstance(item, AssertItem):
        return item
    names = {f.name for f in tabulated.features} - {f.name for f in declared.features}
    return replace(item, condition=as_reads(item.condition, frozenset(names)))
