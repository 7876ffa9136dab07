"""The CROW engine with iterative deepening."""

from collections.abc import Callable, Iterator
from typing import Any

from crow.plan import Step
from crow.problem import Problem
from crow.refinement import Refinement
from crow.search.deepening import COMMIT, DEPTH, HOPELESS, WIDTH, Search
from crow.search.explain import explanation
from crow.search.machine import Machine
from crow.search.plans import plan_of
from crow.search.points import DRAWS, GENERATOR, SOLVER
from crow.search.tree import refinement
from crow.search.width import Narrow
from crow.trace import Trace

Found = tuple[tuple[Step, ...], Trace]


class CrowEngine:
    """The forward engine; with `prunes` off it enumerates every refinement.

    With a `width` it prunes, and leaves out programs that are wider.
    """

    def __init__(
        self,
        problem: Problem,
        check: Callable[[int], None],
        *,
        prunes: bool = True,
        width: int | None = None,
        seed: int = 0,
    ) -> None:
        self.problem = problem
        self.width = width
        self.machine = (
            Machine(problem, prunes=prunes, seed=seed)
            if width is None
            else Narrow(problem, width, seed=seed)
        )
        counters = self.machine.counters
        self.search = Search(self.machine, lambda: check(counters.nodes))

    def round(self, depth: int, draws: int = 1) -> Iterator[Found | None]:
        """The plans up to a depth and a number of values from each generator call.

        None where `search.pause_at` nodes have been made.
        """
        search, machine = self.search, self.machine
        if machine.draws_values:
            machine.solving.most = draws
        for point in search.round(depth):
            yield None if point is None else plan_of(self.machine, point)
        if search.left_out & HOPELESS and not search.left_out & DEPTH:
            # What nothing within the limit can make true may be true deeper: look whether there
            # is anything deeper.
            machine.protects = False
            for point in search.round(depth):
                yield None if point is None else plan_of(self.machine, point)
            machine.protects = True

    def left_out(self) -> tuple[str, ...]:
        """What the last round left out."""
        found = self.search.left_out
        names = {
            DEPTH: "depth", WIDTH: "width", DRAWS: "draws", COMMIT: "commit",
            GENERATOR: "generator", SOLVER: "solver",
        }  # fmt: skip
        return tuple(name for flag, name in names.items() if found & flag)

    def statistics(self) -> dict[str, Any]:
        """Nodes, and branches left out by kind."""
        counters, search = self.machine.counters, self.search
        told: dict[str, Any] = {}
        if self.machine.draws_values:
            told = self.machine.solving.statistics()
        wide = {} if self.width is None else {"width": counters.cut_by_width}
        return {
            "nodes": counters.nodes,
            "effects": counters.effects,
            "states": len(self.machine.store.known),
            "pruned": {
                "depth": counters.cut_by_depth,
                **wide,
                "duplicates": search.duplicates,
                "hopeless": counters.hopeless,
            },
            **told,
        }

    def explanation(self) -> str | None:
        """The condition that failed farthest on the way, and the facts it reads."""
        return explanation(self.machine)

    def refinement(self) -> Refinement:
        """The tree of the plan that was found last, or of the branch that came farthest."""
        return refinement((self.machine,), self.machine)
