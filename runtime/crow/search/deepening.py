"""Depth-first search over the points of the CROW engine, and iterative deepening around it."""

from collections.abc import Callable, Hashable, Iterator
from dataclasses import dataclass
from math import inf
from typing import Final

from crow.search.machine import Machine
from crow.search.points import GENERATOR, SOLVER, Choice, Point, Undecided
from crow.unknowns import Touched

DEPTH: Final = 1
"""A branch was cut by the depth limit."""
COMMIT: Final = 2
"""A branch was cut by a `commit`."""
FOUND: Final = 4
"""A plan was found below."""
HOPELESS: Final = 8
"""A branch was cut because nothing within the depth limit could make true what it needs."""
WIDTH: Final = 16
"""A branch was cut by the limit of width."""
_FINAL: Final = GENERATOR | SOLVER
"""What is the same in a deeper round."""


@dataclass(slots=True)
class Entry:
    """A choice on the way to the current point; `left_out` says what was cut below it."""

    key: Hashable
    options: Iterator[Point]
    left_out: int = 0


class Search:
    """One search: what it remembers lasts from round to round.

    `check` is called again and again and may raise.
    """

    def __init__(self, machine: Machine, check: Callable[[], None]) -> None:
        self.machine = machine
        self.check = check
        self.stack: list[Entry] = []
        self.remembered: dict[Hashable, int] = {}
        self.left_out = 0
        self.duplicates = 0
        self.pause_at = inf
        machine.height = lambda: len(self.stack)
        machine.commit = self._commit

    def round(self, depth: int) -> Iterator[Point | None]:
        """The points with nothing left to do up to a depth; `left_out` says what was cut.

        None where `pause_at` nodes have been made.
        """
        machine = self.machine
        machine.depth_limit = depth
        # What was searched through without a cut is a dead end at any depth.
        self.remembered = {k: cut for k, cut in self.remembered.items() if not cut & ~_FINAL}
        self.stack = [Entry(None, iter((machine.start(),)))]
        while self.stack:
            self.check()
            if machine.counters.nodes >= self.pause_at:
                yield None
            entry = self.stack[-1]
            machine.is_cut = machine.is_hopeless = machine.is_too_wide = False
            machine.cut_of_values = 0
            point = self._next(entry)
            step = None if point is None else machine.run(point)
            entry.left_out |= machine.cut_of_values
            if machine.is_cut:
                entry.left_out |= DEPTH
            if machine.is_too_wide:
                entry.left_out |= WIDTH
            if machine.is_hopeless:
                entry.left_out |= HOPELESS
            if point is None:
                self._leave(self.stack.pop())
                continue
            if isinstance(step, Choice):
                self._enter(step, entry)
            elif step is not None:
                entry.left_out |= FOUND
                yield step

    def _next(self, entry: Entry) -> Point | None:
        try:
            return next(entry.options, None)
        except (Touched, Undecided):  # an `if` in the M of a member, say
            entry.left_out |= SOLVER
            return None

    def _enter(self, choice: Choice, above: Entry) -> None:
        """Go on below a choice, unless it is known to lead nowhere."""
        key = choice.point.key if self.machine.prunes else None
        if key is not None and key in self.remembered:
            self.duplicates += 1
            above.left_out |= self.remembered[key]
            return
        self.stack.append(Entry(key, choice.options))

    def _leave(self, entry: Entry) -> None:
        if entry.key is not None and not entry.left_out & (COMMIT | FOUND):
            self.remembered[entry.key] = entry.left_out
        if self.stack:
            self.stack[-1].left_out |= entry.left_out
        else:
            self.left_out = entry.left_out

    def _commit(self, point: Point) -> None:
        """No other way through this section is tried (semantics.md §2)."""
        if point.cuts is None:
            return
        since, kept, _ = point.cuts
        for index in range(since, len(self.stack)):
            if index not in kept:
                self.stack[index].options = iter(())
                self.stack[index].left_out |= COMMIT
