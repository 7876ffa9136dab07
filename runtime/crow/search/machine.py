"""The CROW engine: programs run forward from a known state, one choice after another.

It makes the same traces as REFINE (semantics.md §3, "Run forward instead"), and keeps what is left
to do as data, so that no depth of a program meets a limit of Python's stack.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from crow.evaluate import EvaluationError
from crow.problem import Problem
from crow.search.code import (
    AchieveOp,
    AllOf,
    AlternativeOp,
    AssertOp,
    Atom,
    BindOp,
    Block,
    CallOp,
    Code,
    CommitOp,
    DoOp,
    FixOp,
    IfOp,
    LetOp,
    OneOf,
    Op,
    Opaque,
    SequenceOp,
    Test,
    UnorderedOp,
    Wanted,
)
from crow.search.compile import Programs
from crow.search.expressions import Environment
from crow.search.forward import Forward
from crow.search.frames import Application, Context, Frame, Kind, Members, Shared
from crow.search.members import Starting, with_slots
from crow.search.points import Cause, Choice, Dead, Point, Step, extended, holds
from crow.search.states import Store
from crow.search.tailward import Tailward
from crow.search.unordered import Unordered
from crow.values import Value

if TYPE_CHECKING:
    from crow.program import Location


@dataclass(slots=True)
class Counters:
    """What a search did: nodes, and what it left out."""

    nodes: int = 0
    cut_by_depth: int = 0
    cut_by_width: int = 0
    hopeless: int = 0
    effects: int = 0


@dataclass(slots=True)
class Hint:
    """About the option of a choice in M that came last.

    `place` is the chain of M it is in; `is_doubtful` says that an option before it completes a
    member that is true, which this one leaves open.
    """

    place: int = -1
    is_doubtful: bool = False


Prefers = Callable[[Code, tuple[Value, ...], Application], bool]


@dataclass(slots=True)
class Screen:
    """Which options are wanted now: in one chain of M, behaviors that are preferred."""

    place: int | None = None
    prefers: Prefers | None = None
    has_left_out: bool = False

    def begin(self, place: int | None, prefers: Prefers) -> None:
        """Leave out options from now on."""
        self.place, self.prefers, self.has_left_out = place, prefers, False

    def end(self) -> bool:
        """Leave out nothing any more; whether anything was."""
        self.place = self.prefers = None
        return self.has_left_out


class Machine:
    """Runs points of one problem up to a depth limit.

    `prunes` leaves out choices that add no plan to those that others lead to. Where it does not
    count depth, everything is at depth 0, and what differs only in depth is the same.
    """

    def __init__(self, problem: Problem, *, prunes: bool = True, counts_depth: bool = True) -> None:
        self.level = int(counts_depth)
        self.problem = problem
        self.store = self.make_store()
        self.programs = Programs.of(problem.world)
        self.shared = Shared()
        self.prunes = prunes
        self.protects = prunes
        self.depth_limit = 0
        self.is_cut = False
        self.is_hopeless = False
        self.is_too_wide = False
        self.hint = Hint()
        self.screen = Screen()
        self.counters = Counters()
        self.dead = Dead()
        self._valueless: dict[tuple[Code, Location | None], Test] = {}
        self.finished: Point | None = None
        self.goals: list[AchieveOp] = []
        self.height: Callable[[], int] = lambda: 0
        self.commit: Callable[[Point], None] = lambda _: None
        self.forward = Forward(self)
        self.tailward = Tailward(self)
        self.unordered = Unordered(self)
        self._frames: dict[Kind, Callable[[Point, Frame], Step]] = self._frame_steps()
        self._ops: dict[type, Callable[[Point, Op, Frame | None], Step]] = self._op_steps()

    def make_store(self) -> Store:
        """The states of the search."""
        return Store(self.problem.world, self.problem.initial)

    def start(self) -> Point:
        """The initial program: `achieve g; assert g` (§2.2)."""
        wanted, test, size = self.programs.goal(self.problem.goal)
        self.goals.append(AchieveOp(wanted, test, is_held=False))
        root = self.shared.application(None, (), 0, ())
        context = self.shared.context(root, (None,) * size, ())
        check = self.shared.frame(Kind.CHECK, None, test, context.values)
        frame = self.shared.frame(Kind.ACHIEVE, check, wanted, context.values, (root, 0))
        return Point(self.store.initial, None, frame, None, None)

    def run(self, point: Point) -> Step:
        """Go on until there is a choice, a dead end, or nothing left to do."""
        while point.frame is not None:
            step = self._frames[point.frame.kind](point, point.frame)
            if not isinstance(step, Point):
                return step
            point = step
        return point

    # ------------------------------------------------------------------------------------ frames

    def _frame_steps(self) -> dict[Kind, Callable[[Point, Frame], Step]]:
        return {
            Kind.BLOCK: self._block,
            Kind.RESTORE: lambda point, frame: point.at(frame.next, frame.first),
            Kind.START: self._start,
            Kind.MIDDLE: self.forward.middle,
            Kind.LEFT_DONE: self.forward.left_done,
            Kind.TAIL: self.tailward.tail,
            Kind.TAIL_LEFT_DONE: self.tailward.left_done,
            Kind.PENDING: self.tailward.pending,
            Kind.BEGIN: self._begin,
            Kind.END: self._end,
            Kind.CHECK: self._check,
            Kind.ACHIEVE: self._achieve_again,
            Kind.APPLY: self._apply_frame,
            Kind.UNORDERED: self.unordered.group,
            Kind.PART_DONE: self.unordered.part_done,
            Kind.SECTION: self._section,
            Kind.SECTION_END: self._section_end,
        }

    def block(self, ops: Block, following: Frame | None) -> Frame | None:
        """A frame for instructions, if there are any."""
        return self.shared.frame(Kind.BLOCK, following, ops, 0) if ops else following

    def _block(self, point: Point, frame: Frame) -> Step:
        ops, index = frame.first, frame.second
        rest = frame.next
        if index + 1 < len(ops):
            rest = self.shared.frame(Kind.BLOCK, rest, ops, index + 1)
        op = ops[index]
        try:
            return self._ops[type(op)](point, op, rest)
        except EvaluationError as error:
            return self._without_value(point, error)

    def _without_value(self, point: Point, error: EvaluationError) -> Step:
        """A dead end: what a body computes has no value, so it fails at what it is for."""
        context = point.context
        code = None if context is None else context.application.code
        if context is None or code is None:
            return None
        test = self._valueless.get((code, error.location))
        if test is None:
            behavior = code.behavior
            slots = {parameter.name: slot for slot, parameter in enumerate(behavior.parameters)}
            condition = behavior.goal or self.problem.goal
            test = Test(lambda *_: False, condition, slots, error.location or behavior.location)
            self._valueless[code, error.location] = test
        self.dead.note(point, str(error), test, context.values, "without a value")
        return None

    @property
    def valueless(self) -> Iterator[tuple[Code, Test]]:
        """The behaviors that computed what has no value, with what stands for that."""
        return ((code, test) for (code, _), test in self._valueless.items())

    def _start(self, point: Point, frame: Frame) -> Step:
        """M starts: its `if`s are decided, and what it wants is held for R."""
        context = point.context
        assert context is not None
        code = context.application.code
        assert code is not None
        assert code.middle is not None
        starting = Starting(self.shared, context.application, context.values, point.state)
        try:
            started = starting.members(code.middle)
        except EvaluationError as error:
            return self._without_value(point, error)
        points = [
            self.enter(
                point,
                members,
                self.shared.frame(
                    Kind.RESTORE,
                    frame.next,
                    self.shared.context(context.application, context.values, context.held + held),
                ),
                acts=code.middle_acts,
            )
            for members, held in started
        ]
        return points[0] if len(points) == 1 else Choice(point, iter(points))

    def enter(
        self, point: Point, members: Members, following: Frame | None, *, acts: bool
    ) -> Point:
        """The point at which members of M are to be chosen."""
        if not members:
            return point.at(following, None)
        if acts:
            return point.at(self.shared.frame(Kind.TAIL, following, members), None)
        frame = self.shared.frame(Kind.MIDDLE, following, point.state, members)
        return point.at(frame, None).told(("M",))

    def _begin(self, point: Point, frame: Frame) -> Step:
        assert point.context is not None
        begin = ("begin", point.context.application)
        return point.at(frame.next, point.context).told(begin)

    def _end(self, point: Point, frame: Frame) -> Step:
        """R ends: what is held is asserted again, and the effect changes the state."""
        context = point.context
        assert context is not None
        code = context.application.code
        assert code is not None
        if code.effect is None:
            return point.told(("end", context)).at(frame.next, None)
        checked = self.rechecked(point, context)
        if checked is None:
            return None
        try:
            state = code.effect(point.state, context.values)
        except EvaluationError as error:
            return self._without_value(point, error)
        self.counters.effects += 1
        trail = extended(extended(checked.trail, ("eff", context)), ("end", context))
        return Point(state, None, frame.next, trail, point.cuts)

    def rechecked(self, point: Point, context: Context) -> Point | None:
        """The point after what is held was asserted again."""
        for test, values in context.held:
            if not holds(test, point.state, values):
                self.dead.note(point, "it no longer holds here", test, values)
                return None
            point = point.told(("assert", test, values))
        return point

    def _check(self, point: Point, frame: Frame) -> Step:
        return self.asserted(point, frame.first, frame.second, frame.next, point.context)

    def asserted(
        self,
        point: Point,
        test: Test,
        values: Environment,
        following: Frame | None,
        context: Context | None,
    ) -> Point | None:
        """The point after an assertion, if it holds."""
        if not holds(test, point.state, values):
            self.dead.note(point, "it is false here", test, values)
            return None
        return point.told(("assert", test, values)).at(following, context)

    # --------------------------------------------------------------------------- applying behaviors

    def application(
        self, code: Code, arguments: tuple[Value, ...], above: Application, depth: int
    ) -> Application | None:
        """A behavior applied in a program of some depth, unless too deep or nested too often."""
        screen = self.screen
        if screen.prefers is not None and not screen.prefers(code, arguments, above):
            screen.has_left_out = True
            return None
        nested = above.nested
        if code.max_nested is not None:
            name = code.behavior.name
            counts = dict(nested)
            if counts.get(name, 0) >= code.max_nested:
                return None
            counts[name] = counts.get(name, 0) + 1
            nested = tuple(sorted(counts.items()))
        if depth >= self.depth_limit:
            self.is_cut = True
            self.counters.cut_by_depth += 1
            return None
        self.counters.nodes += 1
        return self.shared.application(code, arguments, depth + self.level, nested)

    def context(self, application: Application) -> Context:
        """Where the body of an application begins."""
        code = application.code
        assert code is not None
        missing = code.size - len(application.arguments)
        return self.shared.context(application, application.arguments + (None,) * missing, ())

    def right(self, code: Code, following: Frame | None) -> Frame:
        """The frames of R and its effect."""
        frame: Frame | None = self.shared.frame(Kind.END, following)
        frame = self.section(code.right, frame, commits=code.commits[1])
        return self.shared.frame(Kind.BEGIN, frame)

    def section(self, block: Block, following: Frame | None, *, commits: bool) -> Frame | None:
        """The frames of an L or R."""
        if not commits:
            return self.block(block, following)
        end = self.shared.frame(Kind.SECTION_END, following)
        return self.shared.frame(Kind.SECTION, self.block(block, end))

    def applied(
        self,
        point: Point,
        code: Code,
        arguments: tuple[Value, ...],
        above: Application,
        depth: int,
        following: Frame | None,
        cause: Cause,
    ) -> Point | None:
        """The point at which a behavior begins that stands in L or R."""
        application = self.application(code, arguments, above, depth)
        if application is None:
            return None
        point = point.noted(("for", application, above, *cause))
        frame: Frame | None = self.right(code, following)
        if code.middle is not None:
            frame = self.shared.frame(Kind.START, frame)
        if code.left:
            point = point.told(("left", application))
            frame = self.section(code.left, frame, commits=code.commits[0])
        return point.at(frame, self.context(application))

    def _apply_frame(self, point: Point, frame: Frame) -> Step:
        code, arguments = frame.first
        above, depth = frame.second
        return self.applied(point, code, arguments, above, depth, frame.next, (frame.first, ()))

    def _achieve_again(self, point: Point, frame: Frame) -> Step:
        wanted, values = frame.first, frame.second
        if holds(wanted.test, point.state, values):
            return self.asserted(point, wanted.test, values, frame.next, point.context)
        above, depth = frame.third
        return Choice(point, self.achieving(point, wanted, values, above, depth, frame.next))

    def achieving(
        self,
        point: Point,
        wanted: Wanted,
        values: Environment,
        above: Application,
        depth: int,
        following: Frame | None,
    ) -> Iterator[Point]:
        """The ways to make a condition true in L or R."""
        match wanted:
            case AllOf(test=test, acts=acts):
                members = self.parts(wanted, values, above, depth)
                check = self.shared.frame(Kind.CHECK, following, test, values)
                self.counters.nodes += 1
                yield self.enter(point, members, check, acts=acts)
            case OneOf():
                for part, own in choices(wanted, values):
                    yield from self.achieving(point, part, own, above, depth, following)
            case Atom(test=test):
                yield from self._alternatives(point, wanted, values, above, depth, following)
            case Opaque(test=test):
                self.dead.note(point, "nothing can make it true", test, values)

    def _alternatives(
        self,
        point: Point,
        atom: Atom,
        values: Environment,
        above: Application,
        depth: int,
        following: Frame | None,
    ) -> Iterator[Point]:
        try:
            found, is_step = atom.alternatives(point.state, values)
        except EvaluationError:
            return
        if not found:
            self.dead.note(point, "no behavior achieves it", atom.test, values)
        after = following
        if is_step:
            below = depth + self.level
            if not self.within(below):
                return
            after = self.shared.frame(Kind.ACHIEVE, following, atom, values, (above, below))
        for applied in found:
            cause = (applied if is_step else atom, values)
            begun = self.applied(point, *applied, above, depth, after, cause)
            if begun is not None:
                yield begun

    def within(self, depth: int) -> bool:
        """Whether a depth is within the limit; if not, something is left out."""
        if depth > self.depth_limit:
            self.is_cut = True
            self.counters.cut_by_depth += 1
        return depth <= self.depth_limit

    def parts(self, wanted: AllOf, values: Environment, above: Application, depth: int) -> Members:
        """The conjuncts of a condition as members of M."""
        return tuple(
            (self.shared.open(part, own, above, depth),) for part, own in choices(wanted, values)
        )

    # ------------------------------------------------------------------------------- instructions

    def _op_steps(self) -> dict[type, Callable[[Point, Op, Frame | None], Step]]:
        steps: dict[type, Callable[..., Step]] = {
            AssertOp: self._assert,
            AchieveOp: self._achieve,
            CallOp: self._call,
            DoOp: self._do,
            BindOp: self._bind,
            LetOp: self._let,
            FixOp: self._fix,
            IfOp: self._if,
            SequenceOp: lambda p, op, rest: p.at(self.block(op.body, rest), p.context),
            AlternativeOp: self._alternative,
            UnorderedOp: self.unordered.begin,
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
        self.counters.nodes += 1
        after = self._held(context, op.test, is_held=op.is_held)
        return self.asserted(point, op.test, context.values, rest, after)

    def _achieve(self, point: Point, op: AchieveOp, rest: Frame | None) -> Step:
        context = point.context
        assert context is not None
        values = context.values
        after = self._held(context, op.test, is_held=op.is_held)
        if op.test.holds(point.state, values):
            self.counters.nodes += 1
            return self.asserted(point, op.test, values, rest, after)
        following = self.shared.frame(Kind.RESTORE, rest, after)
        if op.is_held:
            following = self.shared.frame(Kind.CHECK, following, op.test, values)
        above = context.application
        options = self.achieving(point, op.wanted, values, above, above.depth, following)
        return Choice(point, options)

    def _call(self, point: Point, op: CallOp, rest: Frame | None) -> Step:
        context = point.context
        assert context is not None
        arguments = tuple(a(point.state, context.values) for a in op.arguments)
        code = self.programs.code(self.problem.world.behaviors[op.behavior])
        following = self.shared.frame(Kind.RESTORE, rest, context)
        above = context.application
        cause = (op, context.values)
        return self.applied(point, code, arguments, above, above.depth, following, cause)

    def _do(self, point: Point, op: DoOp, rest: Frame | None) -> Step:
        context = point.context
        assert context is not None
        self.counters.nodes += 1
        arguments = tuple(a(point.state, context.values) for a in op.arguments)
        checked = self.rechecked(point, context)
        if checked is None:
            return None
        trail = extended(checked.trail, ("do", op, arguments, context))
        state = point.state
        if op.effect is not None:
            state = op.effect(state, arguments)
            self.counters.effects += 1
        after = self.shared.context(context.application, context.values, ())
        return Point(state, after, rest, trail, point.cuts)

    def _bind(self, point: Point, op: BindOp, rest: Frame | None) -> Step:
        context = point.context
        assert context is not None
        found = op.choices(point.state, context.values)
        if not found and op.test is not None:
            self.dead.note(point, "no object is like this", op.test, context.values)
        if len(found) == 1:
            return self._bound(point, op, rest, found[0])
        return Choice(point, (self._bound(point, op, rest, chosen) for chosen in found))

    def _bound(
        self, point: Point, op: BindOp, rest: Frame | None, chosen: tuple[Value, ...]
    ) -> Point:
        context = point.context
        assert context is not None
        self.counters.nodes += 1
        values = with_slots(context.values, op.slots, chosen)
        after = self.shared.context(context.application, values, context.held)
        if op.test is None:
            return point.at(rest, after)
        after = self._held(after, op.test, is_held=op.is_held)
        return point.told(("assert", op.test, values)).at(rest, after)

    def _let(self, point: Point, op: LetOp, rest: Frame | None) -> Step:
        context = point.context
        assert context is not None
        self.counters.nodes += 1
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
        self.counters.nodes += 1
        is_true = op.test.holds(point.state, context.values)
        return point.at(self.block(op.then if is_true else op.otherwise, rest), context)

    def _alternative(self, point: Point, op: AlternativeOp, rest: Frame | None) -> Step:
        options = (point.at(self.block((part,), rest), point.context) for part in op.body)
        return Choice(point, options)

    # ------------------------------------------------------------------------------------- commit

    def _section(self, point: Point, frame: Frame) -> Step:
        cuts = (self.height(), (), point.cuts)
        return Point(point.state, point.context, frame.next, point.trail, cuts)

    def _section_end(self, point: Point, frame: Frame) -> Step:
        assert point.cuts is not None
        return Point(point.state, point.context, frame.next, point.trail, point.cuts[2])

    def _commit(self, point: Point, _op: CommitOp, rest: Frame | None) -> Step:
        self.counters.nodes += 1
        self.commit(point)
        return point.at(rest, point.context)


def choices(wanted: AllOf | OneOf, values: Environment) -> Iterator[tuple[Wanted, Environment]]:
    """The parts of a condition, one for each tuple of objects where it is quantified."""
    if wanted.variables is None:
        for part in wanted.parts:
            yield part, values
        return
    slots, tuples = wanted.variables
    (part,) = wanted.parts
    for chosen in tuples:
        yield part, with_slots(values, slots, chosen)
