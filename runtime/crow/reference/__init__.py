"""The reference engine: every sound trace up to a depth, by REFINE of App. A.

It is slow and shares no code with the CROW engine beyond the normal form of conditions and the
matching of goals: the tests compare the two.
"""

from collections.abc import Iterator

from crow.plan import Step
from crow.problem import Problem
from crow.reference.refine import BOUND, Refinement, Result
from crow.trace import DoItem, EffItem, Trace

__all__ = ["Refinement", "refinements"]


def refinements(problem: Problem, refinement: Refinement) -> Iterator[tuple[tuple[Step, ...], Trace]]:
    """Every plan that a refinement of the goal gives, with its trace; some more than once."""
    for result in refinement.goal(problem.initial, problem.goal):
        yield _steps(result), tuple(item for item, _ in result[2])


def _steps(result: Result) -> tuple[Step, ...]:
    """One step a controller call, and one for an effect that came without any."""
    _, values, trace = result
    callers = {owner for item, owner in trace if isinstance(item, DoItem)}
    steps = []
    for item, owner in trace:
        behavior = owner.behavior
        if behavior is None:
            continue
        own = (behavior.name, owner.arguments, dict(values.get((owner, BOUND), {})))
        match item:
            case DoItem(controller=name, arguments=arguments):
                steps.append(Step(*own, name, arguments))
            case EffItem() if owner not in callers and item.owner == behavior.name:
                steps.append(Step(*own, None))
            case _:
                pass
    return tuple(steps)
