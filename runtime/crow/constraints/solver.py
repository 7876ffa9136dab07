"""The solver of App. B.1: propagate, branch on what is finite, draw what is not, and backtrack.

It is iterative, and jumps back over choices that a failure does not rest on. Rounds allow 1, 2, 4
and so on draws a generator call, so that no generator is drawn from for ever below a useless value
of another; what was drawn is remembered between rounds.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import chain
from typing import TYPE_CHECKING, Final

from crow.budget import look
from crow.constraints.choices import (
    Attempt,
    Budget,
    Cut,
    Drawing,
    sides_tried,
    values_tried,
)
from crow.constraints.constraint import Conflict, Constraint
from crow.constraints.draws import Draws
from crow.constraints.layered import Layered
from crow.constraints.pairing import Pairing
from crow.constraints.propagation import Propagation
from crow.constraints.reduce import Reducer
from crow.constraints.store import Requirement, Store, is_discrete
from crow.constraints.terms import Ground, Open, is_known
from crow.program import ObjectType, VectorType
from crow.program.types import is_number, underlying
from crow.unknowns import Unknown
from crow.values import default_value

if TYPE_CHECKING:
    from crow.problem import World
    from crow.values import Value

_EVERYTHING: Final = -1
"""The mask of a failure that may rest on any choice."""


class Solver:
    """Solves the constraints of stores of one world with the values of `draws`."""

    def __init__(self, world: "World", draws: Draws) -> None:
        self.world = world
        self.source = draws

    def draws(self, store: Store, unknown: Unknown, most: int | None = None) -> Drawing | None:
        """What generators give an unknown: an iterator of stores, those that nothing rejects.

        None if no generator with known inputs applies. `most` are the draws of each call.
        Iterating raises crow.FunctionError for Python that fails.
        """
        pairs = _pairs(store, unknown)
        return Drawing(self.source, store, pairs, Budget(most)) if pairs else None

    def solutions(
        self, store: Store, most: int | None = None, node_limit: int | None = None
    ) -> "Solutions":
        """The solutions of a store, each once: an iterator of stores in which nothing is open.

        What a solution leaves open has false, 0, or the first object as its value; an opaque value
        that is not needed has none. With `most`, one round with as many draws of each call; else
        rounds with 1, 2, 4, … until no call has more values, or may be asked for more.
        """
        return Solutions(self, store, most, node_limit)


class Solutions(Iterator[Store]):
    """Solutions as they are asked for.

    Once there are no more, `cuts` says why others might exist all the same: none, and it is proved
    that there are no others (`is_proved`). `nodes` counts the attempts of all rounds.
    """

    def __init__(
        self, solver: Solver, store: Store, most: int | None, node_limit: int | None
    ) -> None:
        self.solver = solver
        self.store = store
        self.cuts: frozenset[Cut] = frozenset()
        self.nodes = 0
        self.found = 0
        self.node_limit = node_limit
        self._solutions = self._rounds(most)

    def __iter__(self) -> "Solutions":
        return self

    def __next__(self) -> Store:
        solution = next(self._solutions)
        self.found += 1
        return _filled(solution)

    @property
    def is_proved(self) -> bool:
        """Whether, at its end, everything was tried."""
        return not self.cuts

    def core(self) -> Conflict:
        """The constraints that have no solution together: few of them, if that is proved.

        To be asked at the end, when none was found.
        """
        from crow.constraints.core import unsolvable_core

        return unsolvable_core(self)

    def _rounds(self, most: int | None) -> Iterator[Store]:
        budget = Budget(1 if most is None else most)
        is_first = True
        while True:
            search = _Search(self, budget, is_first)
            yield from search.run()
            self.cuts = frozenset(search.cuts)
            kinds = {cut.kind for cut in self.cuts}
            if most is not None or "round" not in kinds or "nodes" in kinds:
                return
            assert budget.most is not None
            budget, is_first = Budget(2 * budget.most, budget.most), False


@dataclass(slots=True, eq=False)
class _Frame:
    """A choice on the way: `mask` are earlier choices that its failures so far rest on."""

    attempts: Iterator[Attempt]
    bit: int
    mask: int = 0
    drawing: Drawing | None = None
    is_new: bool = False


class _Search:
    """One round: depth first over choices, none deeper than what is asked."""

    def __init__(self, solutions: Solutions, budget: Budget, is_first: bool) -> None:
        self.solutions = solutions
        self.budget = budget
        self.is_first = is_first
        self.cuts: set[Cut] = set()
        self.stack: list[_Frame] = []

    def run(self) -> Iterator[Store]:
        """The solutions of the round that are new in it."""
        store = _without_masks(self.solutions.store)
        if not store.pending:
            if self.is_first:
                yield self.solutions.store
            return
        self._enter(store, self.is_first)
        while self.stack:
            frame = self.stack[-1]
            attempt = next(frame.attempts, None)
            if attempt is None:
                self._leave()
                continue
            if self._is_over():
                return
            outcome = attempt.outcome
            if not isinstance(outcome, Store):
                self._blame(outcome.mask)
            elif outcome.pending:
                self._enter(outcome, frame.is_new or attempt.is_new)
            else:
                for above in self.stack:
                    above.mask = _EVERYTHING
                if frame.is_new or attempt.is_new:
                    yield outcome

    def _is_over(self) -> bool:
        look()
        self.solutions.nodes += 1
        limit = self.solutions.node_limit
        if limit is not None and self.solutions.nodes > limit:
            self.cuts.add(Cut("nodes", f"{limit:,}"))
            return True
        return False

    def _leave(self) -> None:
        """Go back from a choice whose attempts are used up, past those that are not to blame."""
        self._blame(self._popped().mask)

    def _blame(self, mask: int) -> None:
        """Go back to the last choice that a failure rests on."""
        while self.stack:
            frame = self.stack[-1]
            if mask & frame.bit:
                frame.mask |= mask & ~frame.bit
                return
            self._popped()

    def _popped(self) -> _Frame:
        frame = self.stack.pop()
        if frame.drawing is not None:
            self.cuts |= frame.drawing.cuts
        return frame

    # --------------------------------------------------------------------------------- choosing

    def _enter(self, store: Store, is_new: bool) -> None:
        """Choose what to try next: what is finite, what can be drawn, then sides of an atom."""
        bit = 1 << len(self.stack)
        frame = (
            self._discrete(store, bit)
            or self._drawn(store, bit)
            or self._split(store, bit)
            or self._finite(store, bit)
        )
        if frame is None:
            self.cuts.add(_missing(store))
            frame = _Frame(iter(()), bit, _EVERYTHING)
        frame.is_new = is_new
        self.stack.append(frame)

    def _discrete(self, store: Store, bit: int) -> _Frame | None:
        """A truth value or object in a requirement on such alone, the smallest first."""
        if not store.discrete:
            return None
        requirement = min(store.discrete, key=lambda r: (store.pending[r], r.number))
        ground = Reducer(store.knowledge, store.values).refreshed(requirement.term)
        atom, is_wanted = _leftmost(ground, requirement.is_wanted)
        if type(atom) is Unknown and is_wanted is not None:
            values: tuple[Value, ...] = (is_wanted, not is_wanted)
            return _Frame(values_tried(store, atom, values, bit), bit)
        unknown = next(u for u in requirement.unknowns if u not in store.values)
        return self._values_of(store, unknown, bit)

    def _values_of(self, store: Store, unknown: Unknown, bit: int) -> _Frame:
        """Each value of a finite domain."""
        mask = 0
        values: range | tuple[Value, ...] = (True, False)
        bounds = store.bounds.get(unknown)
        if isinstance(unknown.type, ObjectType):
            values = store.knowledge.world.objects_of(unknown.type)
        elif bounds is not None:
            values = range(bounds.low, bounds.high + 1)
            run = Propagation(store)
            for requirement in bounds.by:
                mask |= run.mask(requirement)
        return _Frame(values_tried(store, unknown, values, bit), bit, mask)

    def _drawn(self, store: Store, bit: int) -> _Frame | None:
        """Values for the first unknown that a generator can be asked for."""
        requirement = store.ready.first()
        if requirement is None:
            return None
        run = Propagation(store)
        pairing = next(filter(run.is_ready, requirement.pairings))
        unknown = next(u for u in pairing.wanted if u not in store.values)
        pairs = _pairs(store, unknown)
        drawing = Drawing(self.solutions.solver.source, store, pairs, self.budget, bit)
        mask = 0
        for by, own in pairs:
            mask |= run.mask(by)
            for read in own.read:
                mask |= store.masks.get(read, 0)
        if not _are_all(store, unknown, pairs):
            mask = _EVERYTHING
        return _Frame(drawing.attempts(), bit, mask, drawing)

    def _split(self, store: Store, bit: int) -> _Frame | None:
        """Both sides of an atom in a condition that is open."""
        reducer = Reducer(store.knowledge, store.values)
        for requirement in store.structured:
            ground = reducer.refreshed(requirement.term)
            atom, is_wanted = _leftmost(ground, requirement.is_wanted)
            if is_wanted is not None:
                return _Frame(sides_tried(store, requirement, (ground, atom, is_wanted), bit), bit)
        return None

    def _finite(self, store: Store, bit: int) -> _Frame | None:
        """Each value of what has few, among what nothing else gives a value to."""
        for unknown in chain.from_iterable(r.unknowns for r in store.pending):
            if unknown in store.values:
                continue
            bounds = store.bounds.get(unknown)
            is_bounded = bounds is not None and None not in (bounds.low, bounds.high)
            if is_bounded or is_discrete(unknown):
                return self._values_of(store, unknown, bit)
        return None


def _filled(store: Store) -> Store:
    """A solution with some value for what it leaves open, where the type tells one."""
    free = [u for u in store.mentioned if u not in store.values]
    if not free:
        return store
    run = Propagation(store)
    for unknown in free:
        value = _any_value(store, unknown)
        if value is not None:
            run.choose(unknown, value)
    return run.finished()


def _any_value(store: Store, unknown: Unknown) -> "Value | None":
    if isinstance(unknown.type, ObjectType):
        return next(iter(store.knowledge.world.objects_of(unknown.type)), None)
    match underlying(unknown.type):
        case VectorType(element=element, length=int(length)) if is_number(element):
            return (default_value(element),) * length
        case plain:
            return default_value(plain)


def _without_masks(store: Store) -> Store:
    """A store all of whose values count as given."""
    if not store.masks:
        return store
    return replace(store, masks=Layered())


def _pairs(store: Store, unknown: Unknown) -> list[tuple[Requirement, Pairing]]:
    """The generators that can be asked for an unknown, with what they are asked for."""
    is_ready = Propagation(store).is_ready
    return [
        (requirement, pairing)
        for requirement in store.occurrences.get(unknown, ())
        if requirement in store.ready
        for pairing in requirement.pairings
        if unknown in pairing.wanted and is_ready(pairing)
    ]


def _are_all(store: Store, unknown: Unknown, pairs: list[tuple[Requirement, Pairing]]) -> bool:
    """Whether no other value of anything could make another generator one for an unknown."""
    own = {pairing for _, pairing in pairs}
    for requirement in store.occurrences.get(unknown, ()):
        if requirement not in store.pending:
            continue
        others = (p for p in requirement.pairings if unknown in p.wanted and p not in own)
        if requirement in store.structured or any(others):
            return False
    return True


def _leftmost(ground: Ground, is_wanted: bool) -> tuple[Ground, bool | None]:
    """The first atom that would decide a condition, and what it should be; None for no atom."""
    while type(ground) is Open:
        match ground.operator:
            case "not":
                ground, is_wanted = ground.operands[0], not is_wanted
            case "and" | "or":
                ground = ground.operands[0]
            case "xor" | "if":
                ground, is_wanted = ground.operands[0], True
            case "==" | "!=" if any(_is_vector(o) for o in ground.operands):
                return ground, None
            case _:
                return ground, is_wanted
    return (ground, None) if is_known(ground) else (ground, is_wanted)


def _is_vector(ground: Ground) -> bool:
    return type(ground) is Open and ground.operator == "vector"


def _missing(store: Store) -> Cut:
    """What no generator gives a value to."""
    requirement = min(store.pending, key=lambda r: r.number)
    unknowns = [u for u in requirement.unknowns if u not in store.values]
    names = ", ".join(f"`{u.name}`" for u in unknowns) or "what is open"
    return Cut("missing", f"{names} in {requirement.source}")


def solved_without(
    solutions: Solutions, constraint: Constraint, kept: tuple[Constraint, ...], nodes: int
) -> bool | None:
    """Whether constraints have a solution without one of them; None if that is not found out."""
    store = Store(solutions.store.knowledge).having(*(c for c in kept if c is not constraint))
    if not isinstance(store, Store):
        return False
    again = solutions.solver.solutions(store, node_limit=nodes)
    if next(again, None) is not None:
        return True
    return False if again.is_proved else None
