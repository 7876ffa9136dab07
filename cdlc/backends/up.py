"""A task as unified-planning's own problem, for everything that library does with one."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from unified_planning.model import Problem as UpProblem

    from cdlc.backends.pddl import PddlTask


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
