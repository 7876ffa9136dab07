"""Commands about programs: check, compile, verify, fmt, import, explain."""

import argparse
import sys
from contextlib import suppress
from typing import TYPE_CHECKING

from cdlc import driver, render
from cdlc.commands.shared import (
    DONE,
    INPUT_ERRORS,
    LIMIT,
    print_json,
    report,
    usage,
    warn,
    with_functions,
)
from cdlc.diagnostics import Collector
from cdlc.ir.nodes import Level

if TYPE_CHECKING:
    from cdlc.source import SourceFile

# What `--strict` takes for an error: planners would see less, or more steps, than the program.
_STRICT = {"split-behavior", "unmodelled-controller"}


def check(options: argparse.Namespace) -> int:
    """`cdlc check`: every mistake in every file, in one go."""
    found = Collector()
    sources: dict[str, SourceFile] = {}
    for file in options.files:
        compilation = driver.compilation([file], found)
        compilation.files.sources.update(sources)
        with suppress(driver.CompileError):  # its diagnostics are in `found`
            _ = compilation.checked
        sources |= compilation.sources
    diagnostics = found.sorted()
    if options.format == "json":
        print_json(render.as_json(diagnostics))
    elif diagnostics:
        report(options, diagnostics, sources)
        print(render.summary(diagnostics), file=sys.stderr)
    is_strict = options.warnings == "error" and diagnostics
    return INPUT_ERRORS if found.has_errors or is_strict else DONE


def compile_(options: argparse.Namespace) -> int:
    """`cdlc compile`: a domain, and a problem if given, in another form."""
    if len(options.files) > 2:
        return usage("compile takes DOMAIN [PROBLEM]")
    if (wrong := _unfit_options(options)) is not None:
        return usage(wrong)
    compilation = driver.compilation(options.files)
    compilation.axioms = options.derived == "axioms"
    compilation.enumerates = options.numeric == "enumerate"
    if options.emit in ("pddl", "hddl", "up") and not with_functions(options, compilation):
        return INPUT_ERRORS
    compilation.level = Level(options.simplify)
    if options.emit == "up" and not _has_up():
        return INPUT_ERRORS
    texts = _emitted(options, compilation)
    warn(options, compilation)
    if options.verbose and options.emit == "pddl":
        for method in compilation.pddl.unseen_methods:
            print(f"note: `{method}` is a method, which planners need not see", file=sys.stderr)
    if options.strict and any(d.code in _STRICT for d in compilation.found):
        return INPUT_ERRORS
    if options.output is None:
        print("\n".join(texts.values()), end="")
    else:
        from cdlc.output import write_all

        write_all({options.output / name: text for name, text in texts.items()})
    return DONE


def _has_up() -> bool:
    """Whether unified-planning is installed; False, with a message, if not."""
    from cdlc.backends.up import missing

    if (error := missing()) is not None:
        print(f"error[{error.code}]: {error}", file=sys.stderr)
    return error is None


def _unfit_options(options: argparse.Namespace) -> str | None:
    """What is wrong with the options of `compile` together."""
    is_json = options.format == "json"
    if is_json and options.emit not in ("ir", "hoare"):
        return f"{options.emit} is text; --format json is for --emit hoare"
    if options.explain and (is_json or options.emit != "hoare"):
        return "--explain is for --emit hoare as text; its JSON always says where from"
    if options.emit in ("hddl", "up") and options.derived == "axioms":
        return f"{options.emit} has no derived predicates; --derived axioms is for --emit pddl"
    if options.emit == "hddl" and options.numeric == "enumerate":
        return "tasks of HDDL take no numbers; --numeric enumerate is for --emit pddl and up"
    return None


def _emitted(options: argparse.Namespace, compilation: driver.Compilation) -> dict[str, str]:
    """The text of each file that `compile` is to write."""
    match options.emit:
        case "pddl":
            return _with_problem("pddl", compilation.pddl.domain, compilation.pddl.problem)
        case "hddl":
            return _with_problem("hddl", compilation.hddl.domain, compilation.hddl.problem)
        case "up":
            return {"problem.txt": compilation.up_text}
        case "ir":
            return {"program.json": compilation.ir_text}
        case _ if options.format == "json":
            return {"model.json": compilation.hoare_json}
        case _ if options.explain:
            return {"model.txt": compilation.hoare_explanation}
        case _:
            return {"model.hoare": compilation.hoare_text}


def _with_problem(kind: str, domain: str, problem: str | None) -> dict[str, str]:
    texts = {f"domain.{kind}": domain}
    return texts if problem is None else {**texts, f"problem.{kind}": problem}


def verify(options: argparse.Namespace) -> int:
    """`cdlc verify`: what behaviors claim, proved or refuted with a state where it fails."""
    from cdlc.verify.errors import SolverMissing
    from cdlc.verify.run import TIME_LIMIT, require
    from cdlc.verify.run import verify as run

    try:
        require()
    except SolverMissing as error:
        print(f"error[{error.code}]: {error}", file=sys.stderr)
        return INPUT_ERRORS
    from cdlc.verify import text
    from cdlc.verify.results import Verdict, document, worst

    is_json = options.format == "json"
    reports = []
    compilations = [driver.compilation([file]) for file in options.files]
    for file, compilation in zip(options.files, compilations, strict=True):
        program = compilation.program
        # What the lint suspects is proved or refuted here.
        warn(options, compilation, but="goal-not-established")
        report = run(file, program, options.time_limit or TIME_LIMIT)
        reports.append(report)
        if not is_json:
            color = render.wants_color(sys.stdout)
            print(text.report_text(report, compilation.sources, color=color), flush=True)
    if is_json:
        print_json(document(tuple(reports)))
    else:
        print(text.summary(tuple(reports)), file=sys.stderr)
    verdict = worst(report.verdict for report in reports)
    return {Verdict.PROVED: DONE, Verdict.REFUTED: INPUT_ERRORS, Verdict.UNKNOWN: LIMIT}[verdict]


def fmt(options: argparse.Namespace) -> int:
    """`cdlc fmt`: files in canonical layout; with `--check`, what would change."""
    from cdlc.fmt import Outcome, format_files

    results = format_files(options.files, driver.read_standard_input, check=options.check)
    for result in results:
        report(options, result.diagnostics, result.sources)
        if options.check:
            print(result.diff, end="")
        elif result.name == "-" and result.text is not None:
            print(result.text, end="")
    outcomes = {result.outcome for result in results}
    differs = options.check and Outcome.CHANGED in outcomes
    return INPUT_ERRORS if differs or Outcome.INVALID in outcomes else DONE


def import_(options: argparse.Namespace) -> int:
    """`cdlc import`: a PDDL domain, and a problem of it, as CDL files."""
    from cdlc.importing import import_pddl
    from cdlc.output import write_all

    imported = import_pddl(options.domain, options.problem, driver.read_standard_input)
    report(options, imported.diagnostics, imported.sources)
    if not imported.texts:
        return INPUT_ERRORS
    write_all({options.output / name: text for name, text in imported.texts.items()})
    return DONE


def explain(options: argparse.Namespace) -> int:
    """`cdlc explain`: the page of a diagnostic's code."""
    from cdlc.explain import explain as page_of
    from cdlc.explain import similar

    page = page_of(options.code)
    if page is None:
        near = similar(options.code)
        hint = "" if near is None else f"; did you mean `{near}`?"
        print(
            f"error[unknown-code]: no diagnostic has the code `{options.code}`{hint}",
            file=sys.stderr,
        )
        return INPUT_ERRORS
    print(page, end="")
    return DONE
