"""Strategies over the points of the CROW engine: best-first search, and both by turns."""

from collections.abc import Callable, Generator, Iterator
from itertools import count
from math import inf
from typing import Any, Final, Protocol

from crow.problem import Problem
from crow.refinement import Refinement
from crow.search.best import BestFirst
from crow.search.engine import CrowEngine, Found
from crow.search.explain import explanation
from crow.search.machine import Machine
from crow.search.plans import plan_of
from crow.search.tree import refinement

DEEPENING_TURN: Final = 100
"""The nodes of the first turn of deepening in `auto`; each next one has four times as many."""

BEST_TURN: Final = 5_000
"""The nodes of the first turn of best-first search; each next one has twice as many."""

Check = Callable[[int], None]


class Rounds(Protocol):
    """An engine that searches up to a depth."""

    def round(self, depth: int, draws: int, /) -> Iterator[Found | None]:
        """The plans up to a depth and a number of draws, some more than once. Raises Stopped."""

    def left_out(self) -> tuple[str, ...]:
        """What the last round left out: `depth` first, if deeper refinements are."""

    def statistics(self) -> dict[str, Any]:
        """Figures so far."""

    def explanation(self) -> str | None:
        """What failed, farthest on the way to the goal."""

    def refinement(self) -> Refinement:
        """How the plan that was found last refines the goal; without one, how far it came."""


def until_pause(plans: Iterator[Found | None]) -> Generator[Found, None, bool]:
    """The plans until a search pauses; returns whether it has ended."""
    for found in plans:
        if found is None:
            return False
        yield found
    return True


