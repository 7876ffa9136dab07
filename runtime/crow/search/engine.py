"""The CROW engine with iterative deepening."""

from collections.abc import Callable, Iterator
from typing import Any

from crow.evaluate import shown_cell
from crow.plan import Step
from crow.problem import Problem
from crow.program import Read, Variable
from crow.program.expressions import Expression, Object
from crow.program.walk import subexpressions
from crow.search.deepening import COMMIT, DEPTH, HOPELESS, Search
from crow.search.machine import Machine
from crow.search.plans import plan_of, variables
from crow.text import expression_text
from crow.trace import Trace

_MOST_FACTS = 8


class CrowEngine:
    """The forward engine; with `prunes` off it enumerates every refinement."""

    def __init__(
        self, problem: Problem, check: Callable[[int], None], *, prunes: bool = True
    ) -> None:
        self.problem = problem
        self.machine = Machine(problem, prunes=prunes)
        counters = self.machine.counters
        self.search = Search(self.machine, lambda: check(counters.nodes))

    def round(self, depth: int) -> Iterator[tuple[tuple[Step, ...], Trace]]:
        """The plans up to a depth."""
        search, machine = self.search, self.machine
        for point in search.round(depth):
            yield plan_of(self.problem.world, point)
        if search.left_out & HOPELESS and not search.left_out & DEPTH:
            # What nothing within the limit can make true may be true deeper: look whether there
            # is anything deeper.
            machine.protects = False
            for point in search.round(depth):
                yield plan_of(self.problem.world, point)
            machine.protects = True

    def left_out(self) -> tuple[str, ...]:
        """What the last round left out."""
        found = self.search.left_out
        names = {DEPTH: "depth", COMMIT: "commit"}
        return tuple(name for flag, name in names.items() if found & flag)

    def statistics(self) -> dict[str, Any]:
        """Nodes, and branches left out by kind."""
        counters, search = self.machine.counters, self.search
        return {
            "nodes": counters.nodes,
            "effects": counters.effects,
            "states": len(self.machine.store.known),
            "pruned": {
                "depth": counters.cut_by_depth,
                "duplicates": search.duplicates,
                "hopeless": counters.hopeless,
            },
        }

    def explanation(self) -> str | None:
        """The condition that failed farthest on the way, and the facts it reads."""
        dead = self.machine.dead
        if dead.test is None or dead.state is None:
            return None
        condition = dead.test.condition
        names = variables(dead.test.slots, dead.values)
        where = f" at {dead.test.location}" if dead.test.location is not None else ""
        used = {p.name: names[p.name] for p in subexpressions(condition)
                if isinstance(p, Variable) and p.name in names}  # fmt: skip
        given = ", ".join(f"{name} = {value}" for name, value in used.items())
        with_ = f" with {given}" if given else ""
        text = f"`{expression_text(condition)}`{where}{with_}: {dead.reason}"
        facts = self._facts(condition, names)
        return f"{text}; there, {facts}" if facts else text

    def _facts(self, condition: Expression, names: dict[str, Any]) -> str:
        """The values of the cells that a condition reads by name."""
        state = self.machine.dead.state
        assert state is not None
        facts: dict[str, None] = {}
        for part in subexpressions(condition):
            if isinstance(part, Read):
                known = [_known(a, names) for a in part.arguments]
                if None not in known:
                    cell = (part.feature, tuple(known))
                    value = state.cells.get(cell, self.machine.store.defaults[part.feature])
                    facts[f"{shown_cell(cell)} is {value}"] = None
        return ", ".join(list(facts)[:_MOST_FACTS])


def _known(argument: Expression, names: dict[str, Any]) -> Any:
    match argument:
        case Object(name=name):
            return name
        case Variable(name=name):
            return names.get(name)
        case _:
            return None
