"""`cdlc crosscheck`: a table of outcomes, and folders to repeat mismatches from."""

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from cdlc import driver, render
from cdlc.commands.shared import (
    DONE,
    INPUT_ERRORS,
    LIMIT,
    NO_PLAN,
    print_json,
    usage,
    with_functions,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from cdlc.crosscheck import Comparison, Settings


def crosscheck(options: argparse.Namespace) -> int:
    """`cdlc crosscheck`: problems planned by the program and by its PDDL, and compared."""
    from cdlc.backends.engines import EngineError
    from cdlc.crosscheck import Settings, problems

    tasks = problems(options.files)
    if not tasks:
        return usage("crosscheck takes [DOMAIN] PROBLEM...")
    given = driver.Compilation()
    if not with_functions(options, given):
        return INPUT_ERRORS
    settings = Settings(
        options.engine,
        options.time_limit,
        options.node_limit,
        options.derived == "axioms",
        given.functions,
    )
    compared: list[Comparison] = []
    is_complete = False
    try:
        compared.extend(_compared(options, tasks, settings))
        is_complete = True
    except EngineError as error:
        print(f"error[{error.code}]: {error}", file=sys.stderr)
        return INPUT_ERRORS
    finally:
        # What was found until an interrupt is shown, too.
        if compared or is_complete:
            _show(options, compared, is_complete=is_complete)
    return _status(compared)


def _compared(
    options: argparse.Namespace,
    tasks: list[tuple[str, driver.Compilation]],
    settings: "Settings",
) -> "Iterator[Comparison]":
    """One comparison after another; diagnostics of the input as they come."""
    from cdlc.crosscheck import Progress, compare

    bar = Progress(sys.stderr, len(tasks), is_wanted=options.format == "text")
    said: set[str] = set()
    for file, compilation in tasks:

        def show(stage: str, file: str = file) -> None:
            bar.show(file, stage)

        try:
            comparison = compare(file, compilation, settings, show)
        finally:
            bar.clear()
        _say(comparison, said)
        yield _kept(options, comparison, compilation, settings)
        bar.advance()


def _say(comparison: "Comparison", said: set[str]) -> None:
    """Diagnostics on standard error; those of a domain once for all of its problems."""
    color = render.wants_color(sys.stderr)
    for diagnostic in comparison.diagnostics:
        text = render.as_text([diagnostic], comparison.sources or {}, color=color)
        if text not in said:
            said.add(text)
            print(text, file=sys.stderr)


def _kept(
    options: argparse.Namespace,
    comparison: "Comparison",
    compilation: driver.Compilation,
    settings: "Settings",
) -> "Comparison":
    """A comparison; with the folder to repeat it from where it is a mismatch."""
    from cdlc.crosscheck import Outcome, reproduce

    if comparison.outcome is not Outcome.MISMATCH:
        return comparison
    functions = None if options.functions is None else Path(options.functions)
    try:
        return reproduce(comparison, compilation, settings, functions, options.out)
    except OSError as error:
        named = f"`{error.filename}`: " if error.filename else ""
        print(f"error[cannot-write]: {named}{error.strerror or error}", file=sys.stderr)
        return comparison


def _show(options: argparse.Namespace, compared: "list[Comparison]", *, is_complete: bool) -> None:
    from cdlc.crosscheck import document, text

    if options.format == "json":
        print_json(document(compared, is_complete=is_complete))
        return
    color = render.wants_color(sys.stdout)
    print(text.table(compared, color=color), end="")
    print(text.remarks(compared, color=color), end="", flush=True)
    print(text.summary(compared), file=sys.stderr)


def _status(compared: "list[Comparison]") -> int:
    from cdlc.crosscheck import Outcome, outcome_of_all

    match outcome_of_all(compared):
        case Outcome.MISMATCH | Outcome.ERROR:
            return INPUT_ERRORS
        case Outcome.OUTSIDE:
            return NO_PLAN
        case Outcome.INCONCLUSIVE | Outcome.NOT_COMPARABLE:
            return LIMIT
        case _:
            return DONE
