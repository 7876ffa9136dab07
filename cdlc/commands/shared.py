"""What several commands need: exit statuses, and how things are reported."""

import argparse
import json
import sys
from typing import Any

from cdlc import driver, render
from cdlc.diagnostics import Severity

DONE, INPUT_ERRORS, USAGE, NO_PLAN, LIMIT, INTERRUPTED = 0, 1, 2, 3, 4, 130


def with_functions(options: argparse.Namespace, compilation: driver.Compilation) -> bool:
    """Give a compilation the Python of its functions; False, with a message, if that fails."""
    if options.functions is None:
        return True
    from crow.functions import FunctionsError, collected

    try:
        compilation.functions = collected(options.functions)
    except FunctionsError as error:
        print(f"error[cannot-run-functions]: {error}", file=sys.stderr)
        return False
    return True


def problem_compilation(options: argparse.Namespace) -> driver.Compilation | None:
    """The compilation of `[DOMAIN] PROBLEM`; None, with a message, for another number of files."""
    if len(options.files) > 2:
        usage("give [DOMAIN] PROBLEM")
        return None
    return driver.problem_compilation(options.files)


def usage(message: str) -> int:
    """Say what is wrong with the arguments; returns the exit status."""
    print(f"usage error: {message}; see --help", file=sys.stderr)
    return USAGE


def print_json(document: dict[str, Any]) -> None:
    """A JSON document on standard output."""
    print(json.dumps(document, indent=2, ensure_ascii=False))


def warn(options: argparse.Namespace, compilation: driver.Compilation, but: str = "") -> None:
    """Show the warnings of a compilation that goes on, but those of one code."""
    warnings = [d for d in compilation.found if d.severity is Severity.WARNING and d.code != but]
    report(options, warnings, compilation.sources)


def report(options: argparse.Namespace, diagnostics: Any, sources: Any) -> None:
    """Diagnostics on standard error; as JSON on standard output for `check --format json`."""
    if options.command == "check" and options.format == "json":
        print_json(render.as_json(diagnostics))
    elif diagnostics:
        color = render.wants_color(sys.stderr)
        print(render.as_text(diagnostics, sources, color=color), file=sys.stderr)
