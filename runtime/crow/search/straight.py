"""Imperative programs, run straight on: no search state is kept (semantics.md §5).

There is one state, which changes in place, so a plan takes time linear in its length.
"""

from collections import ChainMap
from collections.abc import Callable, Iterable, Iterator, Mapping
from math import inf
from typing import TYPE_CHECKING, Any, Final

from crow.evaluate import EvaluationError
from crow.plan import Step as PlanStep
from crow.problem import Cell, Problem
from crow.refinement import Refinement
from crow.search.code import (
    AchieveOp,
    AssertOp,
    Atom,
    Block,
    CallOp,
    Code,
    DoOp,
    FixOp,
    IfOp,
    LetOp,
    SequenceOp,
    Test,
    UnorderedOp,
)
from crow.search.compile import Programs
from crow.search.deepening import Search
from crow.search.engine import Found
from crow.search.expressions import Compiled
from crow.search.machine import Machine
from crow.search.plans import assert_item, do_items, effect_item, plan_of
from crow.search.states import Snapshot, Store
from crow.search.strategies import Auto, Check, until_pause
from crow.search.tree import refinement
from crow.values import Value

if TYPE_CHECKING:
    from crow.trace import TraceItem

FIRST_TURN: Final = 100_000
"""The nodes of the first turn; each next one has twice as many."""

_TURNS_A_LOOK: Final = 63
"""A look at the limits each time these bits of a counter are 0."""


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
    """The one refinement of an imperative program; `check` is called again and again.

    The instructions that are being carried out are a stack, and each body has its variables in a
    list that changes. Where something fails or is left open after all, there is no plan from here.
    """

    def __init__(self, problem: Problem, depth_limit: int | None) -> None:
        self.problem = problem
        self.programs = Programs.of(problem.world)
        self.state = _InPlace(problem.world, problem.initial).initial
        self.check: Callable[[], None] = lambda: None
        self.pause_at: float = inf
        self.depth_limit = inf if depth_limit is None else depth_limit
        self.nodes = self.effects = self.deepest = self.cut_by_depth = 0
        self.trace: list[TraceItem] = []
        self.steps: list[PlanStep] = []
        self._stack: list[_Entry] = []
        self._carry_out: dict[type, Callable[[Any, _Body], bool]] = {
            AssertOp: lambda op, body: self._asserted(op.test, body),
            AchieveOp: self._achieve,
            CallOp: self._call,
            DoOp: self._do,
            LetOp: self._let,
            FixOp: self._fix,
            IfOp: self._if,
            SequenceOp: self._sequence,
            UnorderedOp: self._group,
        }

    @staticmethod
    def of(problem: Problem, depth_limit: int | None) -> "Straight | None":
        """The run of a problem; None where its program is not imperative."""
        return Straight(problem, depth_limit) if problem.is_imperative else None

    def plans(self) -> Iterator[Found | None]:
        """The plan, if there is one; None where `pause_at` nodes have been made."""
        wanted, test, size = self.programs.goal(self.problem.goal)
        goal = (AchieveOp(wanted, wanted.test, is_held=False), AssertOp(test, is_held=False))
        self._stack.append(_Entry(goal, _Body(None, (), size, 0, {})))
        is_over = None
        while is_over is None:
            try:
                is_over = self._run()
            except EvaluationError:
                return
            if is_over is None:
                yield None
        if is_over:
            yield tuple(self.steps), tuple(self.trace)

    def _run(self) -> bool | None:
        """Go on to the end: True there, False where it fails, None at a pause."""
        stack, carry_out, turns = self._stack, self._carry_out, 0
        while stack:
            turns += 1
            if not turns & _TURNS_A_LOOK:
                self.check()
                if self.nodes >= self.pause_at:
                    return None
            entry = stack[-1]
            if entry.index < len(entry.ops):
                op = entry.ops[entry.index]
                entry.index += 1
                if not carry_out[type(op)](op, entry.body):
                    return False
            elif entry.loop is None or not _goes_on(entry):
                stack.pop()
                if entry.caller is not None and not self._end(entry, entry.caller):
                    return False
        return True

    # ------------------------------------------------------------------------------ instructions

    def _asserted(self, test: Test, body: "_Body") -> bool:
        if not test.holds(self.state, body.values):
            return False
        self.trace.append(assert_item(test, body.values))
        return True

    def _achieve(self, op: AchieveOp, body: "_Body") -> bool:
        if op.test.holds(self.state, body.values):
            self.nodes += 1
            self.trace.append(assert_item(op.test, body.values))
            if op.is_held:
                body.held.append((op.test, tuple(body.values)))
            return True
        if not isinstance(op.wanted, Atom):
            return False
        found, is_step = op.wanted.alternatives(self.state, body.values)
        return len(found) == 1 and not is_step and self._apply(*found[0], body, op)

    def _call(self, op: CallOp, body: "_Body") -> bool:
        arguments = self._values(op.arguments, body)
        code = self.programs.code(self.problem.world.behaviors[op.behavior])
        return self._apply(code, arguments, body, None)

    def _apply(
        self, code: Code, arguments: tuple[Value, ...], caller: "_Body", op: AchieveOp | None
    ) -> bool:
        if caller.depth >= self.depth_limit:
            self.cut_by_depth += 1
            return False
        nested = caller.nested
        if code.max_nested is not None:
            name = code.behavior.name
            nested = {**nested, name: nested.get(name, 0) + 1}
            if nested[name] > code.max_nested:
                return False
        self.nodes += 1
        depth = caller.depth + 1
        self.deepest = max(self.deepest, depth)
        body = _Body(code, arguments, code.size, depth, nested)
        self._stack.append(_Entry(code.right, body, caller, op))
        return True

    def _end(self, entry: "_Entry", caller: "_Body") -> bool:
        """A behavior ends: its effect, and what it was applied for."""
        body = entry.body
        code = body.code
        assert code is not None
        if code.effect is not None:
            if not self._is_held(body):
                return False
            code.effect(self.state, body.values)
            self.effects += 1
            self.trace.append(effect_item(code, body.values))
            if not body.acts:
                self.steps.append(PlanStep(code.behavior.name, body.arguments, {}, None, ()))
        op = entry.op
        if op is not None and op.is_held:
            caller.held.append((op.test, tuple(caller.values)))
            return self._asserted(op.test, caller)
        return True

    def _do(self, op: DoOp, body: "_Body") -> bool:
        self.nodes += 1
        arguments = self._values(op.arguments, body)
        if not self._is_held(body):
            return False
        body.held.clear()
        body.acts = True
        self.trace += do_items(self.problem.world, op, arguments)
        name = "" if body.code is None else body.code.behavior.name
        self.steps.append(PlanStep(name, body.arguments, {}, op.controller, arguments))
        if op.effect is not None:
            op.effect(self.state, arguments)
            self.effects += 1
        return True

    def _is_held(self, body: "_Body") -> bool:
        """Whether what is held is still true; it is asserted again."""
        for test, values in body.held:
            if not test.holds(self.state, values):
                return False
            self.trace.append(assert_item(test, values))
        return True

    def _values(self, nodes: tuple[Compiled, ...], body: "_Body") -> tuple[Value, ...]:
        return tuple([node(self.state, body.values) for node in nodes])

    def _let(self, op: LetOp, body: "_Body") -> bool:
        self.nodes += 1
        body.values[op.slot] = op.value(self.state, body.values)
        return True

    def _fix(self, op: FixOp, body: "_Body") -> bool:
        body.values[op.slot] = op.value
        return True

    def _if(self, op: IfOp, body: "_Body") -> bool:
        self.nodes += 1
        is_true = op.test.holds(self.state, body.values)
        chosen = op.then if is_true else op.otherwise
        if chosen:
            self._stack.append(_Entry(chosen, body))
        return True

    def _sequence(self, op: SequenceOp, body: "_Body") -> bool:
        self._stack.append(_Entry(op.body, body))
        return True

    def _group(self, op: UnorderedOp, body: "_Body") -> bool:
        """An unordered group, in the order in which it is written."""
        entry = _Entry(op.body, body)
        if op.variables is not None:
            entry.slots, tuples = op.variables
            entry.loop = iter(tuples)
            entry.index = len(op.body)  # the first turn of the loop begins the body
        self._stack.append(entry)
        return True

    # ----------------------------------------------------------------------------------- reports

    def pause(self, nodes: int) -> None:
        """Pause after so many nodes more."""
        self.pause_at = self.nodes + nodes

    def refinement(self) -> Refinement:
        """How the plan refines the goal: run once more, with states that are kept."""
        machine = Machine(self.problem, counts_depth=False)
        machine.depth_limit = 1
        search = Search(machine, self.check)
        search.pause_at = 2 * self.nodes + FIRST_TURN
        point = next(search.round(1), None)
        if point is not None:
            plan_of(machine, point)
        return refinement((machine,), machine)

    def statistics(self) -> dict[str, Any]:
        """Figures so far."""
        return {
            "nodes": self.nodes,
            "depth": self.deepest,
            "effects": self.effects,
            "states": 1,
            "pruned": {"depth": self.cut_by_depth},
        }


