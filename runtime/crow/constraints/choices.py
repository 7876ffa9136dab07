"""What a solver tries at one point: values of generators, of a finite domain, sides of an atom.

Each choice yields attempts, stores or the clash that keeps one from being made, and says why it is
not all there is, if it is not (App. B.1).
"""

from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Final, Literal

from crow.constraints.draws import Draws, Stream
from crow.constraints.pairing import Pairing
from crow.constraints.propagation import Clash, Marker, Propagation
from crow.constraints.python import Row
from crow.constraints.reduce import Reducer
from crow.constraints.store import Requirement, Store
from crow.constraints.terms import Ground, opened
from crow.program.types import BOOL
from crow.unknowns import Unknown
from crow.values import Value

_PLAIN: Final = (bool, int, float, str, tuple)


@dataclass(frozen=True, slots=True)
class Cut:
    """Why not everything was tried.

    `round`: more draws may follow in a later round; `limit`: the most draws of a call were made;
    `incomplete`: a generator ended that does not say that it is complete; `missing`: no generator
    can be asked for a value. `what` names the generator, or variable and constraint.
    """

    kind: Literal["round", "limit", "incomplete", "missing", "nodes"]
    what: str

    def __str__(self) -> str:
        return _CUTS[self.kind].format(self.what)


_CUTS: Final = {
    "round": "`{}` has more values",
    "limit": "`{}` was asked for as many values as it may be",
    "incomplete": "`{}` ended, and is not declared to be complete",
    "missing": "no generator can give a value to {}",
    "nodes": "{} nodes were looked at",
}


@dataclass(frozen=True, slots=True)
class Attempt:
    """What one choice leads to; `is_new` if no earlier round has made it."""

    outcome: Store | Clash
    is_new: bool = False


@dataclass(frozen=True, slots=True)
class Budget:
    """The draws of one call in this round, None for all there may be, and those of the last."""

    most: int | None = None
    before: int = 0


