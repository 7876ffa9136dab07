"""From the checked program to the runtime's problem."""

from cdlc.backends.errors import NoInitialValue, NotPlannable
from cdlc.diagnostics import Collector
from crow.evaluate import EvaluationError
from crow.functions import Registered
from crow.problem import Problem
from crow.program import Location, ProblemStatement, Program


def to_runtime(
    program: Program, statement: ProblemStatement, found: Collector, registered: Registered
) -> Problem | None:
    """The runtime's problem; None, with a diagnostic, when its `init` has no value.

    Raises crow.FunctionError where Python that its `init` calls fails.
    """
    try:
        return Problem.of(program, statement, registered)
    except EvaluationError as error:
        location = error.location or Location("", 1, 1, 1, 1)
        found.add(NoInitialValue(location=location, reason=str(error)))
        return None


def check_plannable(problem: Problem, found: Collector) -> None:
    """Report what the runtime's planner would have to choose a value for."""
    missing = problem.world.unsupported
    if missing is not None:
        location = missing.location or Location("", 1, 1, 1, 1)
        found.add(NotPlannable(location=location, construct=missing.construct))
