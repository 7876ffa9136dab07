"""The command line: arguments to driver calls to exit statuses (docs/reference/commands.md)."""

import argparse
import os
import signal
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from cdlc import driver
from cdlc.commands.bench import bench
from cdlc.commands.crosscheck import crosscheck
from cdlc.commands.graph import graph
from cdlc.commands.plan import plan
from cdlc.commands.planning import engines, simulate, validate
from cdlc.commands.programs import check, compile_, explain, fmt, import_, verify
from cdlc.commands.report import report
from cdlc.commands.shared import INPUT_ERRORS, INTERRUPTED
from cdlc.commands.shared import report as show


def main(arguments: Sequence[str] | None = None) -> int:
    """Run `cdlc`; returns the exit status (interface.md)."""
    options = _parser().parse_args(arguments)
    signal.signal(signal.SIGTERM, _on_terminate)
    try:
        status: int = options.run(options)
        sys.stdout.flush()
    except driver.CompileError as error:
        show(options, error.diagnostics, error.sources)
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
    _crosscheck_arguments(
        _command(commands, "crosscheck", crosscheck, "compare a program with its PDDL on problems")
    )
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
    drawer = _command(commands, "graph", graph, "draw which behavior achieves and needs what")
    drawer.add_argument("domain", metavar="DOMAIN", help="a domain; '-' is standard input")
    drawer.add_argument(
        "-o", dest="output", type=Path, metavar="FILE", required=True, help="FILE.svg or FILE.png"
    )
    _bench_arguments(_command(commands, "bench", bench, "solve many problems, and record each"))
    reporter = _command(commands, "report", report, "make tables and charts of recorded runs")
    reporter.add_argument("files", nargs="+", metavar="RESULTS", help="files of `bench --out`")
    reporter.add_argument(
        "-o", dest="output", type=Path, metavar="DIR", help="write charts and a page there"
    )
    _format(reporter)
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
    command.set_defaults(command=name, run=run)
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
    command.add_argument(
        "--verbose", action="store_true", help="with --emit pddl: say which methods are no actions"
    )


def _functions(command: argparse.ArgumentParser) -> None:
    command.add_argument("--functions", metavar="FILE.py", help="Python of external functions")


def _emission(command: argparse.ArgumentParser) -> None:
    """How PDDL is emitted."""
    _functions(command)
    _derived(command)
    command.add_argument(
        "--numeric",
        choices=("fluents", "enumerate"),
        default="fluents",
        help="whole numbers with bounds in PDDL: functions, or objects for classical planners",
    )


def _derived(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--derived",
        choices=("inline", "axioms"),
        default="inline",
        help="derived functions in PDDL: unfolded, or as `:derived` predicates",
    )


def _plan_arguments(command: argparse.ArgumentParser) -> None:
    _files(command, "DOMAIN", "PROBLEM")
    command.add_argument(
        "--engine", default="auto", metavar="NAME",
        help="auto, best, iddfs, iw or reference (the runtime's), or a PDDL engine such as"
        " fast-downward; default: %(default)s",
    )  # fmt: skip
    command.add_argument(
        "--h", default="ff", choices=("ff", "add"),
        help="the heuristic of best-first search: the size of a relaxed plan, or costs added up;"
        " default: %(default)s",
    )  # fmt: skip
    command.add_argument("--seed", type=int, default=0, metavar="N", help="default: %(default)s")
    command.add_argument(
        "--optimal", action="store_true",
        help="go on for the plan that costs least: `minimize`, or the number of controller calls",
    )  # fmt: skip
    _emission(command)
    command.add_argument("--time-limit", type=_positive(float), metavar="S", help="seconds")
    command.add_argument("--max-memory", type=_positive(int), metavar="MB")
    command.add_argument(
        "--draw-limit", type=_positive(int), metavar="N",
        help="the most values drawn from one call of a generator; default: none",
    )  # fmt: skip
    _format(command)
    command.add_argument(
        "-o", dest="output", type=Path, metavar="FILE", help="write the plan there"
    )
    command.add_argument(
        "--trace", type=Path, metavar="FILE.html",
        help="write a page that shows how the goal was refined, each state, and what failed",
    )  # fmt: skip


def _bench_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "suites",
        nargs="+",
        metavar="SUITE",
        help="problems, a folder or glob of them, or a TOML file",
    )
    command.add_argument(
        "--jobs", type=_positive(int), metavar="N", help="processes on this machine; default: 1"
    )
    command.add_argument(
        "--ray", metavar="ADDRESS",
        help="a Ray cluster: host:port, 'auto' for the one this machine belongs to, or 'local'",
    )  # fmt: skip
    command.add_argument(
        "--out",
        type=Path,
        metavar="FILE.jsonl",
        help="append records there, not to standard output",
    )
    command.add_argument(
        "--resume", action="store_true", help="go on with the file: what it has is not done again"
    )
    command.add_argument(
        "--engine", action="append", default=[], metavar="NAME",
        help="an engine of the runtime, more than once for several; default: auto, or the suite's",
    )  # fmt: skip
    command.add_argument(
        "--seeds", type=_positive(int), metavar="N", help="seeds 0 to N - 1; default: 0"
    )
    command.add_argument(
        "--time-limit", type=_positive(float), metavar="S", help="seconds for each run"
    )
    command.add_argument("--node-limit", type=_positive(int), metavar="N", help="nodes of each run")
    command.add_argument(
        "--draw-limit", type=_positive(int), metavar="N", help="draws of a generator call"
    )
    command.add_argument("--max-memory", type=_positive(int), metavar="MB", help="of each run")
    _functions(command)


def _verify_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("files", nargs="+", metavar="FILE", help="a domain; '-' is standard input")
    command.add_argument(
        "--time-limit", type=_positive(float), metavar="S", help="seconds for each check"
    )
    _format(command)


def _crosscheck_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("files", nargs="+", metavar="FILE", help="[DOMAIN] PROBLEM...")
    command.add_argument(
        "--engine", metavar="NAME",
        help="a PDDL engine; default: kairos for numbers, else fast-downward",
    )  # fmt: skip
    command.add_argument(
        "--time-limit", type=_positive(float), default=30.0, metavar="S",
        help="seconds for each side of each problem; default: %(default)g",
    )  # fmt: skip
    command.add_argument(
        "--node-limit", type=_positive(int), metavar="N", help="nodes of the program's search"
    )
    _functions(command)
    _derived(command)
    command.add_argument(
        "--out", type=Path, default=Path(), metavar="DIR",
        help="where mismatches leave a folder crosscheck-PROBLEM; default: here",
    )  # fmt: skip
    _format(command)


def _positive(kind: Any) -> Any:
    def read(text: str) -> Any:
        value = kind(text)
        if not 0 < value < float("inf"):
            raise argparse.ArgumentTypeError(f"{text} is not positive")
        return value

    read.__name__ = "number"
    return read
