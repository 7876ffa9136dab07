"""The command line: arguments to driver calls to exit statuses (docs/reference/commands.md)."""

import argparse
import json
import os
import signal
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cdlc import driver, render
from cdlc.diagnostics import Collector, Severity
from cdlc.ir.nodes import Level

if TYPE_CHECKING:
    from cdlc.source import SourceFile

DONE, INPUT_ERRORS, USAGE, NO_PLAN, LIMIT, INTERRUPTED = 0, 1, 2, 3, 4, 130

# What `--strict` takes for an error: planners would see less, or more steps, than the program.
_STRICT = {"split-behavior", "unmodelled-controller"}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run `cdlc`; returns the exit status (interface.md)."""
    options = _parser().parse_args(arguments)
    signal.signal(signal.SIGTERM, _on_terminate)
    try:
        status: int = options.run(options)
        sys.stdout.flush()
    except driver.CompileError as error:
        _report(options, error.diagnostics, error.sources)
        return INPUT_ERRORS
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:
        # The reader has gone; what is still in the buffer must not raise at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return INPUT_ERRORS
    except OSError as error:
        named = f"`{error.filename}`: " if error.filename else ""
        print(f"error[cannot-write]: {named}{error.strerror or error}", file=sys.stderr)
        return INPUT_ERRORS
    return status


def _on_terminate(_number: int, _frame: object) -> None:
    """End as on Ctrl-C, so that child processes and temporary files go too."""
    raise KeyboardInterrupt


# --------------------------------------------------------------------------------------- arguments


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="cdlc", description="Check, compile and plan with CDL domains.", allow_abbrev=False
    )
    parser.add_argument("--version", action=_PrintVersion, nargs=0, help="show the version")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    _check_arguments(_command(commands, "check", check, "report every mistake in CDL files"))
    _compile_arguments(_command(commands, "compile", compile_, "emit a domain in another form"))
    _plan_arguments(_command(commands, "plan", plan, "find a plan for a problem"))
    validator = _command(commands, "validate", validate, "check a plan for a problem")
    _files(validator, "DOMAIN", "PROBLEM", "PLAN")
    _functions(validator)
    simulator = _command(commands, "simulate", simulate, "apply behaviors one after another")
    _files(simulator, "DOMAIN", "PROBLEM")
    simulator.add_argument(
        "--step", action="append", default=[], metavar="CALL", help="a behavior: 'name(a, bind=b)'"
    )
    _format(simulator)
    _functions(simulator)
    importer = _command(commands, "import", import_, "translate PDDL into CDL")
    importer.add_argument("domain", metavar="DOMAIN.pddl")
    importer.add_argument("problem", metavar="PROBLEM.pddl", nargs="?")
    importer.add_argument(
        "-o", dest="output", type=Path, metavar="DIR", required=True,
        help="where domain.cdl and problem.cdl are written",
    )  # fmt: skip
    _verify_arguments(_command(commands, "verify", verify, "prove what behaviors claim"))
    formatter = _command(commands, "fmt", fmt, "bring files to the canonical layout")
    formatter.add_argument("files", nargs="+", metavar="FILE", help="'-' is standard input")
    formatter.add_argument("--check", action="store_true", help="show what would change")
    lister = _command(commands, "engines", engines, "list planners, and which fit a domain")
    lister.add_argument("files", nargs="*", metavar="FILE", help="[DOMAIN] [PROBLEM]")
    _format(lister)
    explainer = _command(commands, "explain", explain, "say what the code of a diagnostic means")
    explainer.add_argument("code", metavar="CODE", help="such as unknown-feature")
    return parser


class _PrintVersion(argparse.Action):
    """`--version`; looking the version up takes a while, so only when asked."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from importlib.metadata import version

        print(f"cdlc {version('cdlc')}")
        parser.exit()


