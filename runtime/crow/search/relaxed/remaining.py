"""What is left to do as facts of the relaxation: those still wanted, behaviors that have begun.

Also the conditions that are to stay true: held ones and the goal, where no open member wants them.
"""

from dataclasses import dataclass, field
from typing import Any

from crow.search.code import AllOf, Atom, Block, CallOp, Code, OneOf, Opaque, Test
from crow.search.expressions import Environment, names_of
from crow.search.frames import Context, Frame, Held, Kind, Member, Members, Nested, Open, Refined
from crow.search.relaxed.facts import Task
from crow.search.relaxed.operators import LATER, Operators
from crow.search.states import Snapshot


@dataclass(slots=True)
class Left:
    """Facts that are wanted, operators that have begun and how often, and facts that are to stay.

    `kept` are those that no open member wants, `held` those that hold until a behavior ends, with
    it and the ones above it; `consumed` counts who ends what it holds. `broken` counts what cannot
    stay for certain.
    """

    wanted: dict[int, None] = field(default_factory=dict)
    begun: dict[int, int] = field(default_factory=dict)
    consumed: dict[int, int] = field(default_factory=dict)
    cost: int = 0
    broken: int = 0
    kept: dict[int, None] = field(default_factory=dict)
    held: dict[tuple[int, frozenset[int]], None] = field(default_factory=dict)
    goals: dict[int, None] = field(default_factory=dict)
    is_possible: bool = True

    def want(self, needs: tuple[int, ...] | None) -> None:
        """Facts that are wanted; None is impossible."""
        if needs is None:
            self.is_possible = False
        else:
            self.wanted |= dict.fromkeys(needs)

    def add(self, other: "Left") -> None:
        """Take another part in."""
        self.wanted |= other.wanted
        for index, count in other.begun.items():
            self.begun[index] = self.begun.get(index, 0) + count
        for number, count in other.consumed.items():
            self.consumed[number] = self.consumed.get(number, 0) + count
        self.broken += other.broken
        self.cost += other.cost
        self.kept |= other.kept
        self.held |= other.held
        self.goals |= other.goals
        self.is_possible &= other.is_possible


