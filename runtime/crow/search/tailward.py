"""M chosen from the end, as REFINE does: for programs where the L of a member may act.

Such an L changes the state in which M starts, so it has to run before any member completes; a
parent's runs before its children's, among the rest that of the member that completes later.
"""

from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING

from crow.evaluate import EvaluationError
from crow.search.code import AllOf, Atom, CallOp, Code, OneOf, Opaque, Test
from crow.search.expressions import Environment
from crow.search.frames import Context, Frame, Kind, Members, Nested, Open
from crow.search.members import Path, Starting, replaced
from crow.search.points import Choice, Point, Step
from crow.values import Value

if TYPE_CHECKING:
    from crow.search.machine import Machine


class Tailward:
    """Chooses among the members of M that may be the last one."""

    def __init__(self, machine: "Machine") -> None:
        self.machine = machine
        self.shared = machine.shared

    def tail(self, point: Point, frame: Frame) -> Step:
        """The members that are left; what follows them is in `second`, the next one first."""
        if not frame.first:
            rest = self.shared.frame(Kind.PENDING, frame.next, frame.second)
            return point.at(rest, None)
        return Choice(point, self._options(point, frame))

    def pending(self, point: Point, frame: Frame) -> Step:
        """Run what follows: a check, or the R of a behavior."""
        blocks = frame.first
        if blocks is None:
            return point.at(frame.next, None)
        block, others = blocks
        rest = self.shared.frame(Kind.PENDING, frame.next, others)
        match block:
            case Context(application=application):
                assert application.code is not None
                return point.at(self.machine.right(application.code, rest), block)
            case (test, values):
                return self.machine.asserted(point, test, values, rest, None)
            case _:
                raise AssertionError(block)

    def _options(self, point: Point, frame: Frame) -> Iterator[Point]:
        for path, member in _last(frame.first, merges=self.machine.prunes):
            yield from _Last(self, point, frame, path).chosen(member.what, member)

    def left_done(self, point: Point, frame: Frame) -> Step:
        """The L of a member has run; its M joins the others."""
        context = point.context
        assert context is not None
        left, blocks = frame.first, frame.second
        points = list(self.joined(point, context, left, blocks, frame.next))
        return points[0] if len(points) == 1 else Choice(point, iter(points))

    def joined(
        self,
        point: Point,
        context: Context,
        left: Members,
        blocks: object,
        following: Frame | None,
    ) -> Iterator[Point]:
        """The members with those of a behavior whose L is done."""
        code = context.application.code
        assert code is not None
        starting = Starting(self.shared, context.application, context.values, point.state)
        try:
            started = [((), ())] if code.middle is None else starting.members(code.middle)
        except EvaluationError:
            return
        for children, held in started:
            own = self.shared.context(context.application, context.values, context.held + held)
            frame = self.shared.frame(Kind.TAIL, following, left + children, (own, blocks))
            yield point.at(frame, None)


def _last(members: Members, *, merges: bool) -> Iterator[tuple[Path, Open]]:
    """The members that may be the last one; `merges` takes equal chains of a group for one."""
    pending: list[tuple[Members, Path]] = [(members, ())]
    while pending:
        group, above = pending.pop()
        inner: list[tuple[Members, Path]] = []
        seen = set()
        for i, chain in enumerate(group):
            if merges and chain in seen:
                continue
            seen.add(chain)
            here = (*above, (i, len(chain) - 1))
            member = chain[-1]
            if isinstance(member, Nested):
                inner.append((member.members, here))
            else:
                assert isinstance(member, Open)
                yield here, member
        pending.extend(reversed(inner))


class _Last:
    """A member chosen as the last one, and the members that are left before it."""

    def __init__(self, owner: Tailward, point: Point, frame: Frame, path: Path) -> None:
        self.owner = owner
        self.machine = owner.machine
        self.shared = owner.shared
        self.point = point
        self.frame = frame
        self.path = path

    @cached_property
    def left(self) -> Members:
        """The other members: thousands perhaps, which nobody needs for one that is not wanted."""
        return replaced(self.shared, self.frame.first, self.path, None)

    def _with(self, left: Members, *blocks: object) -> Point:
        pending = self.frame.second
        for block in reversed(blocks):
            pending = (block, pending)
        frame = self.shared.frame(Kind.TAIL, self.frame.next, left, pending)
        return self.point.at(frame, None)

    def chosen(self, what: object, member: Open) -> Iterator[Point]:
        """The ways to take a member as the last one, or a part of it in its place."""
        return self._chosen(what, member.values, member)

    def _chosen(self, what: object, values: Environment, member: Open) -> Iterator[Point]:
        from crow.search.machine import choices

        after = () if member.after is None else ((member.after, member.values),)
        match what:
            case Test() as test:
                self.machine.counters.nodes += 1
                yield self._with(self.left, (test, values))
            case CallOp(behavior=name, arguments=parts):
                try:
                    arguments = tuple(part(self.point.state, values) for part in parts)
                except EvaluationError:
                    return
                code = self.machine.programs.code(self.machine.problem.world.behaviors[name])
                yield from self._applied(code, arguments, member)
            case (Code() as code, arguments):
                yield from self._applied(code, arguments, member)
            case AllOf(test=test):
                members = self.machine.parts(what, values, member.application, member.depth)
                yield from self._null(test, values)
                if members:
                    self.machine.counters.nodes += 1
                    yield self._with(self.left + members, (test, values), *after)
            case OneOf(test=test):
                yield from self._null(test, values)
                for part, own in choices(what, values):
                    yield from self._chosen(part, own, member)
            case Atom(test=test):
                yield from self._null(test, values)
                yield from self._atom(what, values, member)
            case Opaque(test=test):
                yield from self._null(test, values)
            case _:
                raise AssertionError(what)

    def _null(self, test: Test, values: Environment) -> Iterator[Point]:
        self.machine.counters.nodes += 1
        yield self._with(self.left, (test, values))

    def _atom(self, atom: Atom, values: Environment, member: Open) -> Iterator[Point]:
        found, is_step = self.machine.alternatives(self.point, atom, self.point.state, values)
        for code, arguments in found:
            if not is_step:
                yield from self._applied(code, arguments, member)
            elif self.machine.within(member.depth + self.machine.level):
                above, depth = member.application, member.depth
                applied = (code, arguments)
                first = self.shared.open(applied, values, above, depth)
                again = self.shared.open(atom, values, above, depth + self.machine.level)
                after = () if member.after is None else ((member.after, member.values),)
                yield self._with((*self.left, (first, again)), *after)

    def _applied(self, code: Code, arguments: tuple[Value, ...], member: Open) -> Iterator[Point]:
        application = self.machine.application(code, arguments, member.application, member.depth)
        if application is None:
            return
        blocks = self.frame.second
        if member.after is not None:
            blocks = ((member.after, member.values), blocks)
        context = self.machine.context(application)
        event = ("for", application, member.application, member.what, member.values)
        point = self.point.noted(event)
        if not code.left:
            yield from self.owner.joined(point, context, self.left, blocks, self.frame.next)
            return
        done = self.shared.frame(Kind.TAIL_LEFT_DONE, self.frame.next, self.left, blocks)
        left = self.machine.section(code.left, done, commits=code.commits[0])
        yield point.told(("left", application)).at(left, context)
