"""A task as unified-planning's own problem, for everything that library does with one."""

from importlib.util import find_spec
from typing import TYPE_CHECKING, ClassVar

from cdlc.backends.errors import NotInFormat
from cdlc.diagnostics import Collector
from crow.program import Location

if TYPE_CHECKING:
    from unified_planning.model import Problem as UpProblem

    from cdlc.backends.pddl import PddlTask


class UpMissing(Exception):  # noqa: N818 - as EngineMissing
    """unified-planning is not installed; the message names the cure."""

    code: ClassVar[str] = "engine-missing"

    def __str__(self) -> str:
        return 'unified-planning is not installed: pip install "cdlc[planners]"'


def missing() -> UpMissing | None:
    """What to say if unified-planning cannot be imported; imports nothing."""
    return UpMissing() if find_spec("unified_planning") is None else None


def report_unfit(task: "PddlTask", found: Collector) -> None:
    """Report what unified-planning has no form for: derived predicates."""
    if task.has_axioms:
        found.add(derived(task, "form in unified-planning"))


def derived(task: "PddlTask", format_: str) -> NotInFormat:
    """The first derived predicate of a task that has some, as one that a format has not."""
    first = task.sections.domain.axioms[0].name
    predicates = (f for f in task.program.functions if task.names.has("derived", f.name))
    function = next(f for f in predicates if task.names.get("derived", f.name) == first)
    return NotInFormat(
        location=function.location or Location("", 1, 1, 1, 1),
        construct=f"`{function.name}`, a derived predicate that is too large unfolded,",
        format=format_,
        cure="`--emit pddl` has derived predicates",
    )


def up_text(task: "PddlTask") -> str:
    """The task as unified-planning writes its problems, for people. Raises as `to_up` does."""
    return f"{to_up(task)}".rstrip("\n") + "\n"


def to_up(task: "PddlTask") -> "UpProblem":
    """The emitted PDDL, as unified-planning reads it. Names are in lower case, as PDDL has none.

    Raises ValueError for a task with derived predicates, which unified-planning has not, or one
    without a problem.
    """
    from unified_planning.io import PDDLReader

    if task.problem is None:
        raise ValueError("unified-planning needs a problem, too")
    if task.has_axioms:
        raise ValueError("unified-planning has no derived predicates")
    return PDDLReader().parse_problem_string(task.domain, task.problem)