def _command(commands: Any, name: str, run: Any, help_: str) -> argparse.ArgumentParser:
    command: argparse.ArgumentParser = commands.add_parser(
        name, help=help_, description=f"{help_[0].upper()}{help_[1:]}.", allow_abbrev=False
    )
    command.set_defaults(run=run)
    return command


def _files(command: argparse.ArgumentParser, *names: str) -> None:
    """Positional files; a leading DOMAIN may be left out where PROBLEM names its own."""
    shown = tuple(names)
    usage = " ".join(f"[{n}]" if n == "DOMAIN" else n for n in shown)
    command.add_argument("files", nargs="+", metavar="FILE", help=usage)
    command.set_defaults(file_names=shown)


def _format(command: argparse.ArgumentParser) -> None:
    command.add_argument("--format", choices=("text", "json"), default="text")


def _check_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("files", nargs="+", metavar="FILE", help="'-' reads standard input")
    _format(command)
    command.add_argument("--warnings", choices=("error",), help="treat warnings as errors")


def _compile_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("files", nargs="+", metavar="FILE", help="DOMAIN [PROBLEM]")
    command.add_argument(
        "--emit",
        required=True,
        choices=("pddl", "hddl", "up", "ir", "hoare"),
        help="PDDL; HDDL, for planners that decompose tasks; a problem of unified-planning;"
        " the typed program as JSON; the Hoare model",
    )  # fmt: skip
    command.add_argument(
        "--simplify",
        choices=("none", "basic", "full"),
        default="basic",
        help="how far formulas are simplified; default: %(default)s",
    )
    _format(command)
    command.add_argument(
        "--explain", action="store_true", help="with --emit hoare: the statements behind each part"
    )
    command.add_argument("-o", dest="output", type=Path, metavar="DIR", help="write files there")
    _emission(command)
    command.add_argument(
        "--strict", action="store_true", help="treat what planners would see otherwise as an error"
    )


def _functions(command: argparse.ArgumentParser) -> None:
    command.add_argument("--functions", metavar="FILE.py", help="Python of external functions")


def _with_functions(options: argparse.Namespace, compilation: driver.Compilation) -> bool:
    """Give a compilation the Python of its functions; False, with a message, if that fails."""
    if options.functions is None:
        return True
    from cdlc.backends.functions import FunctionsError, load_functions

    try:
        compilation.functions = load_functions(options.functions)
    except FunctionsError as error:
        print(f"error[cannot-run-functions]: {error}", file=sys.stderr)
        return False
    return True


def _emission(command: argparse.ArgumentParser) -> None:
    """How PDDL is emitted."""
    _functions(command)
    command.add_argument(
        "--derived",
        choices=("inline", "axioms"),
        default="inline",
        help="derived functions in PDDL: unfolded, or as `:derived` predicates",
    )
    command.add_argument(
        "--numeric",
        choices=("fluents", "enumerate"),
        default="fluents",
        help="whole numbers with bounds in PDDL: functions, or objects for classical planners",
    )


def _plan_arguments(command: argparse.ArgumentParser) -> None:
    _files(command, "DOMAIN", "PROBLEM")
    command.add_argument(
        "--engine", default="auto", metavar="NAME",
        help="auto, iddfs or reference (the runtime's), or a PDDL engine such as fast-downward;"
        " default: %(default)s",
    )  # fmt: skip
    command.add_argument("--seed", type=int, default=0, metavar="N", help="default: %(default)s")
    _emission(command)
    command.add_argument("--time-limit", type=_positive(float), metavar="S", help="seconds")
    command.add_argument("--max-memory", type=_positive(int), metavar="MB")
    _format(command)
    command.add_argument(
        "-o", dest="output", type=Path, metavar="FILE", help="write the plan there"
    )


def _verify_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("files", nargs="+", metavar="FILE", help="a domain; '-' is standard input")
    command.add_argument(
        "--time-limit", type=_positive(float), metavar="S", help="seconds for each check"
    )
    _format(command)


