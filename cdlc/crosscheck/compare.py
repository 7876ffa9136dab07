"""One problem compared; and files to problems."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, Any

from cdlc import driver
from cdlc.backends.engines import EngineError, EngineMissing, EngineUnsupported
from cdlc.crosscheck.decide import decide
from cdlc.crosscheck.results import Comparison, Outcome
from cdlc.crosscheck.sides import ask_planner, ask_program, engine_for, second_opinion
from cdlc.crosscheck.space import excluded
from cdlc.diagnostics import Severity

if TYPE_CHECKING:
    from cdlc.backends.pddl import PddlTask
    from crow.plan import Result
    from crow.problem import Problem

TIME_LIMIT = 30.0
"""Seconds for each side, unless given."""


@dataclass(frozen=True, slots=True)
class Settings:
    """How problems are compared; limits are for each side, nodes for the program's alone.

    Without `engine`, one that takes the task is chosen.
    """

    engine: str | None = None
    time_limit: float = TIME_LIMIT
    node_limit: int | None = None
    axioms: bool = False
    functions: object = None


OnStage = Callable[[str], None]
"""Called with what is being done now."""


def problems(files: list[str]) -> list[tuple[str, driver.Compilation]]:
    """The compilation of each problem in `[DOMAIN] PROBLEM...`, each file once.

    Empty if there is no problem. Raises CompileError for a domain with errors.
    """
    read = cache(driver.read_standard_input)
    first = driver.compilation(files[:1], read_standard_input=read)
    domain, rest = (None, files) if first.problem_file is not None else (files[0], files[1:])
    if domain is not None:
        _ = first.checked
    return [
        (file, driver.Compilation(domain, file, read_standard_input=read))
        for file in dict.fromkeys(rest)
    ]


def compare(
    file: str, compilation: driver.Compilation, settings: Settings, on_stage: OnStage
) -> Comparison:
    """Plan a problem on both sides and compare. Raises EngineMissing.

    Errors of the input, and of an engine, are outcomes.
    """
    compilation.axioms, compilation.functions = settings.axioms, settings.functions
    on_stage("compiling")
    try:
        problem = compilation.problem
    except driver.CompileError as error:
        return Comparison(file, Outcome.ERROR, "", None, None, (), error.diagnostics, error.sources)
    try:
        problem, task = compilation.plannable, compilation.planning_task
        with compilation.reporting():
            compared = _compared(file, task, problem, settings, on_stage)
    except driver.CompileError as error:
        compared = Comparison(file, Outcome.NOT_COMPARABLE, _first_error(error))
    except EngineMissing:
        raise
    except EngineUnsupported as error:
        compared = Comparison(file, Outcome.NOT_COMPARABLE, str(error))
    except EngineError as error:
        compared = Comparison(file, Outcome.ERROR, str(error))
    warnings = tuple(d for d in compilation.found if d.severity is Severity.WARNING)
    return replace(compared, diagnostics=warnings, sources=compilation.sources)


def _first_error(error: driver.CompileError) -> str:
    """What keeps a program from being planned on both sides, and where it is."""
    found = next(d for d in error.diagnostics if d.severity is Severity.ERROR)
    place = found.location
    return f"{found.message()} ({place.file}:{place.line}:{place.column})"


def _compared(
    file: str, task: "PddlTask", problem: "Problem", settings: Settings, on_stage: OnStage
) -> Comparison:
    engine = settings.engine or engine_for(task)
    seconds, nodes = settings.time_limit, settings.node_limit

    def on_progress(statistics: dict[str, Any]) -> None:
        on_stage(f"the program, depth {statistics['depth']}, {statistics['nodes']} nodes")

    on_stage(engine)
    planner = ask_planner(task, problem, engine, seconds)
    on_stage("the program")
    program = ask_program(task, problem, seconds, nodes, on_progress)
    outcome, reason = decide(planner, program)
    compared = Comparison(file, outcome, reason, planner, program)
    if outcome is not Outcome.OUTSIDE:
        return compared
    return _confirmed(compared, problem, second_opinion(problem, seconds, nodes, on_progress))


def _confirmed(compared: Comparison, problem: "Problem", second: "Result") -> Comparison:
    """A plan outside the plan space, as the reference engine sees it."""
    assert compared.planner is not None
    if second.status == "plan":
        reason = "the runtime proves that the program has no plan, its reference engine finds one"
        return replace(compared, outcome=Outcome.MISMATCH, reason=reason, second=second)
    by = "both engines" if second.status == "unsolvable" else "one engine"
    reason = f"{compared.reason}, which {by} of the runtime tried in full"
    return replace(
        compared, reason=reason, excluded=excluded(problem, compared.planner.result.steps)
    )
