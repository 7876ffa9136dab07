"""Unordered groups of L and R: one statement after another, from the beginnings of their chains.

What one statement refines to stays contiguous; the statements of nested groups may alternate.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

from crow.search.code import (
    AchieveOp,
    AlternativeOp,
    Block,
    CommitOp,
    FixOp,
    IfOp,
    Op,
    SequenceOp,
    Test,
    UnorderedOp,
)
from crow.search.expressions import Environment
from crow.search.frames import Context, Frame, Kind
from crow.search.members import with_slots
from crow.search.points import Choice, Point, Step, holds

if TYPE_CHECKING:
    from crow.search.machine import Machine


class Chain(NamedTuple):
    """Statements in order, after the rest of a nested group; with variables of their own.

    `values` is None while one of its statements runs; `is_last` says that its last `commit` is
    to come after all others; `was_true` that what it achieves was true at some time in the group.
    """

    values: Environment | None
    group: "Chains"
    rest: Block
    is_last: bool
    was_true: bool = False


Chains = tuple[Chain, ...]
NOTHING = SequenceOp(())


class Unordered:
    """Runs unordered groups."""

    def __init__(self, machine: "Machine") -> None:
        self.machine = machine

    def begin(self, point: Point, op: UnorderedOp, rest: Frame | None) -> Step:
        """A group is reached."""
        context = point.context
        assert context is not None
        chains = _chains(op, context.values)
        committing = [i for i, chain in enumerate(chains) if _commits(chain)]
        if len(committing) < 2:
            return point.at(self._frame(op, chains, context.values, rest, opens=False), context)
        return Choice(point, self._lasts(point, op, chains, committing, rest))

    def _lasts(
        self, point: Point, op: UnorderedOp, chains: Chains, committing: list[int],
        rest: Frame | None,
    ) -> Iterator[Point]:  # fmt: skip
        """Which `commit` comes last stays open, whatever is committed to (semantics.md §2)."""
        context = point.context
        assert context is not None
        for index in committing:
            marked = tuple(c._replace(is_last=i == index) for i, c in enumerate(chains))
            frame = self._frame(op, marked, context.values, rest, opens=True)
            assert point.cuts is not None
            since, kept, outer = point.cuts
            cuts = (since, (*kept, self.machine.height() - 1), outer)
            yield point._replace(context=context, frame=frame, cuts=cuts)

    def _frame(
        self, op: UnorderedOp, chains: Chains, values: Environment, rest: Frame | None, *,
        opens: bool,
    ) -> Frame:  # fmt: skip
        third = (values, opens)
        return self.machine.shared.frame(Kind.UNORDERED, rest, op, chains, third)

    def group(self, point: Point, frame: Frame) -> Step:
        """The statements that may come next, or the end of the group."""
        context = point.context
        assert context is not None
        op, chains, (values, opens) = frame.first, frame.second, frame.third
        if chains:
            if self.machine.prunes and not any(map(_commits, chains)):
                return self._of_those_open(point, frame, context)
            return Choice(point, self._options(point, frame))
        after = self.machine.shared.context(context.application, values, context.held)
        cuts = point.cuts
        if opens and cuts is not None:
            cuts = (cuts[0], cuts[1][:-1], cuts[2])
        assert isinstance(op, UnorderedOp)
        return point._replace(context=after, frame=frame.next, cuts=cuts)

    def _of_those_open(self, point: Point, frame: Frame, context: Context) -> Step:
        """Achieves that are true wait: nothing comes sooner by them, and later they may not be.

        When only they are left, they all refine to nothing. So the orders in which they may stand
        among the others, which are all one plan, are not tried one by one.
        """
        chains: Chains = frame.second
        true = frozenset(i for i, chain in enumerate(chains) if self._is_true(point, chain))
        if not true:
            return Choice(point, self._options(point, frame))
        for index in true:
            if not chains[index].was_true:
                point = point.told(("assert", *_wanted(chains[index])))
        if len(true) < len(chains):
            marked = tuple(
                c._replace(was_true=c.was_true or i in true) for i, c in enumerate(chains)
            )
            waiting = self.machine.shared.frame(
                Kind.UNORDERED, frame.next, frame.first, marked, frame.third
            )
            point = point.at(waiting, context)
            return Choice(point, self._options(point, waiting, true))
        self.machine.counters.nodes += len(chains)
        values, opens = frame.third
        ended = self._frame(frame.first, (), values, frame.next, opens=opens)
        return point.at(ended, self._holding(context, chains))

    def _is_true(self, point: Point, chain: Chain) -> bool:
        """Whether all that is left of a chain is to achieve what is true."""
        if not _is_achieve(chain):
            return False
        test, values = _wanted(chain)
        return holds(test, point.state, values)

    def _holding(self, context: Context, chains: Chains) -> Context:
        """The context after achieves that refined to nothing."""
        held = tuple(_wanted(chain) for chain in chains if _holds_on(chain))
        shared = self.machine.shared
        return shared.context(context.application, context.values, context.held + held)

    def _options(
        self, point: Point, frame: Frame, waiting: frozenset[int] = frozenset()
    ) -> Iterator[Point]:
        context, shared = point.context, self.machine.shared
        assert context is not None
        yield from self._next(point, frame, context, waiting)
        chains: Chains = frame.second
        for index, chain in enumerate(chains):
            if chain.was_true and index not in waiting:  # it refined to nothing when it was
                self.machine.counters.nodes += 1
                others = chains[:index] + chains[index + 1 :]
                rest = shared.frame(Kind.UNORDERED, frame.next, frame.first, others, frame.third)
                yield point.at(rest, self._holding(context, (chain,)))

    def _next(
        self, point: Point, frame: Frame, context: Context, waiting: frozenset[int]
    ) -> Iterator[Point]:
        shared = self.machine.shared
        for op, values, left in _steps(frame.second, waiting):
            own = shared.context(context.application, values, context.held)
            done = shared.frame(Kind.PART_DONE, frame.next, frame.first, left, frame.third)
            yield point.at(shared.frame(Kind.BLOCK, done, (op,), 0), own)

    def part_done(self, point: Point, frame: Frame) -> Step:
        """A statement has run; its chain, and outer variables, have the values it left."""
        context = point.context
        assert context is not None
        op, (outer, opens) = frame.first, frame.third
        new = {slot: context.values[slot] for slot in op.shared}
        chains = _filled(frame.second, context.values, new)
        code = context.application.code
        assert code is not None
        # The group's binds are out of scope behind it, but the plan names their values.
        bound = (slot for _, slot in code.bound if outer[slot] is None)
        new |= {slot: context.values[slot] for slot in bound}
        values = with_slots(outer, tuple(new), tuple(new.values())) if new else outer
        return point.at(self._frame(op, chains, values, frame.next, opens=opens), context)


def _chains(op: UnorderedOp, values: Environment) -> Chains:
    """The chains of a group where it begins."""
    if op.variables is None:
        found = [_settled(values, (part,)) for part in op.body]
    else:
        slots, tuples = op.variables
        found = [_settled(with_slots(values, slots, chosen), op.body) for chosen in tuples]
    return tuple(chain for chain in found if chain is not None)


def _settled(values: Environment, rest: Block, *, is_last: bool = False) -> Chain | None:
    """A chain from its first real statement on; None when there is none."""
    while rest:
        op = rest[0]
        match op:
            case SequenceOp(body=body) if op is not NOTHING:
                rest = (*body, *rest[1:])
            case FixOp(slot=slot, value=value):
                values, rest = with_slots(values, (slot,), (value,)), rest[1:]
            case UnorderedOp():
                group = _chains(op, values)
                if group:
                    return Chain(values, group, rest[1:], is_last)
                rest = rest[1:]
            case _:
                return Chain(values, (), rest, is_last)
    return None


def _is_achieve(chain: Chain) -> bool:
    """Whether all that is left of a chain is an achieve."""
    return not chain.group and len(chain.rest) == 1 and isinstance(chain.rest[0], AchieveOp)


def _wanted(chain: Chain) -> tuple[Test, Environment]:
    """What such a chain achieves."""
    (op,) = chain.rest
    assert isinstance(op, AchieveOp)
    assert chain.values is not None
    return op.test, chain.values


def _holds_on(chain: Chain) -> bool:
    (op,) = chain.rest
    return isinstance(op, AchieveOp) and op.is_held


def _steps(
    chains: Chains, waiting: frozenset[int] = frozenset()
) -> Iterator[tuple[Op, Environment, Chains]]:
    """Each statement that may come next, its variables, and the chains without it.

    Those that are `waiting` do not come next.
    """
    # The chain whose `commit` comes last, last: its beginning is not to be undone by the others.
    for index, chain in sorted(enumerate(chains), key=lambda pair: pair[1].is_last):
        if index in waiting:
            continue
        before, after = chains[:index], chains[index + 1 :]
        for op, values, left in _heads(chain):
            rest = before + after if left is None else (*before, left, *after)
            ends = isinstance(op, CommitOp) and chain.is_last and not (left and _commits(left))
            if not (ends and any(map(_commits, before + after))):
                yield op, values, rest


def _heads(chain: Chain) -> Iterator[tuple[Op, Environment, Chain | None]]:
    values = chain.values
    if chain.group:
        assert values is not None
        for op, own, left in _steps(chain.group):
            if left:
                yield op, own, chain._replace(group=left)
            else:
                yield op, own, _settled(values, chain.rest, is_last=chain.is_last)
        return
    assert values is not None
    op, rest = chain.rest[0], chain.rest[1:]
    if isinstance(op, AlternativeOp):
        for part in op.body:
            settled = _settled(values, (part, *rest), is_last=chain.is_last)
            if settled is None:
                yield NOTHING, values, None
            else:
                yield from _heads(settled)
        return
    yield op, values, Chain(None, (), rest, chain.is_last) if rest else None


def _filled(chains: Chains, values: Environment, new: dict[int, object]) -> Chains:
    """The chains after a statement of one has run, which left these values."""
    found = []
    slots, own = tuple(new), tuple(new.values())
    for chain in chains:
        if chain.values is None:
            settled = _settled(values, chain.rest, is_last=chain.is_last)
            if settled is not None:
                found.append(settled)
        else:
            kept = with_slots(chain.values, slots, own) if new else chain.values
            found.append(chain._replace(values=kept, group=_filled(chain.group, values, new)))
    return tuple(found)


def _commits(chain: Chain) -> bool:
    """Whether a `commit` is left in a chain."""
    return any(map(_commits, chain.group)) or any(map(_has_commit, chain.rest))


def _has_commit(op: Op) -> bool:
    match op:
        case CommitOp():
            return True
        case SequenceOp(body=body) | AlternativeOp(body=body) | UnorderedOp(body=body):
            return any(map(_has_commit, body))
        case IfOp(then=then, otherwise=otherwise):
            return any(map(_has_commit, (*then, *otherwise)))
        case _:
            return False
