"""The command plan: with the runtime, or with a planner of PDDL."""

import argparse
import json
import sys
from contextlib import AbstractContextManager, ExitStack, nullcontext
from typing import TYPE_CHECKING

from cdlc import driver
from cdlc.commands.shared import (
    DONE,
    INPUT_ERRORS,
    LIMIT,
    NO_PLAN,
    USAGE,
    problem_compilation,
    usage,
    warn,
    with_functions,
)

if TYPE_CHECKING:
    from cdlc.progress import Progress
    from crow.plan import Result
    from crow.planning import Planning


def plan(options: argparse.Namespace) -> int:
    """`cdlc plan`: a plan on standard output, everything else on standard error."""
    from crow.planning import ENGINES

    is_native = options.engine in ENGINES
    if options.trace is not None and not is_native:
        return usage(f"--trace shows searches of {', '.join(ENGINES)}, not of {options.engine}")
    if options.optimal and not is_native:
        return usage("--optimal is for the engines of the runtime: " + ", ".join(ENGINES))
    compilation = problem_compilation(options)
    if compilation is None:
        return USAGE
    compilation.axioms = options.derived == "axioms"
    compilation.enumerates = options.numeric == "enumerate"
    if not with_functions(options, compilation):
        return INPUT_ERRORS
    return (_plan_natively if is_native else _plan_with_pddl)(options, compilation)


def _plan_natively(options: argparse.Namespace, compilation: driver.Compilation) -> int:
    """Plan with the runtime; statistics go to standard error, also when it is interrupted."""
    from crow.limits import limited_memory
    from crow.results import OutOfMemory

    memory: AbstractContextManager[None] = nullcontext()
    if options.max_memory is not None:
        memory = limited_memory(options.max_memory)
    try:
        with memory, compilation.reporting():
            planning, result = _searched(options, compilation)
    except MemoryError:  # before the search, which ends by itself
        return _show_plan(options, OutOfMemory(options.engine, seed=options.seed))
    status = _show_plan(options, result)
    if options.trace is not None:
        _write_page(options, compilation, planning, result)
    return status


def _searched(
    options: argparse.Namespace, compilation: driver.Compilation
) -> "tuple[Planning, Result]":
    from cdlc.progress import Progress
    from crow.limits import timer
    from crow.planning import Planning

    problem = compilation.plannable_by(options.engine)
    warn(options, compilation)
    with ExitStack() as at_end:
        is_wanted = options.format == "text"
        progress = at_end.enter_context(Progress(sys.stderr, is_wanted=is_wanted))
        planning = Planning(
            problem,
            options.engine,
            h=options.h,
            seed=options.seed,
            time_limit=options.time_limit,
            draw_limit=options.draw_limit,
            memory_limit_mb=options.max_memory,
            on_progress=progress.show if progress.is_wanted else None,
            optimal=options.optimal,
        )
        if options.time_limit is not None or options.max_memory is not None:
            at_end.enter_context(timer(planning.budget.look))
        try:
            result = planning.first()
        except KeyboardInterrupt:
            _end(options, planning, progress)
            _explain(options, planning.explanation())
            raise
        _end(options, planning, progress)
        return planning, result


def _end(options: argparse.Namespace, planning: "Planning", progress: "Progress") -> None:
    """The search is over: its figures stand where its progress stood."""
    from crow.text import statistics_text

    progress.stop()
    if options.format == "text":
        print(statistics_text(planning.statistics()), file=sys.stderr)


def _explain(options: argparse.Namespace, explanation: str | None) -> None:
    if options.format == "text" and explanation:
        print(f"note: the search came as far as {explanation}", file=sys.stderr)


def _write_page(
    options: argparse.Namespace,
    compilation: driver.Compilation,
    planning: "Planning",
    result: "Result",
) -> None:
    from cdlc.output import write_whole
    from cdlc.view.page import Search, page

    tree = planning.refinement()
    write_whole(options.trace, page(Search(planning.problem, result, tree, compilation.sources)))


def _plan_with_pddl(options: argparse.Namespace, compilation: driver.Compilation) -> int:
    """Plan with a PDDL engine, in a process of its own."""
    from cdlc.backends.engines import EngineError
    from cdlc.backends.pddl.solve import InvalidPlan, solve_task

    task, problem = compilation.planning_task, compilation.problem
    warn(options, compilation)
    try:
        with compilation.reporting():
            result = solve_task(
                task,
                problem,
                options.engine,
                time_limit=options.time_limit,
                memory_limit_mb=options.max_memory,
            )
    except (EngineError, InvalidPlan) as error:
        print(f"error[{error.code}]: {error}", file=sys.stderr)
        return INPUT_ERRORS
    return _show_plan(options, result)


def _show_plan(options: argparse.Namespace, result: "Result") -> int:
    from crow.plan import plan_text

    is_json = options.format == "json"
    if is_json:
        text = json.dumps(result.json(), indent=2) + "\n"
    else:
        text = plan_text(result.steps) if result.status == "plan" else ""
    if options.output is not None and (is_json or text):
        from cdlc.output import write_whole

        write_whole(options.output, text)
    else:
        print(text, end="")
    if not is_json:
        print(result.summary(), file=sys.stderr)
    _explain(options, result.explanation)
    return {"plan": DONE, "timeout": LIMIT, "memory": LIMIT}.get(result.status, NO_PLAN)
