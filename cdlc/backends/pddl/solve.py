"""Planning with a PDDL engine: emit, solve in a child process, map back, replay."""

from cdlc.backends.engines import EngineResult, EngineStatus, solve
from cdlc.backends.pddl.course import Course, steps_of
from cdlc.backends.pddl.emit import PddlTask
from cdlc.backends.pddl.plans import PlanFormatError, PlannedTransition, to_step
from crow.evaluate import evaluate
from crow.plan import Result, Step
from crow.problem import Problem
from crow.replay import replay, replay_to_goal
from crow.trace import TraceItem


class InvalidPlan(Exception):  # noqa: N818 - a fault of the engine or of ours, not of the input
    """An engine's plan that is no plan of the program; the message says at which step and why."""

    code = "invalid-plan"


def solve_task(
    task: PddlTask,
    problem: Problem,
    engine: str,
    *,
    time_limit: float | None = None,
    memory_limit_mb: int | None = None,
) -> Result:
    """A replayed plan of an engine, or why there is none.

    Limits are seconds of wall time and MiB of address space. Raises EngineError as `solve` does,
    and InvalidPlan when the engine's plan does not replay.
    """
    assert task.problem is not None
    if task.is_hopeless:
        return Result("unsolvable", engine)
    solved = solve(
        task.domain,
        task.problem,
        engine=engine,
        time_limit=time_limit,
        memory_limit_mb=memory_limit_mb,
    )
    return replayed(task, problem, solved)


def replayed(task: PddlTask, problem: Problem, solved: EngineResult) -> Result:
    """What an engine found, its plan mapped back and replayed. Raises InvalidPlan."""
    engine = solved.engine
    statistics = {"seconds": round(solved.seconds, 3)}
    if solved.status is not EngineStatus.PLAN:
        return Result(str(solved.status), engine, statistics=statistics)
    try:
        planned = [
            to_step(task, problem.world, step.action, step.arguments, number)
            for number, step in enumerate(solved.steps, 1)
        ]
    except PlanFormatError as error:
        raise InvalidPlan(f"step {error.line}: {error}") from None
    steps, trace = run(problem, planned)
    return Result("plan", engine, steps, trace, _cost(problem, steps, trace), statistics=statistics)


def _cost(problem: Problem, steps: tuple[Step, ...], trace: tuple[TraceItem, ...]) -> float:
    """What `minimize` is in the final state, else the number of controller calls."""
    if problem.minimize is None:
        return float(sum(step.controller is not None for step in steps))
    final = replay(problem.world, problem.initial, trace).final
    return float(evaluate(problem.world, final, problem.minimize, {}))


def run(
    problem: Problem, planned: list[PlannedTransition]
) -> tuple[tuple[Step, ...], tuple[TraceItem, ...]]:
    """Apply transitions from the initial state, then replay their trace to the goal.

    Raises InvalidPlan at the first one that cannot be applied, if the goal is not reached, or if a
    behavior has begun and not ended.
    """
    course, steps, trace = Course(problem.world, problem.initial), list[Step](), list[TraceItem]()
    for number, transition in enumerate(planned, 1):
        applied, course = course.after(transition)
        if applied.problem is not None:
            raise InvalidPlan(f"step {number}: {applied.problem}")
        trace += applied.trace
        steps += steps_of(transition, applied)
    if course.begun:
        name = next(iter(course.begun.values())).behavior
        raise InvalidPlan(f"`{name}` has begun and does not end")
    replayed = replay_to_goal(problem, tuple(trace))
    if replayed.failure is not None:
        failure = replayed.failure
        raise InvalidPlan(f"`{failure.condition}`: {failure.reason}")
    return tuple(steps), tuple(trace)
