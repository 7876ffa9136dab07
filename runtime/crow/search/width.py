"""Width: how many `achieve`s of one program ⟨L, M, R⟩ are not completed (§3.1, Theorem 2).

Those in M and R count, of a behavior applied in L or R and of all that has joined it since; what
its callers still have to achieve does not.
"""

from crow.problem import Problem
from crow.search.code import (
    AchieveOp,
    AlternativeOp,
    Block,
    CallOp,
    Code,
    IfOp,
    Op,
    SequenceOp,
    Test,
    UnorderedOp,
)
from crow.search.forward import null_test
from crow.search.frames import Application, Context, Frame, Kind, Member, Members, Nested, Open
from crow.search.machine import Machine
from crow.search.points import Cause, Point, holds
from crow.search.states import Snapshot
from crow.values import Value


class Narrow(Machine):
    """A machine that leaves out programs wider than a limit; `is_too_wide` says that it did."""

    def __init__(self, problem: Problem, width: int, seed: int = 0) -> None:
        super().__init__(problem, seed=seed)
        self.width = width
        self._rights: dict[Code, int] = {}
        middle, tail = self._frames[Kind.MIDDLE], self._frames[Kind.TAIL]
        self._frames[Kind.MIDDLE] = lambda point, frame: (
            None if self._is_wide(self._middle(point.state, frame)) else middle(point, frame)
        )
        self._frames[Kind.TAIL] = lambda point, frame: (
            None if self._is_wide(self._tail(frame)) else tail(point, frame)
        )

    def _is_wide(self, count: int) -> bool:
        if count <= self.width:
            return False
        self.is_too_wide = True
        self.counters.cut_by_width += 1
        return True

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
        """The point at which a behavior begins that stands in L or R: a program of its own."""
        if self._is_wide(self._right(code)):
            return None
        return super().applied(point, code, arguments, above, depth, following, cause)

    def _middle(self, state: Snapshot, frame: Frame) -> int:
        return self._members(frame.second, state, is_free=True) + self._owner(frame)

    def _tail(self, frame: Frame) -> int:
        """The state in which members chosen from the end complete is not known."""
        count = self._members(frame.first, None, is_free=True) + self._owner(frame)
        blocks = frame.second
        while blocks is not None:
            block, blocks = blocks
            if isinstance(block, Context):
                count += self._right_of(block)
        return count

    def _owner(self, frame: Frame) -> int:
        """The `achieve`s in the R of the behavior whose M a frame is; a condition has none."""
        following = frame.next
        if following is None or following.kind is not Kind.RESTORE:
            return 0
        return self._right_of(following.first)

    def _right_of(self, context: Context) -> int:
        code = context.application.code
        return 0 if code is None else self._right(code)

    def _right(self, code: Code) -> int:
        found = self._rights.get(code)
        if found is None:
            found = self._rights[code] = achieves(code.right)
        return found

    def _members(self, members: Members, state: Snapshot | None, *, is_free: bool) -> int:
        return sum(
            self._member(member, state, is_free=is_free and place == 0)
            for chain in members
            for place, member in enumerate(chain)
        )

    def _member(self, member: Member, state: Snapshot | None, *, is_free: bool) -> int:
        if isinstance(member, Open):
            return self._open(member, state if is_free else None)
        if isinstance(member, Nested):
            return self._members(member.members, state, is_free=is_free)
        right = 0 if member.context is None else self._right_of(member.context)
        return right + self._members(member.children, state, is_free=True)

    def _open(self, member: Open, state: Snapshot | None) -> int:
        """One for an `achieve`, unless it can complete now, in a state, as it is true."""
        if isinstance(member.what, Test | CallOp | tuple):
            return 0
        if state is None or not member.may_be_null:
            return 1
        test = null_test(member)
        return int(test is None or not holds(test, state, member.values))


def achieves(block: Block) -> int:
    """The most `achieve`s that a block may come to, in one way through it."""
    return sum(map(_achieves, block))


def _achieves(op: Op) -> int:
    match op:
        case AchieveOp():
            return 1
        case SequenceOp(body=body):
            return achieves(body)
        case UnorderedOp(body=body, variables=variables):
            return achieves(body) * (1 if variables is None else len(variables[1]))
        case AlternativeOp(body=body):
            return max(map(_achieves, body), default=0)
        case IfOp(then=then, otherwise=otherwise):
            return max(achieves(then), achieves(otherwise))
        case _:
            return 0
