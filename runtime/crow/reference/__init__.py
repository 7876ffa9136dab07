"""The reference engine: every sound trace up to a depth, by REFINE of App. A.

It is slow and shares no code with the CROW engine beyond the normal form of conditions and the
matching of goals: the tests compare the two.
"""

from collections.abc import Callable, Iterator
from typing import Any

from crow.budget import Stopped
from crow.plan import Step
from crow.problem import Problem
from crow.reference.refine import BOUND, Refinement, Result
from crow.reference.tree import tree_of
from crow.refinement import Refinement as Tree
from crow.trace import DoItem, EffItem, Trace

__all__ = ["ReferenceEngine", "Refinement", "refinements"]


def refinements(
    problem: Problem, refinement: Refinement
) -> Iterator[tuple[tuple[Step, ...], Trace]]:
    """Every plan that a refinement of the goal gives, with its trace; some more than once."""
    for result in refinement.goal(problem.initial, problem.goal):
        yield found(result)


def found(result: Result) -> tuple[tuple[Step, ...], Trace]:
    """A refinement as a plan with its trace."""
    return _steps(result), tuple(item for item, _ in result[2])


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


class ReferenceEngine:
    """The reference engine, a round at a time."""

    def __init__(self, problem: Problem, check: Callable[[int], None]) -> None:
        self.problem = problem
        self.check = check
        self.last = Refinement(problem.world, 0)
        self.nodes = 0
        self.result: Result | None = None

    def round(self, depth: int, _draws: int = 1) -> Iterator[tuple[tuple[Step, ...], Trace]]:
        """The plans up to a depth; nothing is drawn."""
        self.nodes += self.last.nodes
        self.last = last = Refinement(
            self.problem.world, depth, lambda: self.check(self.nodes + last.nodes)
        )
        try:
            for result in last.goal(self.problem.initial, self.problem.goal):
                self.result = result
                yield found(result)
        except RecursionError:
            raise Stopped("recursion") from None

    def left_out(self) -> tuple[str, ...]:
        """What the last round left out."""
        cut = {"depth": self.last.is_cut, "commit": self.last.has_committed}
        return tuple(name for name, is_cut in cut.items() if is_cut)

    def statistics(self) -> dict[str, Any]:
        """Nodes."""
        return {"nodes": self.nodes + self.last.nodes}

    def explanation(self) -> str | None:
        """The condition that failed farthest on the way in the last round."""
        farthest = self.last.farthest
        return None if farthest is None else farthest[1].text(self.problem)

    def refinement(self) -> Tree:
        """The tree of the plan that was found last; nothing is known of what failed."""
        return Tree() if self.result is None else tree_of(self.problem, self.result)
