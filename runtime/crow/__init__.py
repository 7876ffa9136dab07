"""The CROW planner: plans with compiled CDL programs and imports nothing of `cdlc`.

result = crow.plan(problem, time_limit=30)
for step in result.steps:
    robot.run(step.controller, *step.arguments)
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

# `crow.plan` is the function: the module of that name is imported first, or its import would take
# the name over later.
import crow.plan  # noqa: F401

if TYPE_CHECKING:
    from collections.abc import Iterator

    from crow.budget import Progress
    from crow.calls import FunctionError
    from crow.domain import Domain, load, load_problem
    from crow.execution import Environment, Execution, execute
    from crow.functions import FunctionsError, controller, effect, function, generator
    from crow.many.cluster import Ray
    from crow.many.executors import InProcess
    from crow.many.processes import Processes, WorkersError
    from crow.many.racing import Race, race
    from crow.many.records import Fault, Record
    from crow.many.solving import solve_many
    from crow.many.tasks import Configuration, Task
    from crow.plan import Result, Step
    from crow.planning import NotPlannable
    from crow.policy import ControllerCall, Done, Policy, Stuck
    from crow.problem import Problem, State, World
    from crow.program.codec import ProgramFormatError
    from crow.results import LimitReached, OutOfMemory, Plan, TimedOut, Unsolvable
    from crow.robot import Robot
    from crow.stated import ProblemError

__all__ = [
    "plan",
    "plans",
    "load",
    "load_problem",
    "Domain",
    "solve_many",
    "race",
    "Configuration",
    "Task",
    "Record",
    "Fault",
    "Race",
    "InProcess",
    "Processes",
    "Ray",
    "WorkersError",
    "execute",
    "Policy",
    "ControllerCall",
    "Done",
    "Stuck",
    "Environment",
    "Execution",
    "Robot",
    "Problem",
    "ProblemError",
    "ProgramFormatError",
    "function",
    "generator",
    "effect",
    "controller",
    "FunctionsError",
    "FunctionError",
    "State",
    "World",
    "Result",
    "Step",
    "Plan",
    "Unsolvable",
    "LimitReached",
    "TimedOut",
    "OutOfMemory",
    "NotPlannable",
]

_PLACES = {
    **dict.fromkeys(("Problem", "State", "World"), "crow.problem"),
    **dict.fromkeys(
        ("Plan", "Unsolvable", "LimitReached", "TimedOut", "OutOfMemory"), "crow.results"
    ),
    **dict.fromkeys(("Result", "Step"), "crow.plan"),
    **dict.fromkeys(("Policy", "ControllerCall", "Done", "Stuck"), "crow.policy"),
    **dict.fromkeys(("execute", "Environment", "Execution"), "crow.execution"),
    "NotPlannable": "crow.planning",
    "solve_many": "crow.many.solving",
    **dict.fromkeys(("race", "Race"), "crow.many.racing"),
    **dict.fromkeys(("Configuration", "Task"), "crow.many.tasks"),
    **dict.fromkeys(("Fault", "Record"), "crow.many.records"),
    "InProcess": "crow.many.executors",
    **dict.fromkeys(("Processes", "WorkersError"), "crow.many.processes"),
    "Ray": "crow.many.cluster",
    **dict.fromkeys(("Domain", "load", "load_problem"), "crow.domain"),
    **dict.fromkeys(
        ("function", "generator", "effect", "controller", "FunctionsError"), "crow.functions"
    ),
    "FunctionError": "crow.calls",
    "Robot": "crow.robot",
    "ProblemError": "crow.stated",
    "ProgramFormatError": "crow.program.codec",
}


def plan(
    problem: "Problem",
    engine: str = "auto",
    *,
    h: str = "ff",
    seed: int = 0,
    time_limit: float | None = None,
    node_limit: int | None = None,
    depth_limit: int | None = None,
    draw_limit: int | None = None,
    memory_limit_mb: int | None = None,
    on_progress: "Progress | None" = None,
    optimal: bool = False,
) -> "Result":
    """A plan of a problem, by refining its goal (§3 of the paper).

    `engine` is `auto`, `best`, `iddfs`, `iw` or `reference`; `h`, the heuristic of best-first
    search, is `ff` or `add`. Limits are None for none: seconds of wall time, nodes, depth of nested
    behaviors, values drawn from one call of a generator, MiB of memory. `on_progress` is called now
    and then with statistics. With `optimal`, the search goes on for the plan that costs least
    (`minimize`, or the number of controller calls) until none can cost less, or a limit is reached:
    `unproved` of the plan says which.

    Returns Plan, Unsolvable, LimitReached, TimedOut or OutOfMemory. Raises NotPlannable for a
    program that has functions without their Python or, with an engine that covers objects alone,
    values to choose; ValueError for an engine or heuristic that is not one, and FunctionError where
    the user's Python fails.
    """
    from crow.planning import Planning

    return Planning(
        problem,
        engine,
        h=h,
        seed=seed,
        time_limit=time_limit,
        node_limit=node_limit,
        depth_limit=depth_limit,
        draw_limit=draw_limit,
        memory_limit_mb=memory_limit_mb,
        on_progress=on_progress,
        optimal=optimal,
    ).first()


def plans(
    problem: "Problem",
    engine: str = "auto",
    *,
    h: str = "ff",
    seed: int = 0,
    time_limit: float | None = None,
    node_limit: int | None = None,
    depth_limit: int | None = None,
    draw_limit: int | None = None,
) -> "Iterator[Plan]":
    """The plans of a problem, each once; with `iddfs`, those that need less depth first.

    It ends when there are no more or a limit is reached; `best` does not find all. Arguments and
    errors are those of `plan`.
    """
    from crow.planning import Planning

    return Planning(
        problem,
        engine,
        h=h,
        seed=seed,
        time_limit=time_limit,
        node_limit=node_limit,
        depth_limit=depth_limit,
        draw_limit=draw_limit,
    ).plans()


def __getattr__(name: str) -> Any:
    """Load what is asked for: the compiler uses little of it."""
    if name not in _PLACES:
        raise AttributeError(f"module `crow` has no attribute `{name}`")
    return getattr(import_module(_PLACES[name]), name)
