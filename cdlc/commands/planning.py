"""Commands about plans that are there: validate, simulate; and engines."""

import argparse
import sys

from cdlc import driver
from cdlc.commands.shared import (
    DONE,
    INPUT_ERRORS,
    USAGE,
    print_json,
    problem_compilation,
    report,
    usage,
    warn,
    with_functions,
)
from cdlc.diagnostics import Collector


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
    with compilation.reporting():
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
    with compilation.reporting():
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
