"""Imperative programs, run straight on: no search state is kept (semantics.md §5).

There is one state, which changes in place, so a plan takes time linear in its length.
"""

from collections.abc import Callable, Iterable, Iterator
from math import inf
from typing import Any, Final

from crow.problem import Cell, Problem
from crow.refinement import Refinement
from crow.search.code import Code, Op, UnorderedOp
from crow.search.deepening import Search
from crow.search.engine import Found
from crow.search.frames import Application, Context, Frame, Held, Kind, Shared
from crow.search.machine import Machine
from crow.search.members import with_slots
from crow.search.plans import plan_of
from crow.search.points import Choice, Point, Step
from crow.search.states import Snapshot, Store
from crow.search.strategies import Auto, Check, until_pause
from crow.search.tree import refinement
from crow.values import Value

Environment = tuple[Value, ...]


FIRST_TURN: Final = 100_000
"""The nodes of the first turn; each next one has twice as many."""

_DEEPEST: Final = 1 << 60


class StraightFirst:
    """`auto` for an imperative program: run straight on, by turns with a search.

    Nearly always the first turn ends with the plan. The search is for those that run without end,
    or whose unordered groups have to be run in another order.
    """

    def __init__(
        self, straight: "Straight", check: Callable[[int], None], search: Callable[[Check], Auto]
    ) -> None:
        self.check = check
        self.straight = straight
        self.straight.check = self._check
        self._make = search
        self.auto: Auto | None = None

    def _check(self) -> None:
        self.check(self.straight.nodes)

    def _searched(self, nodes: int) -> None:
        self.check(self.straight.nodes + nodes)

    def plans(self) -> Iterator[Found | None]:
        """Plans, some more than once."""
        turn = FIRST_TURN
        straight, others = self.straight.plans(), None
        while True:
            self.straight.pause(turn)
            yield from until_pause(straight)
            if others is None:
                self.auto = self._make(self._searched)
                others = self.auto.plans()
            if (yield from until_pause(others)):
                return
            turn *= 2

    def left_out(self) -> tuple[str, ...]:
        """What was left out in the end."""
        return () if self.auto is None else self.auto.left_out()

    def statistics(self) -> dict[str, Any]:
        """Figures so far, of the run and the search together."""
        told = self.straight.statistics()
        if self.auto is None:
            return told
        other = self.auto.statistics()
        both = {k: told[k] + other[k] for k in ("nodes", "effects", "states")}
        return {**other, **both, "depth": max(told["depth"], other["depth"])}

    def explanation(self) -> str | None:
        """What failed, farthest on the way to the goal."""
        return None if self.auto is None else self.auto.explanation()

    def refinement(self) -> Refinement:
        """How the plan refines the goal; without one, how far the search came."""
        return self.straight.refinement() if self.auto is None else self.auto.refinement()


class Straight:
    """The one refinement of an imperative program; `check` is called again and again."""

    def __init__(self, machine: "_Machine") -> None:
        self.machine = machine
        self.check: Callable[[], None] = lambda: None
        self.pause_at: float = inf

    @staticmethod
    def of(problem: Problem, depth_limit: int | None) -> "Straight | None":
        """The run of a problem; None where its program is not imperative."""
        if not problem.is_imperative:
            return None
        machine = _Machine(problem)
        machine.depth_limit = _DEEPEST if depth_limit is None else depth_limit
        return Straight(machine)

    def plans(self) -> Iterator[Found | None]:
        """The plan, if there is one; None where `pause_at` nodes have been made."""
        machine = self.machine
        step: Step = machine.start()
        while step is not None:
            self.check()
            if machine.counters.nodes >= self.pause_at:
                yield None
            if isinstance(step, Choice):
                step = _only(step.options)
            elif step.frame is None:
                yield plan_of(machine, step)
                return
            else:
                step = machine.run(step)

    @property
    def nodes(self) -> int:
        """The nodes made so far."""
        return self.machine.counters.nodes

    def pause(self, nodes: int) -> None:
        """Pause after so many nodes more."""
        self.pause_at = self.nodes + nodes

    def refinement(self) -> Refinement:
        """How the plan refines the goal: run once more, with states that are kept."""
        machine = Machine(self.machine.problem, counts_depth=False)
        machine.depth_limit = 1
        search = Search(machine, self.check)
        search.pause_at = 2 * self.nodes + FIRST_TURN
        point = next(search.round(1), None)
        if point is not None:
            plan_of(machine, point)
        return refinement((machine,), machine)

    def statistics(self) -> dict[str, Any]:
        """Figures so far."""
        counters = self.machine.counters
        return {
            "nodes": counters.nodes,
            "depth": self.machine.deepest,
            "effects": counters.effects,
            "states": 1,
            "pruned": {"depth": counters.cut_by_depth},
        }


def _only(options: Iterator[Point]) -> Point | None:
    """The one way on, if there is just one."""
    first = next(options, None)
    return None if next(options, None) is not None else first


class _Machine(Machine):
    """Runs unordered groups in the order in which they are written, and shares nothing."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(problem)
        self.shared = _Unshared()
        self.deepest = 0
        self._ops[UnorderedOp] = self._group
        self._frames[Kind.UNORDERED] = self._iteration

    def make_store(self) -> Store:
        """The one state."""
        return _InPlace(self.problem.world, self.problem.initial)

    def application(
        self, code: Code, arguments: tuple[Value, ...], above: Application, depth: int
    ) -> Application | None:
        """A behavior applied in a program of some depth, unless too deep or nested too often."""
        found = super().application(code, arguments, above, depth)
        if found is not None and found.depth > self.deepest:
            self.deepest = found.depth
        return found

    def _group(self, point: Point, op: Op, rest: Frame | None) -> Step:
        assert isinstance(op, UnorderedOp)
        if op.variables is None:
            return point.at(self.block(op.body, rest), point.context)
        return point.at(Frame(Kind.UNORDERED, op, 0, None, rest), point.context)

    def _iteration(self, point: Point, frame: Frame) -> Step:
        """The next iteration of a `foreach`."""
        op, index, context = frame.first, frame.second, point.context
        assert context is not None
        slots, tuples = op.variables
        if index == len(tuples):
            return point.at(frame.next, context)
        rest = Frame(Kind.UNORDERED, op, index + 1, None, frame.next)
        values = with_slots(context.values, slots, tuples[index])
        own = Context(context.application, values, context.held)
        return point.at(self.block(op.body, rest), own)


class _InPlace(Store):
    """A store whose one state changes."""

    def after(self, before: Snapshot, written: Iterable[tuple[Cell, Value]]) -> Snapshot:
        """The same state, after some cells were written."""
        base, delta, defaults = self.base, before.delta, self.defaults
        for cell, value in written:
            if base.get(cell, defaults[cell[0]]) == value:
                delta.pop(cell, None)
            else:
                delta[cell] = value
        return before


class _Unshared(Shared):
    """Makes every object anew, as none is compared."""

    def application(
        self,
        code: Code | None,
        arguments: tuple[Value, ...],
        depth: int,
        nested: tuple[tuple[str, int], ...],
    ) -> Application:
        """An application."""
        return Application(code, arguments, depth, nested)

    def context(self, application: Application, values: Environment, held: Held) -> Context:
        """A context."""
        return Context(application, values, held)

    def frame(
        self, kind: Kind, following: Frame | None, first: Any = None, second: Any = None,
        third: Any = None,
    ) -> Frame:  # fmt: skip
        """A frame."""
        return Frame(kind, first, second, third, following)
