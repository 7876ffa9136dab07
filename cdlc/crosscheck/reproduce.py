"""A folder to repeat a mismatch from: what went in, what came out, and what was run."""

import json
import os
import platform
import shlex
import sys
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from cdlc.backends.engines import PddlStep
from cdlc.crosscheck.compare import Settings
from cdlc.crosscheck.results import Comparison, Side
from cdlc.driver import Compilation
from cdlc.output import write_folder
from crow.plan import plan_text

_PACKAGES = ("cdlc", "unified_planning", "up_fast_downward", "up-kairos", "kairos-planner")
STANDARD_INPUT = "-"


def reproduce(
    comparison: Comparison,
    compilation: Compilation,
    settings: Settings,
    functions: Path | None,
    folder: Path,
) -> Comparison:
    """The comparison with a new folder `crosscheck-<problem>` in `folder` to repeat it from.

    A name that is taken gets a number. The folder is there whole or not at all; nothing is written
    over. Raises OSError.
    """
    files = dict(_files(comparison, compilation, settings, functions))
    written = write_folder(folder / f"crosscheck-{_stem(comparison.file)}", files)
    return replace(comparison, reproducer=written)


def _stem(file: str) -> str:
    return "stdin" if file == STANDARD_INPUT else Path(file).stem


def _files(
    comparison: Comparison, compilation: Compilation, settings: Settings, functions: Path | None
) -> Iterator[tuple[str, str]]:
    """Names and texts."""
    places = _places(compilation)
    for name, place in places.items():
        yield place, compilation.sources[name].text
    if functions is not None:
        yield "functions.py", functions.read_text("utf-8")
    task = compilation.pddl
    yield "domain.pddl", task.domain
    yield "problem.pddl", task.problem or ""
    for name, side in (("planner", comparison.planner), ("program", comparison.program)):
        if side is not None and side.status == "plan":
            yield from _plan_files(name, side)
    if comparison.second is not None:
        yield "reference-plan.json", json.dumps(comparison.second.json(), indent=2) + "\n"
    yield "comparison.json", json.dumps(comparison.json(), indent=2) + "\n"
    given = (compilation.domain_file, compilation.problem_file)
    inputs = [places[file] for file in given if file is not None]
    yield "README.md", _readme(comparison, inputs, settings, has_functions=functions is not None)


def _plan_files(name: str, side: Side) -> Iterator[tuple[str, str]]:
    if side.pddl:
        yield f"{name}-plan.pddl", "".join(map(_line, side.pddl))
    if side.result.steps:
        yield f"{name}-plan.txt", plan_text(side.result.steps)
        yield f"{name}-plan.json", json.dumps(side.result.json(), indent=2) + "\n"


def _line(step: PddlStep) -> str:
    return f"({' '.join((step.action, *step.arguments))})\n"


def _places(compilation: Compilation) -> Mapping[str, str]:
    """Where the texts that were read stand in the folder: as they stood to each other."""
    given = {name: os.path.abspath(_path(name)) for name in compilation.sources}  # noqa: PTH100
    common = Path(os.path.commonpath([str(Path(path).parent) for path in given.values()]))
    return {
        name: f"cdl/{Path(path).relative_to(common).as_posix()}" for name, path in given.items()
    }


def _path(name: str) -> str:
    return "stdin.cdl" if name == STANDARD_INPUT else name


# ------------------------------------------------------------------------------------------- README


def _readme(
    comparison: Comparison, inputs: list[str], settings: Settings, *, has_functions: bool
) -> str:
    planner = comparison.planner
    engine = settings.engine or (None if planner is None else planner.result.engine)
    options = [] if engine is None else ["--engine", engine]
    options += ["--time-limit", f"{settings.time_limit:g}"]
    if settings.node_limit is not None:
        options += ["--node-limit", str(settings.node_limit)]
    if settings.axioms:
        options += ["--derived", "axioms"]
    functions = ["--functions", "functions.py"] if has_functions else []
    parts = [
        f"# {comparison.outcome}: {_stem(comparison.file)}",
        comparison.reason[:1].upper() + comparison.reason[1:] + ".",
        _WHAT,
        "Run here, this repeats it:",
        _block([shlex.join(["cdlc", "crosscheck", *inputs, *options, *functions])]),
        "and these look at the plans:",
        _block([*_looks(comparison, inputs, functions)]),
        _FILES,
        "## Versions",
        _block([*_versions()]),
    ]
    return "\n\n".join(parts) + "\n"


_WHAT = """A mismatch is a fault of cdlc or of a planner, not of the program: please report it with
this folder."""
_FILES = """`domain.pddl` and `problem.pddl` are what `cdlc compile --emit pddl` makes of `cdl/`;
`comparison.json` has everything that was found."""


def _block(lines: list[str]) -> str:
    return "\n".join(["```", *lines, "```"])


def _looks(comparison: Comparison, inputs: list[str], functions: list[str]) -> Iterator[str]:
    for name, side in (("planner", comparison.planner), ("program", comparison.program)):
        if side is None or side.status != "plan":
            continue
        for kind in ("pddl",) if side.pddl else ("json",) if side.result.steps else ():
            yield shlex.join(["cdlc", "validate", *inputs, f"{name}-plan.{kind}", *functions])
    yield shlex.join(["cdlc", "compile", *inputs, "--emit", "hoare"])


def _versions() -> Iterator[str]:
    for package in _PACKAGES:
        with suppress(PackageNotFoundError):
            yield f"{package} {version(package)}"
    yield f"Python {sys.version.split()[0]}"
    yield platform.platform()
