"""From the checked program to the runtime's problem."""

from cdlc.backends.errors import MissingFunction, NoInitialValue, NotPlannable
from cdlc.diagnostics import Collector
from crow.evaluate import EvaluationError
from crow.functions import Registered
from crow.problem import Problem
from crow.program import Location, ProblemStatement, Program
from crow.support import OF_OBJECTS


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


def check_plannable(problem: Problem, found: Collector, engine: str = "auto") -> None:
    """Report what an engine of the runtime does not cover, or has no Python for."""
    missing = problem.world.unsupported
    if missing is None and engine in OF_OBJECTS:
        missing = problem.world.chosen_value
    if missing is not None:
        location = missing.location or Location("", 1, 1, 1, 1)
        if missing.function is not None:
            found.add(MissingFunction(location=location, function=missing.function))
        else:
            found.add(NotPlannable(location=location, construct=missing.construct, engine=engine))