class Deepening:
    """Iterative deepening: rounds, each a level deeper.

    Each second one doubles the draws of a call. Once nothing is deeper, or the limit is met, rounds
    go on as long as more could be drawn.
    """

    def __init__(
        self, engine: Rounds, depth_limit: int | None, draw_limit: int | None = None
    ) -> None:
        self.engine = engine
        self.depth_limit = depth_limit
        self.draw_limit = draw_limit
        self.depth = 0
        self._left_out: tuple[str, ...] = ()

    def plans(self) -> Iterator[Found | None]:
        """Plans, some more than once; None where the search has paused."""
        depth = 0
        for number in count():
            draws = _at_most(1 << (number // 2), self.draw_limit)
            self.depth = depth
            yield from self.engine.round(depth, draws)
            self._left_out = self.engine.left_out()
            goes_deeper = "depth" in self._left_out and depth != self.depth_limit
            draws_more = "draws" in self._left_out and draws != self.draw_limit
            if not goes_deeper and not draws_more:
                return
            depth += goes_deeper

    def left_out(self) -> tuple[str, ...]:
        """What was left out in the end."""
        return self._left_out

    def statistics(self) -> dict[str, Any]:
        """Figures so far."""
        return {"depth": self.depth, **self.engine.statistics()}

    def explanation(self) -> str | None:
        """What failed, farthest on the way to the goal."""
        return self.engine.explanation()

    def refinement(self) -> Refinement:
        """How the plan that was found last refines the goal; without one, how far it came."""
        return self.engine.refinement()


def _at_most(number: int, limit: int | None) -> int:
    return number if limit is None else min(number, limit)


class Best:
    """Best-first search. Depth is counted only where it is limited."""

    def __init__(
        self, problem: Problem, check: Check, depth_limit: int | None, heuristic: str
    ) -> None:
        self.problem = problem
        self.machine = machine = Machine(problem, counts_depth=depth_limit is not None)
        machine.protects = False
        machine.depth_limit = 1 if depth_limit is None else depth_limit
        self.search = BestFirst(machine, lambda: check(machine.counters.nodes), heuristic)

    def plans(self) -> Iterator[Found | None]:
        """Plans, not all of them; None where the search has paused."""
        for point in self.search.points():
            yield None if point is None else plan_of(self.machine, point)

    def left_out(self) -> tuple[str, ...]:
        """What was left out in the end."""
        cut = {"depth": self.machine.is_cut, "commit": self.search.is_cut_by_commit}
        return tuple(name for name, is_cut in cut.items() if is_cut)

    def pause(self, nodes: float) -> None:
        """Pause after so many nodes more."""
        self.search.pause_at = self.machine.counters.nodes + nodes

    def statistics(self) -> dict[str, Any]:
        """Figures so far."""
        counters, search = self.machine.counters, self.search
        return {
            "nodes": counters.nodes,
            "effects": counters.effects,
            "states": len(self.machine.store.known),
            "evaluations": search.guiding.evaluations,
            "pruned": {"depth": counters.cut_by_depth, "duplicates": search.duplicates},
        }

    def explanation(self) -> str | None:
        """What failed, farthest on the way to the goal."""
        return explanation(self.machine)

    def refinement(self) -> Refinement:
        """How the plan that was found last refines the goal; without one, how far it came."""
        return refinement((self.machine,), self.machine)


class Auto:
    """Deepening and best-first search by turns, each turn longer than the one before.

    Best-first search has the larger share at first, deepening in the end. So a plan is found
    wherever deepening finds one, for a few times its nodes. Only deepening enumerates all plans:
    its end is the end, unless best-first search has shown that there is no plan at all.
    """

    def __init__(
        self, problem: Problem, check: Check, depth_limit: int | None, heuristic: str
    ) -> None:
        self.check = check
        self.problem = problem
        self.depth_limit = depth_limit
        self.heuristic = heuristic
        self.crow = CrowEngine(problem, self._check)
        self.deepening = Deepening(self.crow, depth_limit)
        self.best: Best | None = None
        self.ended: Deepening | Best = self.deepening
        self.finder: Machine | None = None
        self.turns = 1

    def _check(self, _nodes: int) -> None:
        others = 0 if self.best is None else self.best.machine.counters.nodes
        self.check(self.crow.machine.counters.nodes + others)

    def plans(self) -> Iterator[Found | None]:
        """Plans, some more than once; None between turns."""
        turn: float = DEEPENING_TURN
        other = BEST_TURN
        deepening, best = self.deepening.plans(), None
        has_found = False
        while True:
            self.crow.search.pause_at = self.crow.machine.counters.nodes + turn
            found: Found | None
            for found in deepening:
                if found is None:
                    break
                has_found = True
                self.finder = self.crow.machine
                yield found
            else:
                return
            if best is None and self.best is None:
                self.best = Best(self.problem, self._check, self.depth_limit, self.heuristic)
                best = self.best.plans()
            if best is not None:
                assert self.best is not None
                self.best.pause(other)
                for found in best:
                    if found is None:
                        break
                    has_found = True
                    self.finder = self.best.machine
                    yield found
                else:
                    best = None
                    if not has_found and not self.best.left_out():
                        self.ended = self.best
                        return
            turn = turn * 4 if best is not None else inf
            other *= 2
            self.turns += 1
            yield None

    def left_out(self) -> tuple[str, ...]:
        """What was left out in the end."""
        return self.ended.left_out()

    def statistics(self) -> dict[str, Any]:
        """Figures so far, of both searches together."""
        told = {"turn": self.turns, **self.deepening.statistics()}
        if self.best is None:
            return told
        other = self.best.statistics()
        pruned = {k: v + other["pruned"].get(k, 0) for k, v in told["pruned"].items()}
        both = {k: told[k] + other[k] for k in ("nodes", "effects", "states")}
        return {**told, **both, "evaluations": other["evaluations"], "pruned": pruned}

    def explanation(self) -> str | None:
        """What failed, farthest on the way to the goal."""
        return explanation(max(self._machines(), key=lambda machine: machine.dead.depth))

    def refinement(self) -> Refinement:
        """How the plan that was found last refines the goal; without one, how far it came."""
        return refinement(self._machines(), self.finder)

    def _machines(self) -> tuple[Machine, ...]:
        """Those of the searches that have begun."""
        others = () if self.best is None else (self.best.machine,)
        return self.crow.machine, *others
