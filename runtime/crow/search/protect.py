"""Dead ends seen early: a condition that is false, is needed, and that nothing left can make true.

That is an open member that may not be refined any more, or a condition that is held, or the goal,
which was true and was destroyed. Names the "protected goals" of semantics.md §3.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from crow.search.code import AllOf, Atom, CallOp, Code, OneOf, Opaque, Test
from crow.search.expressions import Environment
from crow.search.frames import Context, Frame, Kind, Member, Members, Nested, Open, Refined
from crow.search.members import Path
from crow.search.states import Snapshot
from crow.search.writes import (
    NO_WRITES,
    Literal,
    Writers,
    Writes,
    literals,
    may_write,
)

if TYPE_CHECKING:
    from crow.search.machine import Machine


class Protection:
    """Finds what keeps the members of an M from ever completing."""

    def __init__(self, machine: "Machine") -> None:
        self.machine = machine
        programs = machine.programs
        self.writers = Writers(programs.world, programs.conditions, programs.matching)
        self._needed: dict[tuple[Test, Environment], tuple[Literal, ...]] = {}
        self._writes: dict[tuple[Member, int], Writes] = {}
        self.last: tuple[Test, Environment] | None = None

    def is_hopeless(self, state: Snapshot, frame: Frame, members: Members) -> bool:
        """Whether a literal is needed that is false and that nothing left can make true.

        `last` is then the condition that it is in, with the values of its variables.
        """
        nodes = list(_nodes(members))
        for wanted, owner in self._wanted(state, frame, nodes):
            if not any(
                may_write(self._member_writes(member), wanted)
                for path, member in nodes
                if owner is None or path != owner[: len(path)]
            ) and not self._may_write_itself(owner, nodes, frame, wanted):
                return True
        return False

    def _wanted(
        self, state: Snapshot, frame: Frame, nodes: list[tuple[Path, Open | Refined]]
    ) -> Iterator[tuple[Literal, Path | None]]:
        """False literals that are needed, by which member: no member at or above it helps."""
        limit = self.machine.depth_limit
        for path, member in nodes:
            match member:
                case Open(what=Test() as test):
                    for literal in self._false(state, test, member.values):
                        yield literal, path
                case Open(what=Atom(test=test)) if member.depth >= limit:
                    for literal in self._false(state, test, member.values):
                        yield literal, path
                case Refined(context=Context(held=held)):
                    for test, values in held:
                        for literal in self._false(state, test, values):
                            yield literal, path
                case _:
                    pass
        following = frame.next
        if following is None:
            return
        if following.kind is Kind.CHECK:
            for literal in self._false(state, following.first, following.second):
                yield literal, None
        elif following.kind is Kind.RESTORE:
            for test, values in following.first.held:
                for literal in self._false(state, test, values):
                    yield literal, None

    def _false(self, state: Snapshot, test: Test, values: Environment) -> Iterator[Literal]:
        needed = self._needed.get((test, values))
        if needed is None:
            names = {name: values[slot] for name, slot in test.slots.items()}
            needed = self._needed[test, values] = tuple(literals(test.condition, names))
        for literal in needed:
            cell = (literal.feature, literal.arguments)
            value = state.delta[cell] if cell in state.delta else state.base.get(cell, False)
            if value != literal.value:
                self.last = test, values
                yield literal

    def _may_write_itself(
        self,
        owner: Path | None,
        nodes: list[tuple[Path, Open | Refined]],
        frame: Frame,
        wanted: Literal,
    ) -> bool:
        """Whether the R in which a condition is held may make it true before it is needed."""
        if owner is None:
            following = frame.next
            if following is None or following.kind is not Kind.RESTORE:
                return False
            return may_write(self._right_writes(following.first, with_effect=False), wanted)
        member = next(member for path, member in nodes if path == owner)
        if not isinstance(member, Refined) or member.context is None:
            return False
        if any(
            may_write(self._member_writes(below), wanted)
            for path, below in nodes
            if path != owner and path[: len(owner)] == owner
        ):
            return True
        return may_write(self._right_writes(member.context, with_effect=False), wanted)

    # ------------------------------------------------------------------------------------- writes

    def _member_writes(self, member: Open | Refined) -> Writes:
        key = (member, self.machine.depth_limit)
        found = self._writes.get(key)
        if found is None:
            found = self._writes[key] = self._of_member(member)
        return found

    def _of_member(self, member: Open | Refined) -> Writes:
        """What a member may write, its children left out."""
        if isinstance(member, Refined):
            if member.context is None:
                return NO_WRITES
            return self._right_writes(member.context, with_effect=True)
        depth = self.machine.depth_limit - member.depth
        match member.what:
            case AllOf(test=test) | OneOf(test=test) | Atom(test=test):
                names = {name: member.values[slot] for name, slot in test.slots.items()}
                return self.writers.condition(test.condition, names, depth)
            case Test() | Opaque():
                return NO_WRITES
            case CallOp(behavior=name):
                behavior = self.machine.problem.world.behaviors[name]
                unknown = tuple(None for _ in behavior.parameters)
                return self.writers.behavior(behavior, unknown, depth)
            case (Code(behavior=behavior), arguments):
                return self.writers.behavior(behavior, arguments, depth)
            case _:
                raise AssertionError(member)

    def _right_writes(self, context: Context, *, with_effect: bool) -> Writes:
        application = context.application
        code = application.code
        if code is None:
            return NO_WRITES
        behavior = code.behavior
        names = {p.name: v for p, v in zip(behavior.parameters, application.arguments, strict=True)}
        depth = self.machine.depth_limit - application.depth
        right = self.writers.body(behavior.right, names, depth)
        if not with_effect or behavior.effect is None:
            return right
        known = {name: context.values[slot] for name, slot in code.effect_slots.items()}
        declared = {name for name, slot in code.effect_slots.items() if slot >= len(names)}
        settled = {n: v for n, v in known.items() if n not in declared or v is not None}
        effect = self.writers.effect(behavior.effect, settled)
        features = right.keys() | effect.keys()
        return {f: right.get(f, frozenset()) | effect.get(f, frozenset()) for f in features}


def _nodes(members: Members) -> Iterator[tuple[Path, Open | Refined]]:
    pending: list[tuple[Members, Path]] = [(members, ())]
    while pending:
        group, above = pending.pop()
        for i, chain in enumerate(group):
            for j, member in enumerate(chain):
                here = (*above, (i, j))
                match member:
                    case Nested(members=inner):
                        pending.append((inner, here))
                    case Refined(children=inner):
                        yield here, member
                        pending.append((inner, here))
                    case Open():
                        yield here, member
