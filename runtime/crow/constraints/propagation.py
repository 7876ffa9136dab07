"""What follows from constraints and values: unit rules, functions, equations (App. B.1)."""

import math
from collections import deque
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any, Final

from crow.constraints.constraint import Constraint
from crow.constraints.equations import repaired, solved
from crow.constraints.layered import Draft
from crow.constraints.pairing import Pairing, pairings
from crow.constraints.reduce import Reducer
from crow.constraints.store import Bounds, Requirement, Store
from crow.constraints.terms import (
    Failed,
    Ground,
    Open,
    is_known,
    is_late,
    is_partial,
    meaning,
    opened,
    unknowns_of,
)
from crow.evaluate import EvaluationError
from crow.program.types import BOOL, ObjectType, is_integer
from crow.unknowns import Unknown, unknowns_in
from crow.values import Value, ValueRangeError, converted

_ABSENT: Final = object()
_MIRRORED: Final = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}
_OPPOSITE: Final = {"<": ">=", "<=": ">", ">": "<=", ">=": "<"}


class Clash(Exception):  # noqa: N818 - ends a propagation
    """Requirements that cannot be met together; `run` knows how it came to that."""

    def __init__(
        self, requirements: tuple[Requirement, ...], reason: str, run: "Propagation"
    ) -> None:
        super().__init__(reason)
        self.requirements = requirements
        self.reason = reason
        self.run = run

    @property
    def mask(self) -> int:
        """The choices that it rests on."""
        mask = 0
        for requirement in self.requirements:
            mask |= self.run.mask(requirement)
        return mask


class Marker(Unknown):
    """What stands for a choice that gives no unknown a value: a side of an atom, an expression."""

    __slots__ = ()