class Remaining:
    """Reads frames and members; members are read once."""

    def __init__(self, operators: Operators, task: Task, initial: Snapshot) -> None:
        self.operators = operators
        self.task = task
        self.initial = initial
        self._members: dict[tuple[Member, bool], Left] = {}
        self._frames: dict[tuple[Context | None, Frame], Left] = {}

    def left(self, context: Context | None, frame: Frame | None) -> Left:
        """What is left at a point."""
        if frame is None:
            return Left()
        found = self._frames.get((context, frame))
        if found is None:
            found = self._frames[context, frame] = self._read(context, frame)
        return found

    def _read(self, context: Context | None, frame: Frame | None) -> Left:
        left = Left()
        while frame is not None:
            kind = frame.kind
            if kind is Kind.BLOCK:
                assert context is not None
                self._block(left, frame.first[frame.second :], context.values)
            elif kind is Kind.RESTORE:
                context = frame.first
            elif kind is Kind.START:
                assert context is not None
                code = context.application.code
                assert code is not None
                assert code.middle is not None
                self._block(left, (code.middle,), context.values)
            elif kind is Kind.MIDDLE:
                left.add(self._group(frame.second, frame.first is self.initial))
                self._keep(left, frame.next)
            elif kind in (Kind.LEFT_DONE, Kind.TAIL_LEFT_DONE):
                self._left_done(left, context, frame)
            elif kind is Kind.TAIL:
                left.add(self._group(frame.first, LATER))
                self._pending(left, frame.second)
            elif kind is Kind.PENDING:
                self._pending(left, frame.first)
            elif kind is Kind.END:
                self._end(left, context)
            elif kind is Kind.CHECK:
                self._test(left, frame.first, frame.second)
            elif kind is Kind.ACHIEVE:
                is_first = frame.third[0].code is None
                left.want(self.operators.wanted(frame.first, frame.second, is_first))
            elif kind is Kind.APPLY:
                code, arguments = frame.first
                left.want((self.operators.running(code, arguments, LATER),))
            elif kind in (Kind.UNORDERED, Kind.PART_DONE):
                self._chains(left, frame.second, context)
            frame = frame.next
        return left

    def _left_done(self, left: Left, context: Context | None, frame: Frame) -> None:
        """The L of a member runs: the member, and those beside it."""
        assert context is not None
        code = context.application.code
        assert code is not None
        if frame.kind is Kind.LEFT_DONE:
            middle = frame.first[1]
            is_first = middle.first is self.initial
            path = frame.second[0]
            left.add(self._group(middle.second, is_first, path))
            self._keep(left, middle.next)
            self._begun(left, context, is_first)
            left.add(self.left(None, middle.next))
        else:
            left.add(self._group(frame.first, LATER))
            self._pending(left, frame.second)
            self._begun(left, context, LATER)

    def _block(self, left: Left, block: Block, values: Environment) -> None:
        ways = self.operators.ways(block, values)
        if not ways:
            left.is_possible = False
        elif len(ways) == 1:
            left.want(ways[0].needs)
            left.cost += ways[0].calls

    def _end(self, left: Left, context: Context | None) -> None:
        assert context is not None
        for test, values in context.held:
            self._test(left, test, values)

    def _test(self, left: Left, test: Test, values: Environment) -> None:
        conditions = self.operators.conditions
        left.want(conditions.needs(test.condition, names_of(test.slots, values)))

    def _pending(self, left: Left, blocks: Any) -> None:
        while blocks is not None:
            block, blocks = blocks
            match block:
                case Context():
                    self._right(left, block)
                case (test, values):
                    self._test(left, test, values)

    def _chains(self, left: Left, chains: Any, context: Context | None) -> None:
        for chain in chains:
            self._chains(left, chain.group, context)
            own = chain.values
            if own is None and context is not None:
                own = context.values
            if own is not None:
                self._block(left, chain.rest, own)

    # ------------------------------------------------------------------------------------ members

    def _group(self, members: Members, is_first: bool, without: object = None) -> Left:
        left = Left()
        for i, chain in enumerate(members):
            for j, member in enumerate(chain):
                if without != ((i, j),):
                    left.add(self._member(member, is_first))
        return left

    def _member(self, member: Member, is_first: bool) -> Left:
        found = self._members.get((member, is_first))
        if found is None:
            found = Left()
            match member:
                case Open():
                    self._open(found, member, is_first)
                case Nested(members=members):
                    found = self._group(members, is_first)
                case Refined(context=context, children=children, after=after):
                    found = self._group(children, is_first)
                    for test, values in after:
                        self._test(found, test, values)
                    if context is not None:
                        self._begun(found, context, is_first)
            self._members[member, is_first] = found
        return found

    def _open(self, left: Left, member: Open, is_first: bool) -> None:
        values = member.values
        match member.what:
            case Test() as test:
                self._test(left, test, values)
            case AllOf() | OneOf() | Atom() | Opaque() as wanted:
                again = not member.may_be_null
                left.want(self.operators.wanted(wanted, values, is_first, again=again))
            case CallOp() as call:
                for way in self.operators.ways((call,), values):
                    left.want(way.needs)
            case (Code() as code, arguments):
                left.want((self.operators.running(code, arguments, is_first),))

    def _begun(self, left: Left, context: Context, is_first: bool) -> None:
        """A behavior that members are refined by: its R is to come."""
        application = context.application
        code = application.code
        assert code is not None
        own = Left()
        self._held(own, context.held)
        left.held |= {(number, frozenset()): None for number in own.wanted}
        for index in self.operators.applied(code, application.arguments, is_first):
            if agrees(self.task.operators[index].values, context.values):
                task = self.task
                left.held = {(n, above | {index}): None for n, above in left.held}
                left.broken += sum(n in own.wanted for i in left.begun for n in task.destroyed(i))
                left.begun[index] = left.begun.get(index, 0) + 1
                for number in task.destroyed(index):
                    if number in own.wanted:
                        left.consumed[number] = left.consumed.get(number, 0) + 1
                return
        self._right(left, context)

    def _right(self, left: Left, context: Context) -> None:
        code = context.application.code
        assert code is not None
        self._block(left, code.right, context.values)
        left.cost += not left.cost and code.has_effect
        self._held(left, context.held)

    def _held(self, left: Left, held: Held) -> None:
        for test, values in held:
            self._test(left, test, values)

    def _keep(self, left: Left, following: Frame | None) -> None:
        """What must hold when M is done, and no member is there to make true again."""
        if following is None:
            return
        held: Held = ()
        if following.kind is Kind.CHECK:
            held = ((following.first, following.second),)
        elif following.kind is Kind.RESTORE:
            held = following.first.held
        conditions = self.operators.conditions
        for test, values in held:
            needs = conditions.needs(test.condition, names_of(test.slots, values))
            left.goals |= dict.fromkeys(needs or ())
            left.kept |= {n: None for n in needs or () if n not in left.wanted}


def agrees(planned: Environment, known: Environment) -> bool:
    """Whether values are those of an operator, as far as both are known."""
    return all(a is None or b is None or a == b for a, b in zip(planned, known, strict=True))
