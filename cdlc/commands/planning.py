"""Commands about plans: plan, validate, simulate, engines."""

import argparse
import json
import os
import sys
from typing import Any

from cdlc import driver
from cdlc.commands.shared import (
    DONE,
    INPUT_ERRORS,
    LIMIT,
    NO_PLAN,
    USAGE,
    print_json,
    problem_compilation,
    report,
    usage,
    warn,
    with_functions,
)
from cdlc.diagnostics import Collector


def plan(options: argparse.Namespace) -> int:
    """`cdlc plan`: a plan on standard output, everything else on standard error."""
    compilation = problem_compilation(options)
    if compilation is None:
        return USAGE
    compilation.axioms = options.derived == "axioms"
    compilation.enumerates = options.numeric == "enumerate"
    if not with_functions(options, compilation):
        return INPUT_ERRORS
    from crow.planning import ENGINES

    if options.optimal and options.engine not in ENGINES:
        return usage("--optimal is for the engines of the runtime: " + ", ".join(ENGINES))
    run = _plan_natively if options.engine in ENGINES else _plan_with_pddl
    return run(options, compilation)


def _plan_natively(options: argparse.Namespace, compilation: driver.Compilation) -> int:
    """Plan with the runtime; statistics go to standard error, also when it is interrupted."""
    from crow.planning import Planning

    problem = compilation.plannable
    warn(options, compilation)
    shows = options.format == "text" and sys.stderr.isatty() and not os.environ.get("NO_COLOR")
    planning = Planning(
        problem,
        options.engine,
        h=options.h,
        seed=options.seed,
        time_limit=options.time_limit,
        memory_limit_mb=options.max_memory,
        on_progress=_show_progress if shows else None,
        optimal=options.optimal,
    )
    try:
        result = planning.first()
    finally:
        if shows:
            print("\r\033[K", end="", file=sys.stderr)
        if options.format == "text":
            print(_statistics_text(planning.statistics()), file=sys.stderr)
    return _show_plan(options, result)


def _show_progress(statistics: dict[str, Any]) -> None:
    """One line that is written over."""
    shown = f"{statistics['nodes']} nodes"
    if "depth" in statistics:
        shown = f"depth {statistics['depth']}, {shown}"
    print(f"\r\033[K{shown}", end="", file=sys.stderr, flush=True)


def _statistics_text(statistics: dict[str, Any]) -> str:
    """Figures of a search in one line."""
    depth = f" to depth {statistics['depth']}" if "depth" in statistics else ""
    depth += f" in width {statistics['width']}" if "width" in statistics else ""
    parts = [f"searched {statistics['nodes']} nodes{depth}"]
    parts += [f"{number} {name}" for name, number in statistics.get("pruned", {}).items()]
    return ", ".join(parts[:1]) + (f"; left out {', '.join(parts[1:])}" if parts[1:] else "")


def _plan_with_pddl(options: argparse.Namespace, compilation: driver.Compilation) -> int:
    """Plan with a PDDL engine, in a process of its own."""
    from cdlc.backends.engines import EngineError
    from cdlc.backends.pddl.solve import InvalidPlan, solve_task

    task, problem = compilation.planning_task, compilation.problem
    warn(options, compilation)
    try:
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


def _show_plan(options: argparse.Namespace, result: Any) -> int:
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
        if result.explanation:
            print(f"note: the search came as far as {result.explanation}", file=sys.stderr)
    return {"plan": DONE, "timeout": LIMIT, "memory": LIMIT}.get(result.status, NO_PLAN)


def validate(options: argparse.Namespace) -> int:
    """`cdlc validate`: whether a plan can be carried out and reaches the goal."""
    if not 2 <= len(options.files) <= 3:
        return usage("validate takes [DOMAIN] PROBLEM PLAN")
    *files, plan_file = options.files
    compilation = driver.problem_compilation(files)
    if not with_functions(options, compilation):
        return INPUT_ERRORS
    from cdlc.plans.validate import validate as run

    _ = compilation.problem
    source = compilation.files.read(plan_file)
    found = compilation.found
    checked = None if source is None else run(compilation, source, found)
    report(options, found.sorted(), compilation.sources)
    if found.has_errors or checked is None:
        return INPUT_ERRORS
    print(checked.summary())
    return DONE


def simulate(options: argparse.Namespace) -> int:
    """`cdlc simulate`: the state after some behaviors."""
    compilation = problem_compilation(options)
    if compilation is None:
        return USAGE
    if not with_functions(options, compilation):
        return INPUT_ERRORS
    from cdlc.plans.simulate import simulate as run
    from cdlc.plans.simulate import state_text

    problem = compilation.problem
    warn(options, compilation)
    found = Collector()
    result = run(problem, options.step, found, compilation.files.sources)
    report(options, found.sorted(), compilation.sources)
    if options.format == "json":
        print_json(result.json())
    else:
        print(state_text(result.world, result.state), end="")
    return DONE if result.is_complete else INPUT_ERRORS


def engines(options: argparse.Namespace) -> int:
    """`cdlc engines`: the installed planners, what they take, and whether a task fits."""
    if len(options.files) > 2:
        return usage("engines takes [DOMAIN] [PROBLEM]")
    from cdlc.backends.engines import EngineError
    from cdlc.engines import as_json, as_text, listed

    compilation = driver.compilation(options.files) if options.files else None
    task = None if compilation is None else compilation.pddl
    if compilation is not None:
        warn(options, compilation)
    try:
        found = listed(task)
    except EngineError as error:
        print(f"error[{error.code}]: {error}", file=sys.stderr)
        return INPUT_ERRORS
    if options.format == "json":
        print_json(as_json(found))
    else:
        print(as_text(found), end="")
    return DONE