class _Body:
    """A behavior that is being carried out; None is the initial program."""

    __slots__ = ("acts", "arguments", "code", "depth", "held", "nested", "values")

    def __init__(
        self, code: Code | None, arguments: tuple[Value, ...], size: int, depth: int,
        nested: Mapping[str, int],
    ) -> None:  # fmt: skip
        self.code = code
        self.arguments = arguments
        self.values: list[Value] = [*arguments, *(None,) * (size - len(arguments))]
        self.held: list[tuple[Test, tuple[Value, ...]]] = []
        self.depth = depth
        self.nested = nested
        self.acts = False


class _Entry:
    """Instructions of a body, from an index on.

    Those of a whole behavior have the body that it was applied in, and for which achieve, if it was
    for one. Those of a `foreach` have the tuples of objects that are left.
    """

    __slots__ = ("body", "caller", "index", "loop", "op", "ops", "slots")

    def __init__(
        self, ops: Block, body: _Body, caller: _Body | None = None, op: AchieveOp | None = None
    ) -> None:
        self.ops = ops
        self.index = 0
        self.body = body
        self.caller = caller
        self.op = op
        self.slots: tuple[int, ...] = ()
        self.loop: Iterator[tuple[Value, ...]] | None = None


def _goes_on(entry: _Entry) -> bool:
    """Begin the next turn of a `foreach`, if there is one."""
    assert entry.loop is not None
    chosen = next(entry.loop, None)
    if chosen is None:
        return False
    for slot, value in zip(entry.slots, chosen, strict=True):
        entry.body.values[slot] = value
    entry.index = 0
    return True


class _InPlace(Store):
    """A store whose one state changes, so that nothing about its cells can be remembered."""

    cells_of: type[ChainMap[Cell, object]] = ChainMap

    def after(self, before: Snapshot, written: Iterable[tuple[Cell, Value]]) -> Snapshot:
        """The same state, after some cells were written."""
        base, delta, defaults = self.base, before.delta, self.defaults
        for cell, value in written:
            if base.get(cell, defaults[cell[0]]) == value:
                delta.pop(cell, None)
            else:
                delta[cell] = value
        return before
