"""The members of M as a tree of chains: building it when M starts, walking it, changing it."""

from collections.abc import Iterator
from itertools import product

from crow.search.code import (
    AchieveOp,
    AlternativeOp,
    AssertOp,
    CallOp,
    IfOp,
    Op,
    SequenceOp,
    UnorderedOp,
)
from crow.search.expressions import Environment
from crow.search.frames import (
    Application,
    Context,
    Held,
    Kind,
    Member,
    Members,
    Nested,
    Open,
    Refined,
    Shared,
)
from crow.search.points import Point, is_true
from crow.search.states import Snapshot

Path = tuple[tuple[int, int], ...]
"""Chain and place in it, from the outside in."""

Started = tuple[Members, Held]


class Starting:
    """Builds the members of an application's M in the state in which M starts."""

    def __init__(
        self, shared: Shared, application: Application, values: Environment, state: Snapshot
    ) -> None:
        self.shared = shared
        self.application = application
        self.values = values
        self.state = state

    def members(self, op: Op, values: Environment | None = None) -> list[Started]:
        """The chains of a statement and what it holds, one for each way to choose in it.

        Raises EvaluationError when an `if` cannot be decided.
        """
        own = self.values if values is None else values
        match op:
            case SequenceOp(body=body):
                return self._sequence(body, own)
            case UnorderedOp(body=body, variables=None):
                return self._unordered([self.members(part, own) for part in body])
            case UnorderedOp(body=body, variables=(slots, choices)):
                parts = [
                    self.members(part, with_slots(own, slots, chosen))
                    for chosen in choices
                    for part in body
                ]
                return self._unordered(parts)
            case AlternativeOp(body=body):
                return [started for part in body for started in self.members(part, own)]
            case IfOp(test=test, then=then, otherwise=otherwise):
                return self._sequence(then if is_true(test, self.state, own) else otherwise, own)
            case _:
                return [self._leaf(op, own)]

    def _leaf(self, op: Op, values: Environment) -> Started:
        depth = self.application.depth
        held: Held = ()
        match op:
            case AssertOp(test=test, is_held=is_held):
                member = self.shared.open(test, values, self.application, depth)
                held = ((test, values),) if is_held else ()
            case AchieveOp(wanted=wanted, test=test, is_held=is_held):
                after = test if is_held else None
                member = self.shared.open(wanted, values, self.application, depth, after)
                held = ((test, values),) if is_held else ()
            case CallOp():
                member = self.shared.open(op, values, self.application, depth)
            case _:
                raise AssertionError(f"{type(op).__name__} in M")
        return ((member,),), held

    def _sequence(self, body: tuple[Op, ...], values: Environment) -> list[Started]:
        results: list[Started] = []
        for parts in product(*(self.members(op, values) for op in body)):
            chain: list[Member] = []
            held: Held = ()
            for members, more in parts:
                held += more
                if len(members) == 1:
                    chain.extend(members[0])
                elif members:
                    chain.append(self.shared.nested(members))
            results.append(((tuple(chain),) if chain else (), held))
        return results

    def _unordered(self, parts: list[list[Started]]) -> list[Started]:
        if all(len(part) == 1 for part in parts):  # mostly; and there may be thousands
            chains = tuple(chain for ((members, _),) in parts for chain in members)
            return [(chains, tuple(one for ((_, held),) in parts for one in held))]
        results = []
        for chosen in product(*parts):
            chains = tuple(chain for members, _ in chosen for chain in members)
            results.append((chains, tuple(one for _, held in chosen for one in held)))
        return results


def with_slots(values: Environment, slots: tuple[int, ...], chosen: Environment) -> Environment:
    """The values with some slots filled."""
    changed = list(values)
    for slot, value in zip(slots, chosen, strict=True):
        changed[slot] = value
    return tuple(changed)


def children_at(members: Members, path: Path) -> Members:
    """The members under the one at a path; all of them under none."""
    for chain, place in path:
        member = members[chain][place]
        assert not isinstance(member, Open)
        members = member.members if isinstance(member, Nested) else member.children
    return members


Focus = tuple[Path, bool]
"""A member, by its path, and whether it may complete now."""


def walk(members: Members, focus: Focus | None) -> Iterator[tuple[Path, Open | Refined, bool]]:
    """The members that may be chosen, with whether they may complete now.

    All of them, or those of `focus`: a member and what is below it. Parents come before children.
    """
    pending: list[tuple[Members, Path, bool]] = []
    if focus is None:
        pending.append((members, (), True))
    else:
        path, is_free = focus
        chosen = member_at(members, path)
        assert not isinstance(chosen, Nested)
        yield path, chosen, is_free
        if isinstance(chosen, Refined):
            pending.append((chosen.children, path, True))
    while pending:
        group, above, is_free = pending.pop()
        inner: list[tuple[Members, Path, bool]] = []
        for i, chain in enumerate(group):
            for j, member in enumerate(chain):
                here = (*above, (i, j))
                is_first = is_free and j == 0
                if isinstance(member, Nested):
                    inner.append((member.members, here, is_first))
                    continue
                yield here, member, is_first
                if isinstance(member, Refined):
                    inner.append((member.children, here, True))
        pending.extend(reversed(inner))


def member_at(members: Members, path: Path) -> Member:
    """The member at a path."""
    chain, place = path[-1]
    return children_at(members, path[:-1])[chain][place]


def replaced(shared: Shared, members: Members, path: Path, new: Member | None) -> Members:
    """The members with the one at a path replaced, or taken out; empty groups go with it."""
    groups = [members]
    for chain, place in path[:-1]:
        member = groups[-1][chain][place]
        assert not isinstance(member, Open)
        groups.append(member.members if isinstance(member, Nested) else member.children)
    for depth in range(len(path) - 1, -1, -1):
        (i, j), group = path[depth], groups[depth]
        chain_ = group[i]
        changed = (*chain_[:j], *(() if new is None else (new,)), *chain_[j + 1 :])
        group = (*group[:i], *((changed,) if changed else ()), *group[i + 1 :])
        if depth == 0:
            return group
        above_chain, above_place = path[depth - 1]
        above = groups[depth - 1][above_chain][above_place]
        if isinstance(above, Nested):
            new = shared.nested(group) if group else None
        else:
            assert isinstance(above, Refined)
            new = shared.refined(above.context, group, above.after)
    raise AssertionError("an empty path")


def begun(point: Point) -> tuple[Members, Path, Context | None]:
    """The member that a choice began, by its path: its L runs, or its members were added."""
    frame = point.frame
    if point.context is None:
        if frame is None or frame.kind is not Kind.MIDDLE or frame.third is None:
            return (), (), None
        members, path = frame.second, frame.third[0]
        member = member_at(members, path)
        return members, path, member.context if isinstance(member, Refined) else None
    while frame is not None and frame.kind is not Kind.LEFT_DONE:
        frame = frame.next
    if frame is None:
        return (), (), None
    return frame.first[1].second, frame.second[0], point.context
