"""The CROW engine: programs run forward from a known state, one choice after another.

It makes the same traces as REFINE (semantics.md §3, "Run forward instead"), and keeps what is left
to do as data, so that no depth of a program meets a limit of Python's stack.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from crow.evaluate import EvaluationError
from crow.problem import Problem
from crow.search.code import (
    AchieveOp,
    AllOf,
    Alternatives,
    Atom,
    Block,
    Code,
    OneOf,
    Opaque,
    Test,
    Wanted,
)
from crow.search.compile import Programs
from crow.search.expressions import Environment, names_of
from crow.search.forward import Forward
from crow.search.frames import Application, Context, Frame, Kind, Members, Shared
from crow.search.instructions import Instructions
from crow.search.members import Starting, with_slots
from crow.search.points import (
    SOLVER,
    Cause,
    Choice,
    Dead,
    Known,
    Point,
    Step,
    Undecided,
    extended,
    holds,
)
from crow.search.states import Snapshot, Store
from crow.search.tailward import Tailward
from crow.search.unordered import Unordered
from crow.unknowns import Touched
from crow.values import Value

if TYPE_CHECKING:
    from crow.program import Location
    from crow.search.solving import Solving


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

    def __init__(
        self, problem: Problem, *, prunes: bool = True, counts_depth: bool = True, seed: int = 0
    ) -> None:
        self.seed = seed
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
        self.cut_of_values = 0
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
        self._ops = Instructions(self).steps()

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
            if point.constraints is not None:
                self.store.decided = point.constraints.decided
            try:
                step = self._frames[point.frame.kind](point, point.frame)
            except Undecided as undecided:
                return self.solving.decide(point, undecided)
            except Touched:
                step = self._computed(point)
            if not isinstance(step, Point):
                return step
            point = step
        if point.constraints is not None and point.constraints.open:
            return self.solving.solve(point)
        return point

    def _computed(self, point: Point) -> Step:
        try:
            return self.solving.compute(point)
        except EvaluationError as error:
            return self._without_value(point, error)

    @property
    def draws_values(self) -> bool:
        """Whether the program binds values."""
        return self.problem.world.chosen_value is not None

    @cached_property
    def solving(self) -> "Solving":
        """Where values are drawn; of programs that bind none it is not needed."""
        from crow.search.solving import Solving

        return Solving(self, self.seed)

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
            Kind.SETTLE: lambda point, _: self.solving.settle(point),
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
            state, known = self._after(checked, code, context)
        except EvaluationError as error:
            return self._without_value(point, error)
        self.counters.effects += 1
        trail = extended(extended(checked.trail, ("eff", context)), ("end", context))
        return Point(state, None, self.settled(frame.next, point, known), trail, point.cuts, known)

    def settled(self, frame: Frame | None, point: Point, known: Known | None) -> Frame | None:
        """What follows where more may be known of values than at a point: it is put in first."""
        if known is point.constraints:
            return frame
        return self.shared.frame(Kind.SETTLE, frame)

    def _after(self, point: Point, code: Code, context: Context) -> tuple[Snapshot, Known | None]:
        """The state after the effect of a behavior, and what is then known of values."""
        assert code.effect is not None
        try:
            return code.effect(point.state, context.values), point.constraints
        except Touched:
            names = names_of(code.effect_slots, context.values)
            return self.solving.effect(point, code.behavior.effect or (), names)

    def rechecked(self, point: Point, context: Context) -> Point | None:
        """The point after what is held was asserted again."""
        for test, values in context.held:
            checked = self._required(point, test, values, "it no longer holds here")
            if checked is None:
                return None
            point = checked.told(("assert", test, values))
        return point

    def _required(self, point: Point, test: Test, values: Environment, reason: str) -> Point | None:
        """The point where a condition holds; of what is not known it becomes a constraint."""
        try:
            if holds(test, point.state, values):
                return point
        except Undecided:
            return self.solving.having(point, test, values)
        self.dead.note(point, reason, test, values)
        return None

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
        checked = self._required(point, test, values, "it is false here")
        if checked is None:
            return None
        following = self.settled(following, point, checked.constraints)
        return checked.told(("assert", test, values)).at(following, context)

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
        found, is_step = self.alternatives(point, atom, point.state, values)
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

    def alternatives(
        self, point: Point, atom: Atom, state: Snapshot, values: Environment
    ) -> Alternatives:
        """The behaviors that achieve a condition, matched in a state; a dead end without any."""
        try:
            found = atom.alternatives(state, values)
        except EvaluationError:
            return (), False
        except Touched:  # a goal with a constant, or the same value twice, and a value not known
            self.cut_of_values |= SOLVER
            return (), False
        if not found[0]:
            self.dead.note(point, "no behavior achieves it", atom.test, values)
        return found

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

    # ------------------------------------------------------------------------------------- commit

    def _section(self, point: Point, frame: Frame) -> Step:
        cuts = (self.height(), (), point.cuts)
        return point._replace(frame=frame.next, cuts=cuts)

    def _section_end(self, point: Point, frame: Frame) -> Step:
        assert point.cuts is not None
        return point._replace(frame=frame.next, cuts=point.cuts[2])


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
