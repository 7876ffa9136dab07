"""M run forward: a member is completed in the known state, and refined on the way down to it.

A step chooses what completes next: a member none of whose predecessors is left, or one below a
member that is refined for it. The L of a refined member runs in the state in which M started.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from crow.evaluate import EvaluationError
from crow.search.code import AllOf, Atom, CallOp, Code, OneOf, Opaque, Test
from crow.search.frames import Context, Frame, Held, Kind, Members, Open, Refined
from crow.search.members import Focus, Path, Starting, replaced, walk
from crow.search.points import Choice, Point, Step, holds
from crow.search.protect import Protection
from crow.search.states import Snapshot
from crow.values import Value

if TYPE_CHECKING:
    from crow.search.machine import Machine

Applied = tuple[Code, tuple[Value, ...]]


class Forward:
    """Chooses among the members of M in the order in which they complete."""

    def __init__(self, machine: "Machine") -> None:
        self.machine = machine
        self.shared = machine.shared
        self.protection = Protection(machine)

    def middle(self, point: Point, frame: Frame) -> Step:
        """The members that are left, or the end of M."""
        if not frame.second:
            return point.told(("end of M",)).at(frame.next, None)
        if point.constraints is not None:
            self._decide(point, frame)
        return Choice(point, self._options(point, frame))

    def _decide(self, point: Point, frame: Frame) -> None:
        """Raise Undecided for a member that is true or not by values that are not known.

        It is decided before there is a choice, so that the choice can be made again.
        """
        for _, member, is_free in walk(frame.second, frame.third):
            if is_free and isinstance(member, Open) and (test := null_test(member)) is not None:
                holds(test, point.state, member.values)

    def _options(self, point: Point, frame: Frame) -> Iterator[Point]:
        members: Members = frame.second
        focus: Focus | None = frame.third
        if self.machine.protects and self.protection.is_hopeless(point.state, frame, members):
            self.machine.is_hopeless = True
            self.machine.counters.hopeless += 1
            assert self.protection.last is not None
            self.machine.dead.note(point, "nothing left makes it true", *self.protection.last)
            return
        hint, screen = self.machine.hint, self.machine.screen
        hint.is_doubtful = False
        if self.machine.prunes:
            found = next(self._silent(point, members, focus), None)
            if found is not None:
                yield from self._settled(point, frame, found)
                return
        here = _Place(self, point, frame, members)
        for path, member, is_free in walk(members, focus):
            if screen.place is not None and path[0][0] != screen.place:
                screen.has_left_out = True
            elif isinstance(member, Open):
                hint.place = path[0][0]
                yield from here.open(path, member, is_free=is_free)
            elif is_free and not member.children:
                hint.place = path[0][0]
                yield here.completed(path, member)

    def _settled(
        self, point: Point, frame: Frame, found: tuple[Path, Open, Test]
    ) -> Iterator[Point]:
        """What completes without a change of state is completed at once, or has to be refined.

        Completing it later leads to no other plan: nothing that comes in between needs it open.
        """
        path, member, test = found
        members, hint = frame.second, self.machine.hint
        hint.place = path[0][0]
        self.machine.counters.nodes += 1
        left = replaced(self.shared, members, path, None)
        told = point.told(("assert", test, member.values))
        yield told.at(self._frame(frame, left, None), None)
        if self._may_be_refined(member):
            tried = replaced(self.shared, members, path, self.shared.tried(member))
            hint.is_doubtful = True
            yield point.at(self._frame(frame, tried, frame.third), None)

    def settled(self, point: Point, frame: Frame) -> Open | None:
        """The member that is true and is completed at once."""
        found = next(self._silent(point, frame.second, frame.third), None)
        return None if found is None else found[1]

    def _silent(
        self, point: Point, members: Members, focus: Focus | None
    ) -> Iterator[tuple[Path, Open, Test]]:
        for path, member, is_free in walk(members, focus):
            if is_free and isinstance(member, Open) and member.may_be_null:
                test = null_test(member)
                if test is not None and holds(test, point.state, member.values):
                    yield path, member, test

    def _may_be_refined(self, member: Open) -> bool:
        """Whether a condition that is true may also be achieved, which goes one deeper."""
        if isinstance(member.what, Test | Opaque):
            return False
        return self.machine.within(member.depth + self.machine.level)

    def _frame(self, frame: Frame, members: Members, focus: Focus | None) -> Frame:
        return self.shared.frame(Kind.MIDDLE, frame.next, frame.first, members, focus)

    def left_done(self, point: Point, frame: Frame) -> Step:
        """The L of a refined member has run; on in the state that the search had reached."""
        context = point.context
        assert context is not None
        back, middle = frame.first
        path, is_free, after = frame.second
        returned = point._replace(state=back, context=None, frame=middle).told(("end of L",))
        place = _Place(self, returned, middle, middle.second)
        points = list(place.joined(context, path, after, point.state, is_free=is_free))
        return points[0] if len(points) == 1 else Choice(point, iter(points))


def null_test(member: Open) -> Test | None:
    """What has to be true for a member to complete by itself; None for one that cannot."""
    match member.what:
        case Test() as test:
            return test
        case AllOf(test=test) | OneOf(test=test) | Atom(test=test) | Opaque(test=test):
            return test
        case _:
            return None


class _Place:
    """The members that are left at a point, and the ways to choose one of them."""

    def __init__(self, owner: Forward, point: Point, frame: Frame, members: Members) -> None:
        self.machine = owner.machine
        self.shared = owner.shared
        self.point = point
        self.frame = frame
        self.members = members
        self.start: Snapshot = frame.first

    def _at(self, members: Members, focus: Focus | None, point: Point | None = None) -> Point:
        frame = self.shared.frame(Kind.MIDDLE, self.frame.next, self.start, members, focus)
        return (point or self.point).at(frame, None)

    def completed(self, path: Path, member: Refined) -> Point:
        """A refined member whose children are done: its R runs here."""
        self.machine.counters.nodes += 1
        return self._finishing(path, member.context, member.after)

    def _finishing(self, path: Path, context: Context | None, after: Held) -> Point:
        left = replaced(self.shared, self.members, path, None)
        rest = self._at(left, None).frame
        for test, values in reversed(after):
            rest = self.shared.frame(Kind.CHECK, rest, test, values)
        if context is None:
            return self.point.at(rest, None)
        code = context.application.code
        assert code is not None
        return self.point.at(self.machine.right(code, rest), context)

    def open(self, path: Path, member: Open, *, is_free: bool) -> Iterator[Point]:
        """The ways to complete or to refine a member."""
        test = null_test(member)
        if test is not None and is_free and not self.machine.prunes:
            self.machine.counters.nodes += 1
            if holds(test, self.point.state, member.values):
                told = self.point.told(("assert", test, member.values))
                left = replaced(self.shared, self.members, path, None)
                yield self._at(left, None, told)
        match member.what:
            case Test() as failing:
                if is_free:
                    note = self.machine.dead.note
                    note(self.point, "it is false here", failing, member.values)
            case CallOp(behavior=name, arguments=parts):
                try:
                    arguments = tuple(part(self.start, member.values) for part in parts)
                except EvaluationError:
                    return
                code = self.machine.programs.code(self.machine.problem.world.behaviors[name])
                yield from self._refined(path, member, (code, arguments), is_free=is_free)
            case (code, arguments):
                yield from self._refined(path, member, (code, arguments), is_free=is_free)
            case _:
                yield from self._wanting(path, member, is_free=is_free)

    def _wanting(self, path: Path, member: Open, *, is_free: bool) -> Iterator[Point]:
        from crow.search.machine import choices

        what, values = member.what, member.values
        match what:
            case AllOf(test=test):
                parts = self.machine.parts(what, values, member.application, member.depth)
                checks = ((test, values), *_after(member))
                if parts:
                    yield self._opened(path, parts, checks, is_free=is_free)
            case OneOf():
                for part, own in choices(what, values):
                    above, depth = member.application, member.depth
                    chosen = self.shared.open(part, own, above, depth, member.after)
                    self.machine.counters.nodes += 1
                    members = replaced(self.shared, self.members, path, chosen)
                    yield self._at(members, (path, is_free))
            case Atom():
                yield from self._atom(path, member, what, is_free=is_free)
            case Opaque(test=test):
                note = self.machine.dead.note
                note(self.point, "nothing can make it true", test, values)
            case _:
                raise AssertionError(what)

    def _opened(self, path: Path, children: Members, after: Held, *, is_free: bool) -> Point:
        """A member refined to other members, with assertions behind them."""
        self.machine.counters.nodes += 1
        refined = self.shared.refined(None, children, after)
        return self._at(replaced(self.shared, self.members, path, refined), (path, is_free))

    def _atom(self, path: Path, member: Open, atom: Atom, *, is_free: bool) -> Iterator[Point]:
        found, is_step = self.machine.alternatives(self.point, atom, self.start, member.values)
        for applied in found:
            if not is_step:
                yield from self._refined(path, member, applied, is_free=is_free)
            elif self.machine.within(member.depth + self.machine.level):
                steps = self._step(member, applied)
                yield self._opened(path, steps, _after(member), is_free=is_free)

    def _step(self, member: Open, applied: Applied) -> Members:
        """A behavior on the way to a comparison, and the comparison again."""
        values, above, depth = member.values, member.application, member.depth
        first = self.shared.open(applied, values, above, depth)
        again = self.shared.open(member.what, values, above, depth + self.machine.level)
        return ((first, again),)

    def _refined(
        self, path: Path, member: Open, applied: Applied, *, is_free: bool
    ) -> Iterator[Point]:
        """A member refined by a behavior; one that cannot complete now needs children."""
        code, arguments = applied
        if not is_free and code.middle is None:
            return
        application = self.machine.application(code, arguments, member.application, member.depth)
        if application is None:
            return
        context, after = self.machine.context(application), _after(member)
        event = ("for", application, member.application, member.what, member.values)
        if not code.left:
            for begun in self.joined(context, path, after, self.start, is_free=is_free):
                yield begun.noted(event)
            return
        middle = self._at(self.members, None).frame
        done = self.shared.frame(
            Kind.LEFT_DONE, None, (self.point.state, middle), (path, is_free, after)
        )
        left = self.machine.section(code.left, done, commits=code.commits[0])
        told = self.point.noted(event).told(("L",))
        yield told._replace(state=self.start, context=context, frame=left)

    def joined(
        self, context: Context, path: Path, after: Held, start: Snapshot, *, is_free: bool
    ) -> Iterator[Point]:
        """A behavior whose L is done: its M joins the members, or its R runs at once."""
        code = context.application.code
        assert code is not None
        starting = Starting(self.shared, context.application, context.values, start)
        try:
            started = [((), ())] if code.middle is None else starting.members(code.middle)
        except EvaluationError:
            return
        for children, held in started:
            own = self.shared.context(context.application, context.values, context.held + held)
            if children:
                refined = self.shared.refined(own, children, after)
                members = replaced(self.shared, self.members, path, refined)
                yield self._at(members, (path, is_free))
            elif is_free:
                yield self._finishing(path, own, after)


def _after(member: Open) -> Held:
    return () if member.after is None else ((member.after, member.values),)