class Drawing(Iterator[Store]):
    """Values for an unknown from each generator for it, in turns: none is exhausted before another.

    `cuts` says, at the end, why there may be more.
    """

    def __init__(
        self,
        draws: Draws,
        store: Store,
        pairs: Iterable[tuple[Requirement, Pairing]],
        budget: Budget,
        mask: int = 0,
    ) -> None:
        self.draws = draws
        self.store = store
        self.budget = budget
        self.mask = mask
        self.cuts: set[Cut] = set()
        self._pairs = tuple(pairs)
        self._reducer = Reducer(store.knowledge, store.values)
        self._attempts = self.attempts()

    def attempts(self) -> Iterator[Attempt]:
        """What the values lead to."""
        turns = deque(self._of(*pair) for pair in self._pairs)
        while turns:
            turn = turns.popleft()
            attempt = next(turn, None)
            if attempt is not None:
                yield attempt
                turns.append(turn)

    def __iter__(self) -> "Drawing":
        return self

    def __next__(self) -> Store:
        """What the next value leads to that no constraint rejects."""
        for attempt in self._attempts:
            if isinstance(attempt.outcome, Store):
                return attempt.outcome
        raise StopIteration

    def _of(self, requirement: Requirement, pairing: Pairing) -> Iterator[Attempt]:
        inputs = tuple([self._reducer.refreshed(i) for i in pairing.inputs])
        outputs = tuple([self._reducer.refreshed(o) for o in pairing.outputs])
        cells = self.store.knowledge.resolved(pairing.cells, self.store.values)
        path = " ".join(f"{u.path}/{u.name}" for u in pairing.wanted)
        stream = self.draws.stream(pairing.generator.name, path, cells, inputs)
        name = pairing.generator.name
        is_batch = stream.python.is_batch
        rows = self._many(stream, name, outputs) if is_batch else self._single(stream, name)
        for row, source, is_new in rows:
            for value in row:
                self.draws.came_from(value, source)
            outcome = self._tried(requirement, outputs, row)
            if is_new and isinstance(outcome, Clash) and outcome.requirements:
                self.draws.rejected(name, outcome.requirements[0].source)
            yield Attempt(outcome, is_new)

    def _single(self, stream: Stream, name: str) -> Iterator[tuple[Row, str, bool]]:
        """The outputs of a generator of single values, each once."""
        most, index = self.budget.most, 0
        seen: set[Row] = set()
        while (row := stream.item(index)) is not None:
            if most is not None and index >= most:
                self.cuts.add(Cut("round", name))
                return
            if not all(isinstance(value, _PLAIN) for value in row) or row not in seen:
                seen.add(row)
                yield row, f"{stream.key}#{index}", index >= self.budget.before
            index += 1
        self._note_end(stream, name)

    def _many(
        self, stream: Stream, name: str, outputs: tuple[Ground, ...]
    ) -> Iterator[tuple[Row, str, bool]]:
        """The outputs of a generator of batches, without what constraints reject at once."""
        most, batch, tried = self.budget.most, 0, 0
        while (arrays := stream.item(batch)) is not None:
            if most is not None and batch >= most:
                self.cuts.add(Cut("round", name))
                return
            for index in self._surviving(name, outputs, arrays, batch >= self.budget.before):
                if most is not None and tried >= most:
                    self.cuts.add(Cut("round", name))
                    return
                row = stream.python.row(arrays, index)
                is_new = max(batch, tried) >= self.budget.before
                yield row, f"{stream.key}#{batch}.{index}", is_new
                tried += 1
            batch += 1
        self._note_end(stream, name)

    def _note_end(self, stream: Stream, name: str) -> None:
        if stream.is_limited:
            self.cuts.add(Cut("limit", name))
        elif not stream.python.is_complete:
            self.cuts.add(Cut("incomplete", name))

    def _tried(
        self, requirement: Requirement, outputs: tuple[Ground, ...], row: Row
    ) -> Store | Clash:
        run = Propagation(self.store)
        marker = Marker("draw", BOOL)
        try:
            for output, value in zip(outputs, row, strict=True):
                if type(output) is Unknown:
                    run.choose(output, value, self.mask)
                    continue
                if self.mask and marker not in run.values:
                    run.choose(marker, value=True, mask=self.mask)
                equation = opened("==", (output, value), BOOL)
                run.require(equation, requirement.source, (marker,))
            return run.finished()
        except Clash as clash:
            return clash

    def _surviving(
        self, name: str, outputs: tuple[Ground, ...], arrays: tuple[object, ...], is_new: bool
    ) -> Iterator[int]:
        """The rows of a batch that the constraints on them alone let pass."""
        from crow.constraints.batches import survivors

        columns = {o: a for o, a in zip(outputs, arrays, strict=True) if type(o) is Unknown}
        found = survivors(self.store, columns)
        for requirement, count in found.rejected.items() if is_new else ():
            self.draws.rejected(name, requirement.source, count)
        return iter(found.rows)


def values_tried(
    store: Store, unknown: Unknown, values: Iterable[Value], mask: int
) -> Iterator[Attempt]:
    """An unknown given each of some values."""
    for value in values:
        run = Propagation(store)
        try:
            run.choose(unknown, value, mask)
            yield Attempt(run.finished())
        except Clash as clash:
            yield Attempt(clash)


def sides_tried(
    store: Store, requirement: Requirement, split: tuple[Ground, Ground, bool], mask: int
) -> Iterator[Attempt]:
    """Both sides of an open requirement: what it is by now, an atom of that, and the first side."""
    ground, atom, is_first = split
    for is_wanted in (is_first, not is_first):
        run = Propagation(store)
        marker = Marker("case", BOOL)
        try:
            run.choose(marker, is_wanted, mask)
            run.decide(requirement, ground, (atom, is_wanted), marker)
            yield Attempt(run.finished())
        except Clash as clash:
            yield Attempt(clash)
