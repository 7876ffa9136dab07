"""Public PDDL benchmarks through CDL and back: is the task as large as before, is a best plan as
costly?
"""

import os
import tempfile
from pathlib import Path

from benchmarks.table import Figure, Table
from benchmarks.translator import TaskSize, TranslatorError, optimal_cost, task_size
from cdlc.backends.pddl import PddlTask
from cdlc.diagnostics import Severity
from cdlc.driver import CompileError, problem_compilation
from cdlc.importing import import_pddl

FOLDER = Path(os.environ.get("CDLC_PDDL", Path(__file__).parents[2] / "shared" / "pddl"))
"""Files `<domain>/<name>-domain.pddl` and `<domain>/<name>.pddl`, of any collection."""

_COLUMNS = (
    "instance", "facts", "ours", "operators", "ours", "axioms", "ours", "cost", "ours", "result",
)  # fmt: skip
_SECONDS = 20
"""For an optimal plan of one task; `?` is more."""

_FEW = 6


def instances() -> list[Path]:
    """The problem files of the folder, which have their domain beside them."""
    found = (p for p in FOLDER.glob("*/*.pddl") if not p.stem.endswith("-domain"))
    return sorted(p for p in found if domain_of(p).exists())


def _size(problem: Path) -> int:
    return problem.stat().st_size + domain_of(problem).stat().st_size


def domain_of(problem: Path) -> Path:
    """The domain file beside a problem file."""
    return problem.with_name(f"{problem.stem}-domain.pddl")


def run(quick: bool) -> Table:
    """Each task as it was and as it comes back: its size and its optimal cost; with `quick` those
    of a few small files.
    """
    chosen = sorted(instances(), key=_size)[:_FEW] if quick else instances()
    rows = tuple(map(_row, sorted(chosen)))
    note = f"target: equal, or refused with the reason; ? is no optimal plan in {_SECONDS} s"
    return Table("imports", _COLUMNS, rows, note)


def _row(problem: Path) -> tuple[Figure, ...]:
    name = f"{problem.parent.name}/{problem.stem}"
    before = task_size(domain_of(problem).read_text(), problem.read_text())
    try:
        task = through_cdl(problem)
        after = task_size(task.domain, task.problem or "")
    except CompileError as error:
        first = next(d for d in error.diagnostics if d.severity is Severity.ERROR)
        return (name, *_sizes(before, None), "-", "-", first.message())
    except TranslatorError as error:
        return (name, *_sizes(before, None), "-", "-", str(error).strip().splitlines()[-1])
    cost = optimal_cost(domain_of(problem).read_text(), problem.read_text(), _SECONDS)
    # Where the first is close to the limit, the second gets some more time.
    ours = None if cost is None else optimal_cost(task.domain, task.problem or "", 2 * _SECONDS)
    result = "equal" if same_size(before, after) and cost == ours else "differs"
    return (name, *_sizes(before, after), *("?" if c is None else c for c in (cost, ours)), result)


def same_size(before: TaskSize, after: TaskSize) -> bool:
    """Whether search works on a task as large as before."""
    return (before.facts, before.operators) == (after.facts, after.operators)


def _sizes(before: TaskSize, after: TaskSize | None) -> tuple[Figure, ...]:
    pairs = (
        (before.facts, after.facts if after else "-"),
        (before.operators, after.operators if after else "-"),
        (before.axioms, after.axioms if after else "-"),
    )
    return tuple(figure for pair in pairs for figure in pair)


def through_cdl(problem: Path) -> PddlTask:
    """A problem imported, checked and emitted again. Raises cdlc.driver.CompileError."""
    imported = import_pddl(str(domain_of(problem)), str(problem), bytes)
    if not imported.texts:
        raise CompileError(imported.diagnostics, imported.sources)
    with tempfile.TemporaryDirectory(prefix="imports-") as name:
        folder = Path(name)
        for file, text in imported.texts.items():
            (folder / file).write_text(text)
        compilation = problem_compilation([str(folder / "problem.cdl")])
        assert compilation is not None
        return compilation.pddl
