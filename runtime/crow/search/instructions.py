"""What each instruction of L and R does at a point."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from crow.search.code import (
    AchieveOp,
    AlternativeOp,
    AssertOp,
    BindOp,
    CallOp,
    CommitOp,
    DoOp,
    DrawOp,
    FixOp,
    IfOp,
    LetOp,
    Op,
    SequenceOp,
    Test,
    UnorderedOp,
)
from crow.search.frames import Context, Frame, Kind
from crow.search.members import with_slots
from crow.search.points import Choice, Point, Step, extended, is_true
from crow.unknowns import Touched
from crow.values import Value

if TYPE_CHECKING:
    from crow.search.machine import Machine

Instruction = Callable[[Point, Op, Frame | None], Step]
"""Carries an instruction out at a point; what follows it is the frame."""


class Instructions:
    """The instructions of one machine."""

    def __init__(self, machine: "Machine") -> None:
        self.machine = machine
        self.shared = machine.shared

    def steps(self) -> dict[type, Instruction]:
        """What each kind of instruction does."""
        steps: dict[type, Callable[..., Step]] = {
            AssertOp: self._assert,
            AchieveOp: self._achieve,
            CallOp: self._call,
            DoOp: self._do,
            BindOp: self._bind,
            DrawOp: lambda point, op, rest: self.machine.solving.draw(point, op, rest),
            LetOp: self._let,
            FixOp: self._fix,
            IfOp: self._if,
            SequenceOp: lambda p, op, rest: p.at(self.machine.block(op.body, rest), p.context),
            AlternativeOp: self._alternative,
            UnorderedOp: self.machine.unordered.begin,
            CommitOp: self._commit,
        }
        return steps

    def _held(self, context: Context, test: Test, *, is_held: bool) -> Context:
        if not is_held:
            return context
        held = (*context.held, (test, context.values))
        return self.shared.context(context.application, context.values, held)

    def _assert(self, point: Point, op: AssertOp, rest: Frame | None) -> Step:
        context = point.context
        assert context is not None
        self.machine.counters.nodes += 1
        after = self._held(context, op.test, is_held=op.is_held)
        return self.machine.asserted(point, op.test, context.values, rest, after)

    def _achieve(self, point: Point, op: AchieveOp, rest: Frame | None) -> Step:
        context = point.context
        assert context is not None
        values = context.values
        after = self._held(context, op.test, is_held=op.is_held)
        if is_true(op.test, point.state, values):
            self.machine.counters.nodes += 1
            return self.machine.asserted(point, op.test, values, rest, after)
        following = self.shared.frame(Kind.RESTORE, rest, after)
        if op.is_held:
            following = self.shared.frame(Kind.CHECK, following, op.test, values)
        above = context.application
        options = self.machine.achieving(point, op.wanted, values, above, above.depth, following)
        return Choice(point, options)

    def _call(self, point: Point, op: CallOp, rest: Frame | None) -> Step:
        context = point.context
        assert context is not None
        arguments = tuple(a(point.state, context.values) for a in op.arguments)
        code = self.machine.programs.code(self.machine.problem.world.behaviors[op.behavior])
        following = self.shared.frame(Kind.RESTORE, rest, context)
        above = context.application
        cause = (op, context.values)
        return self.machine.applied(point, code, arguments, above, above.depth, following, cause)

    def _do(self, point: Point, op: DoOp, rest: Frame | None) -> Step:
        context = point.context
        assert context is not None
        self.machine.counters.nodes += 1
        arguments = tuple(a(point.state, context.values) for a in op.arguments)
        checked = self.machine.rechecked(point, context)
        if checked is None:
            return None
        trail = extended(checked.trail, ("do", op, arguments, context))
        state, known = checked.state, checked.constraints
        if op.effect is not None:
            self.machine.counters.effects += 1
            try:
                state = op.effect(state, arguments)
            except Touched:
                controller = self.machine.problem.world.controllers[op.controller]
                names = {p.name: v for p, v in zip(controller.parameters, arguments, strict=True)}
                state, known = self.machine.solving.effect(checked, controller.effect or (), names)
        after = self.shared.context(context.application, context.values, ())
        return Point(
            state, after, self.machine.settled(rest, point, known), trail, point.cuts, known
        )

    def _bind(self, point: Point, op: BindOp, rest: Frame | None) -> Step:
        context = point.context
        assert context is not None
        found = op.choices(point.state, context.values)
        if not found and op.test is not None:
            self.machine.dead.note(point, "no object is like this", op.test, context.values)
        if len(found) == 1:
            return self._bound(point, op, rest, found[0])
        return Choice(point, (self._bound(point, op, rest, chosen) for chosen in found))

    def _bound(
        self, point: Point, op: BindOp, rest: Frame | None, chosen: tuple[Value, ...]
    ) -> Point:
        context = point.context
        assert context is not None
        self.machine.counters.nodes += 1
        values = with_slots(context.values, op.slots, chosen)
        after = self.shared.context(context.application, values, context.held)
        if op.test is None:
            return point.at(rest, after)
        after = self._held(after, op.test, is_held=op.is_held)
        return point.told(("assert", op.test, values)).at(rest, after)

    def _let(self, point: Point, op: LetOp, rest: Frame | None) -> Step:
        context = point.context
        assert context is not None
        self.machine.counters.nodes += 1
        value = op.value(point.state, context.values)
        return self._set(point, op.slot, value, rest)

    def _fix(self, point: Point, op: FixOp, rest: Frame | None) -> Step:
        return self._set(point, op.slot, op.value, rest)

    def _set(self, point: Point, slot: int, value: Value, rest: Frame | None) -> Point:
        context = point.context
        assert context is not None
        values = with_slots(context.values, (slot,), (value,))
        after = self.shared.context(context.application, values, context.held)
        return point.at(rest, after)

    def _if(self, point: Point, op: IfOp, rest: Frame | None) -> Step:
        context = point.context
        assert context is not None
        self.machine.counters.nodes += 1
        chosen = op.then if is_true(op.test, point.state, context.values) else op.otherwise
        return point.at(self.machine.block(chosen, rest), context)

    def _alternative(self, point: Point, op: AlternativeOp, rest: Frame | None) -> Step:
        options = (point.at(self.machine.block((part,), rest), point.context) for part in op.body)
        return Choice(point, options)

    def _commit(self, point: Point, _op: CommitOp, rest: Frame | None) -> Step:
        if point.constraints is not None and point.constraints.open:
            return self.machine.solving.solve(point)
        self.machine.counters.nodes += 1
        self.machine.commit(point)
        return point.at(rest, point.context)