def _positive(kind: Any) -> Any:
    def read(text: str) -> Any:
        value = kind(text)
        if not 0 < value < float("inf"):
            raise argparse.ArgumentTypeError(f"{text} is not positive")
        return value

    read.__name__ = "number"
    return read


# ---------------------------------------------------------------------------------------- commands


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
        _print_json(render.as_json(diagnostics))
    elif diagnostics:
        _report(options, diagnostics, sources)
        print(render.summary(diagnostics), file=sys.stderr)
    is_strict = options.warnings == "error" and diagnostics
    return INPUT_ERRORS if found.has_errors or is_strict else DONE


def compile_(options: argparse.Namespace) -> int:
    """`cdlc compile`: a domain, and a problem if given, in another form."""
    if len(options.files) > 2:
        return _usage("compile takes DOMAIN [PROBLEM]")
    if (wrong := _unfit_options(options)) is not None:
        return _usage(wrong)
    compilation = driver.compilation(options.files)
    compilation.axioms = options.derived == "axioms"
    compilation.enumerates = options.numeric == "enumerate"
    if options.emit in ("pddl", "hddl", "up") and not _with_functions(options, compilation):
        return INPUT_ERRORS
    compilation.level = Level(options.simplify)
    if options.emit == "up" and not _has_up():
        return INPUT_ERRORS
    texts = _emitted(options, compilation)
    _warn(options, compilation)
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


def plan(options: argparse.Namespace) -> int:
    """`cdlc plan`: a plan on standard output, everything else on standard error."""
    compilation = _problem_compilation(options)
    if compilation is None:
        return USAGE
    compilation.axioms = options.derived == "axioms"
    compilation.enumerates = options.numeric == "enumerate"
    if not _with_functions(options, compilation):
        return INPUT_ERRORS
    from crow.planning import ENGINES

    run = _plan_natively if options.engine in ENGINES else _plan_with_pddl
    return run(options, compilation)


