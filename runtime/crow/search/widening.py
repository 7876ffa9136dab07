"""Iterative widening: rounds over the width K = 1, 2, … of programs (§3.1, CROW-IW)."""

from collections.abc import Callable, Generator, Iterator
from typing import Any, Final

from crow.problem import Problem
from crow.refinement import Refinement
from crow.search.engine import CrowEngine, Found
from crow.search.strategies import Deepening, until_pause

FIRST_TURN: Final = 1_000
"""The nodes of the first turn of a width; each next one has twice as many."""


class _Width:
    """The search of one width, by deepening, in turns."""

    def __init__(
        self, problem: Problem, check: Callable[[int], None], width: int,
        depth_limit: int | None, seed: int, draw_limit: int | None,
    ) -> None:  # fmt: skip
        self.width = width
        self.crow = CrowEngine(problem, check, width=width, seed=seed)
        self.deepening = Deepening(self.crow, depth_limit, draw_limit)
        self.found = self.deepening.plans()
        self.is_over = False

    @property
    def nodes(self) -> int:
        """The nodes made so far."""
        return self.crow.machine.counters.nodes

    def turn(self, nodes: int) -> Generator[Found, None, bool]:
        """The plans found within so many nodes more; returns whether there are no others."""
        self.crow.search.pause_at = self.nodes + nodes
        self.is_over = yield from until_pause(self.found)
        return self.is_over


class Widening:
    """Rounds over K, each by deepening, until one leaves nothing out for its width or depth.

    A width whose programs nest without end would never be over, so a round goes on by turns with
    those of the next widths, each of which has half as many nodes as the one before. What width K
    finds with T nodes is found with at most some 2^(k + 2) T, where k widths below are not over.
    """

    def __init__(
        self, problem: Problem, check: Callable[[int], None], depth_limit: int | None,
        *, seed: int = 0, draw_limit: int | None = None,
    ) -> None:  # fmt: skip
        self.problem = problem
        self.check = check
        self.limits = depth_limit, seed, draw_limit
        self.widths: list[_Width] = []
        self.current = self._wider()

    def _wider(self) -> _Width:
        width = _Width(self.problem, self._check, len(self.widths) + 1, *self.limits)
        self.widths.append(width)
        return width

    def _check(self, _nodes: int) -> None:
        self.check(sum(width.nodes for width in self.widths))

    def plans(self) -> Iterator[Found | None]:
        """Plans, some more than once, those of programs of width 1 first."""
        most = FIRST_TURN
        while True:
            nodes = most
            for width in self.widths:
                if width.is_over:
                    continue
                self.current = width
                is_over = yield from width.turn(nodes)
                if is_over and "width" not in width.crow.left_out():
                    return
                nodes //= 1 if is_over else 2
            if nodes >= FIRST_TURN:
                self._wider()
            else:
                most *= 2

    def left_out(self) -> tuple[str, ...]:
        """What was left out in the end, when width was no reason any more."""
        return self.current.deepening.left_out()

    def statistics(self) -> dict[str, Any]:
        """Figures so far: the width and depth of the last turn, everything else in all turns."""
        told: dict[str, Any] = {"width": self.current.width, "depth": self.current.deepening.depth}
        for width in self.widths:
            figures = width.crow.statistics()
            for name in ("nodes", "effects", "states"):
                told[name] = told.get(name, 0) + figures[name]
            pruned = told.setdefault("pruned", {})
            for name, count in figures["pruned"].items():
                pruned[name] = pruned.get(name, 0) + count
        return told

    def explanation(self) -> str | None:
        """What failed, farthest on the way to the goal."""
        return self.current.deepening.explanation()

    def refinement(self) -> Refinement:
        """How the plan that was found last refines the goal; without one, how far it came."""
        return self.current.crow.refinement()