class Propagation:
    """A store on its way to the next one."""

    def __init__(self, store: Store) -> None:
        self.store = store
        self.knowledge = store.knowledge
        self.values = Draft(store.values)
        self.origins = Draft(store.origins)
        self.masks = Draft(store.masks)
        self.pending = Draft(store.pending)
        self.structured = Draft(store.structured)
        self.discrete = Draft(store.discrete)
        self.ready = Draft(store.ready)
        self.occurrences = Draft(store.occurrences)
        self.bounds = Draft(store.bounds)
        self.given = Draft(store.given)
        self.mentioned: dict[Unknown, None] = {}
        self.count = store.count
        self.reducer = Reducer(store.knowledge, self.values)
        self._queue: deque[Requirement] = deque()
        self._queued: set[Requirement] = set()

    def take(self, constraint: Constraint) -> None:
        """Require a constraint. Raises Clash."""
        self.reducer.seen = {}
        try:
            ground = self.reducer.reduce(
                constraint.condition, constraint.variables, constraint.state.cells
            )
        except RecursionError:
            message = "the computation is nested too deeply"
            ground = Failed(EvaluationError(message, constraint.place))
        self.given[constraint] = None
        unknown = constraint.defined
        if unknown is not None:
            stored = self.reducer.made("store", (ground,), unknown.type, constraint.place)
            own = self.reducer.known(unknown)
            ground = self.reducer.made("==", (own, stored), BOOL, constraint.place)
        self.mentioned |= self.reducer.seen
        known = dict.fromkeys(u for u in self.reducer.seen if u in self.values)
        if is_late(ground):  # it may come to read any cell
            read = self.knowledge.open_cells(constraint.state.cells)
            known |= dict.fromkeys(u for _, value in read for u in unknowns_in(value))
        self._demand(ground, constraint.is_wanted, constraint, tuple(known))

    def choose(self, unknown: Unknown, value: Value, mask: int = 0) -> None:
        """Give an unknown a value by choice. Raises Clash."""
        self._assign(unknown, value, (), mask)

    def require(self, ground: Ground, source: Constraint, parents: tuple[Unknown, ...]) -> None:
        """Require a term by choice, on behalf of a constraint. Raises Clash."""
        self._demand(self.reducer.refreshed(ground), is_wanted=True, source=source, parents=parents)

    def decide(
        self,
        requirement: Requirement,
        ground: Ground,
        side: tuple[Ground, bool],
        marker: Unknown,
    ) -> None:
        """Require an atom of a requirement, or its opposite, and what is left of it. Raises Clash.

        `ground` is what the requirement is by now, `marker` stands for the choice.
        """
        self._settle(requirement)
        atom, is_wanted = side
        rest = self.reducer.with_atom(ground, atom, is_wanted)
        why = (*self._why(requirement), marker)
        self._demand(atom, is_wanted, requirement.source, (marker,))
        self._demand(self.reducer.refreshed(rest), requirement.is_wanted, requirement.source, why)

    def finished(self) -> Store:
        """The store once nothing more follows. Raises Clash."""
        while self._queue:
            requirement = self._queue.popleft()
            self._queued.discard(requirement)
            if requirement in self.pending:
                self._visit(requirement)
        return replace(
            self.store,
            values=self.values.made(),
            origins=self.origins.made(),
            masks=self.masks.made(),
            pending=self.pending.made(),
            structured=self.structured.made(),
            discrete=self.discrete.made(),
            ready=self.ready.made(),
            occurrences=self.occurrences.made(),
            bounds=self.bounds.made(),
            given=self.given.made(),
            mentioned=self.store.mentioned.changed(self.mentioned),
            count=self.count,
        )

    def mask(self, requirement: Requirement) -> int:
        """The choices that a requirement, under the values there are, rests on."""
        mask = 0
        get = self.masks.get
        for unknown in requirement.unknowns:
            mask |= get(unknown, 0)
        for unknown in requirement.parents:
            mask |= get(unknown, 0)
        return mask

    # ---------------------------------------------------------------------------- requirements

    def _demand(
        self,
        ground: Ground,
        is_wanted: bool,
        source: Constraint,
        parents: tuple[Unknown, ...],
    ) -> None:
        """Meet a requirement at once, or keep it."""
        while type(ground) is Open and ground.operator == "not":
            ground, is_wanted = ground.operands[0], not is_wanted
        unknowns = unknowns_of(ground)
        made = Requirement(self.count, ground, is_wanted, unknowns, source, parents)
        self.count += 1
        if self._is_met(ground, is_wanted, made):
            return
        if ground.operator == "named":
            self._demand(ground.operands[0], is_wanted, source, parents)
            ground = self.reducer.refreshed(ground)
            if is_known(ground):
                self._is_met(ground, is_wanted, made)
                return
        self._keep(replace(made, pairings=pairings(self.knowledge, ground, is_wanted)))

    def _keep(self, requirement: Requirement) -> None:
        unknown_yet = [u for u in requirement.unknowns if u not in self.values]
        self.pending[requirement] = len(unknown_yet)
        if requirement.is_structured:
            self.structured[requirement] = None
        if requirement.is_discrete:
            self.discrete[requirement] = None
        for unknown in unknown_yet:
            self.occurrences[unknown] = (*self.occurrences.get(unknown, ()), requirement)
        if len(unknown_yet) < len(requirement.unknowns):
            self._enqueue(requirement)  # a part that was met just now has given a value
        self._see_whether_ready(requirement)

    def _enqueue(self, requirement: Requirement) -> None:
        if requirement not in self._queued:
            self._queued.add(requirement)
            self._queue.append(requirement)

    def _settle(self, requirement: Requirement) -> None:
        for own in (self.pending, self.structured, self.discrete, self.ready):
            own.drop(requirement)

    def _visit(self, requirement: Requirement) -> None:
        ground = self.reducer.refreshed(requirement.term)
        if type(ground) is Open and self._is_another(ground, requirement):
            self._settle(requirement)
            self._demand(ground, requirement.is_wanted, requirement.source, self._why(requirement))
        elif self._is_met(ground, requirement.is_wanted, requirement):
            self._settle(requirement)
        else:
            self._see_whether_ready(requirement)

    def _is_another(self, ground: Open, requirement: Requirement) -> bool:
        """Whether a requirement has come to something that is to be kept by itself."""
        if ground.operator != requirement.term.operator:
            return True
        if not is_late(requirement.term):
            return False
        own = frozenset(requirement.unknowns)
        return any(unknown not in own for unknown in unknowns_of(ground))

    def _see_whether_ready(self, requirement: Requirement) -> None:
        if any(map(self.is_ready, requirement.pairings)):
            self.ready[requirement] = None
        else:
            self.ready.drop(requirement)

    def is_ready(self, pairing: Pairing) -> bool:
        """Whether a generator can be asked, and would tell something."""
        return (
            all(u in self.values for u in pairing.read)
            and all(is_known(self.reducer.refreshed(i)) for i in pairing.inputs)
            and not all(is_known(self.reducer.refreshed(o)) for o in pairing.outputs)
        )

    def _why(self, requirement: Requirement) -> tuple[Unknown, ...]:
        """The unknowns whose values make a requirement what it is by now."""
        own = (u for u in requirement.unknowns if u in self.values)
        return tuple(dict.fromkeys((*requirement.parents, *own)))

    # ----------------------------------------------------------------------------------- rules

    def _is_met(self, ground: Ground, is_wanted: bool, by: Requirement) -> bool:
        """Do what a requirement comes to; False if it has to be looked at again.

        Raises Clash where it cannot be met, and what the user's Python raised.
        """
        if type(ground) is Unknown:
            self._assign(ground, is_wanted, (by,))
            return True
        if type(ground) is Failed:
            raise self._failure(ground, by)
        if type(ground) is not Open:
            if bool(ground) != is_wanted:
                raise Clash((by,), "a constraint is false", self)
            return True
        match ground.operator:
            case "not":
                return self._is_met(ground.operands[0], not is_wanted, by)
            case "and" | "or":
                return self._connective(ground, is_wanted, by)
            case "if":
                return self._conditional(ground, is_wanted, by)
            case "==" | "!=":
                if is_wanted == (ground.operator == "=="):
                    return self._equation(ground, by)
                return False
            case "<" | "<=" | ">" | ">=":
                self._bound(ground, is_wanted, by)
                return False
            case _:
                return False

    def _failure(self, failed: Failed, by: Requirement) -> Exception:
        if isinstance(failed.error, EvaluationError):
            return Clash((by,), str(failed.error), self)
        return failed.error

    def _connective(self, ground: Open, is_wanted: bool, by: Requirement) -> bool:
        """All of several parts, or one of them."""
        parts = ground.operands
        if (ground.operator == "and") == is_wanted:
            why = self._why(by)
            for part in parts:
                self._demand(self.reducer.refreshed(part), is_wanted, by.source, why)
            return True
        *first, last = parts
        if is_known(last):
            return False  # met, as soon as what comes first has a value at all
        if type(last) is Failed and len(first) == 1:
            self._demand(first[0], is_wanted, by.source, self._why(by))
            return True
        return False

    def _conditional(self, ground: Open, is_wanted: bool, by: Requirement) -> bool:
        """A truth value chosen by a condition that is open."""
        condition, *branches = ground.operands
        for index, branch in enumerate(branches):
            if type(branch) is Failed or (is_known(branch) and bool(branch) != is_wanted):
                why = self._why(by)
                self._demand(condition, index == 1, by.source, why)
                other = self.reducer.refreshed(branches[1 - index])
                self._demand(other, is_wanted, by.source, why)
                return True
        return all(map(is_known, branches)) and not is_partial(condition)

    # ------------------------------------------------------------------------------- equations

    def _equation(self, ground: Open, by: Requirement) -> bool:
        left, right = map(meaning, ground.operands)
        for unknown, value in ((left, right), (right, left)):
            if type(unknown) is Unknown and is_known(value):
                self._assign(unknown, value, (by,))
                return True
        unknowns = unknowns_of(ground)
        if len(unknowns) != 1:
            return False
        (unknown,) = unknowns
        is_true = partial(self._is_true, ground, unknown)
        found = solved(left, right, unknown, is_true)
        if found == () and (vector := self._vector_solution(left, right, unknown)) is not None:
            found = (vector,)
        if found is None:
            return False
        if not found:
            message = f"no value of `{unknown.name}` makes an equation true"
            raise Clash((by,), message, self)
        self._assign(unknown, found[0], (by,))
        return True

    def _is_true(self, ground: Ground, unknown: Unknown, value: Value) -> bool:
        fitting = self._fitting(unknown, value)
        return fitting is not _ABSENT and self._with(unknown, fitting).refreshed(ground) is True

    def _with(self, unknown: Unknown, value: Value) -> Reducer:
        """Terms as they are if an unknown has a value."""
        return Reducer(self.knowledge, _With(self.values, {unknown: value}))

    def _vector_solution(self, left: Ground, right: Ground, unknown: Unknown) -> Value | None:
        """A vector that solves an equation where rounding is in the way, element by element."""
        nearest: list[Value] = []

        def note(value: Value) -> bool:
            nearest.append(value)
            return False

        solved(left, right, unknown, note)
        if not nearest or not isinstance(nearest[0], tuple):
            return None

        def is_true(index: int, element: Value) -> bool:
            tried = (*nearest[0][:index], element, *nearest[0][index + 1 :])
            reducer = self._with(unknown, tried)
            sides = reducer.refreshed(left), reducer.refreshed(right)
            return all(isinstance(s, tuple) for s in sides) and bool(
                sides[0][index : index + 1] == sides[1][index : index + 1]
            )

        found = repaired(nearest[0], is_true)
        equation = opened("==", (left, right), BOOL)
        return found if self._is_true(equation, unknown, found) else None

    def _fitting(self, unknown: Unknown, value: Value) -> Value:
        """A value as one of the unknown's type; _ABSENT if it is none."""
        type_ = unknown.type
        if isinstance(type_, ObjectType):
            return value if self.knowledge.world.is_of(value, type_) else _ABSENT
        if is_integer(type_) and isinstance(value, float):
            if not math.isfinite(value) or value != int(value):
                return _ABSENT
            value = int(value)
        try:
            return converted(value, type_)
        except (ValueRangeError, OverflowError, TypeError):
            return _ABSENT

    def _assign(
        self, unknown: Unknown, value: Value, by: tuple[Requirement, ...], mask: int = 0
    ) -> None:
        old = self.values.get(unknown, _ABSENT)
        if old is not _ABSENT:
            if old != value:
                message = f"`{unknown.name}` would have two values"
                raise Clash((*by, *self.origins.get(unknown, ())), message, self)
            return
        fitting = self._fitting(unknown, value)
        if fitting is _ABSENT or fitting != value:
            message = f"`{unknown.name}` would be no `{unknown.type}`"
            raise Clash(by, message, self)
        self.values[unknown] = fitting
        self.origins[unknown] = by
        for requirement in by:
            mask |= self.mask(requirement)
        if mask:
            self.masks[unknown] = mask
        self._wake(unknown)

    def _wake(self, unknown: Unknown) -> None:
        """Look at what an unknown occurs in, where its value may decide something."""
        for requirement in self.occurrences.get(unknown, ()):
            left = self.pending.get(requirement)
            if left is None:
                continue
            self.pending[requirement] = left - 1
            if left <= 2 or requirement in self.structured:
                self._enqueue(requirement)
            elif requirement.pairings:
                self._see_whether_ready(requirement)

    # ---------------------------------------------------------------------------------- bounds

    def _bound(self, ground: Open, is_wanted: bool, by: Requirement) -> None:
        """Note where an integer lies."""
        operator = ground.operator if is_wanted else _OPPOSITE[ground.operator]
        left, right = map(meaning, ground.operands)
        if type(right) is Unknown:
            left, right, operator = right, left, _MIRRORED[operator]
        if type(left) is not Unknown or not is_integer(left.type) or not _is_finite(right):
            return
        old = self.bounds.get(left, Bounds())
        new = _narrowed(old, operator, right, by)
        if new is old:
            return
        self.bounds[left] = new
        if new.low is None or new.high is None or new.low < new.high:
            return
        if new.low > new.high:
            raise Clash(new.by, f"no number is left for `{left.name}`", self)
        self._assign(left, new.low, new.by)


class _With:
    """Values with one more."""

    __slots__ = ("above", "below")

    def __init__(self, below: Any, above: Mapping[Unknown, Value]) -> None:
        self.below = below
        self.above = above

    def get(self, unknown: Unknown, default: Any = None) -> Any:
        if unknown in self.above:
            return self.above[unknown]
        return self.below.get(unknown, default)


def _is_finite(ground: Ground) -> bool:
    return is_known(ground) and isinstance(ground, int | float) and math.isfinite(ground)


def _narrowed(old: Bounds, operator: str, value: float, by: Requirement) -> Bounds:
    if operator in ("<", "<="):
        high = math.floor(value)
        if operator == "<" and high == value:
            high -= 1
        return (
            old
            if old.high is not None and old.high <= high
            else replace(old, high=high, high_by=by)
        )
    low = math.ceil(value)
    if operator == ">" and low == value:
        low += 1
    return old if old.low is not None and old.low >= low else replace(old, low=low, low_by=by)