def _plan_natively(options: argparse.Namespace, compilation: driver.Compilation) -> int:
    """Plan with the runtime; statistics go to standard error, also when it is interrupted."""
    from crow.planning import Planning

    problem = compilation.plannable
    _warn(options, compilation)
    shows = options.format == "text" and sys.stderr.isatty() and not os.environ.get("NO_COLOR")
    planning = Planning(
        problem,
        options.engine,
        seed=options.seed,
        time_limit=options.time_limit,
        memory_limit_mb=options.max_memory,
        on_progress=_show_progress if shows else None,
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
    shown = f"depth {statistics['depth']}, {statistics['nodes']} nodes"
    print(f"\r\033[K{shown}", end="", file=sys.stderr, flush=True)


def _statistics_text(statistics: dict[str, Any]) -> str:
    """Figures of a search in one line."""
    parts = [f"searched {statistics['nodes']} nodes to depth {statistics['depth']}"]
    parts += [f"{number} {name}" for name, number in statistics.get("pruned", {}).items()]
    return ", ".join(parts[:1]) + (f"; left out {', '.join(parts[1:])}" if parts[1:] else "")


def _plan_with_pddl(options: argparse.Namespace, compilation: driver.Compilation) -> int:
    """Plan with a PDDL engine, in a process of its own."""
    from cdlc.backends.engines import EngineError
    from cdlc.backends.pddl.solve import InvalidPlan, solve_task

    task, problem = compilation.planning_task, compilation.problem
    _warn(options, compilation)
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
        return _usage("validate takes [DOMAIN] PROBLEM PLAN")
    *files, plan_file = options.files
    compilation = driver.problem_compilation(files)
    if not _with_functions(options, compilation):
        return INPUT_ERRORS
    from cdlc.plans.validate import validate as run

    _ = compilation.problem
    source = compilation.files.read(plan_file)
    found = compilation.found
    checked = None if source is None else run(compilation, source, found)
    _report(options, found.sorted(), compilation.sources)
    if found.has_errors or checked is None:
        return INPUT_ERRORS
    print(checked.summary())
    return DONE


def simulate(options: argparse.Namespace) -> int:
    """`cdlc simulate`: the state after some behaviors."""
    compilation = _problem_compilation(options)
    if compilation is None:
        return USAGE
    if not _with_functions(options, compilation):
        return INPUT_ERRORS
    from cdlc.plans.simulate import simulate as run
    from cdlc.plans.simulate import state_text

    problem = compilation.problem
    _warn(options, compilation)
    found = Collector()
    result = run(problem, options.step, found, compilation.files.sources)
    _report(options, found.sorted(), compilation.sources)
    if options.format == "json":
        _print_json(result.json())
    else:
        print(state_text(result.world, result.state), end="")
    return DONE if result.is_complete else INPUT_ERRORS


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
        _warn(options, compilation, but="goal-not-established")
        report = run(file, program, options.time_limit or TIME_LIMIT)
        reports.append(report)
        if not is_json:
            color = render.wants_color(sys.stdout)
            print(text.report_text(report, compilation.sources, color=color), flush=True)
    if is_json:
        _print_json(document(tuple(reports)))
    else:
        print(text.summary(tuple(reports)), file=sys.stderr)
    verdict = worst(report.verdict for report in reports)
    return {Verdict.PROVED: DONE, Verdict.REFUTED: INPUT_ERRORS, Verdict.UNKNOWN: LIMIT}[verdict]


def fmt(options: argparse.Namespace) -> int:
    """`cdlc fmt`: files in canonical layout; with `--check`, what would change."""
    from cdlc.fmt import Outcome, format_files

    results = format_files(options.files, driver.read_standard_input, check=options.check)
    for result in results:
        _report(options, result.diagnostics, result.sources)
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
    _report(options, imported.diagnostics, imported.sources)
    if not imported.texts:
        return INPUT_ERRORS
    write_all({options.output / name: text for name, text in imported.texts.items()})
    return DONE


def engines(options: argparse.Namespace) -> int:
    """`cdlc engines`: the installed planners, what they take, and whether a task fits."""
    if len(options.files) > 2:
        return _usage("engines takes [DOMAIN] [PROBLEM]")
    from cdlc.backends.engines import EngineError
    from cdlc.engines import as_json, as_text, listed

    compilation = driver.compilation(options.files) if options.files else None
    task = None if compilation is None else compilation.pddl
    if compilation is not None:
        _warn(options, compilation)
    try:
        found = listed(task)
    except EngineError as error:
        print(f"error[{error.code}]: {error}", file=sys.stderr)
        return INPUT_ERRORS
    if options.format == "json":
        _print_json(as_json(found))
    else:
        print(as_text(found), end="")
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


# ------------------------------------------------------------------------------------------ shared


def _problem_compilation(options: argparse.Namespace) -> driver.Compilation | None:
    """The compilation of `[DOMAIN] PROBLEM`; None, with a message, for another number of files."""
    if len(options.files) > 2:
        _usage("give [DOMAIN] PROBLEM")
        return None
    return driver.problem_compilation(options.files)


def _usage(message: str) -> int:
    print(f"usage error: {message}; see --help", file=sys.stderr)
    return USAGE


def _print_json(document: dict[str, Any]) -> None:
    print(json.dumps(document, indent=2, ensure_ascii=False))


def _warn(options: argparse.Namespace, compilation: driver.Compilation, but: str = "") -> None:
    """Show the warnings of a compilation that goes on, but those of one code."""
    warnings = [d for d in compilation.found if d.severity is Severity.WARNING and d.code != but]
    _report(options, warnings, compilation.sources)


def _report(options: argparse.Namespace, diagnostics: Any, sources: Any) -> None:
    """Diagnostics on standard error; as JSON on standard output for `check --format json`."""
    if options.run is check and options.format == "json":
        _print_json(render.as_json(diagnostics))
    elif diagnostics:
        color = render.wants_color(sys.stderr)
        print(render.as_text(diagnostics, sources, color=color), file=sys.stderr)
