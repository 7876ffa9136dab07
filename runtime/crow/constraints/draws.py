"""Values drawn from generators: they depend on what they are for, not on when they are drawn.

A stream is keyed by seed, generator, refinement path, inputs, and the cells that its Python reads
(semantics.md §4). What was drawn is remembered, so that a later round goes on where one ended.
"""

import hashlib
import pickle
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

from crow.calls import part_read
from crow.constraints.constraint import Constraint
from crow.constraints.python import Cells, PythonGenerator, Row
from crow.problem import Cell, State, World
from crow.values import Opaque, Value

if TYPE_CHECKING:
    from crow.constraints.python import Python

DEFAULT_LIMIT: Final = 1_000
_ADDRESS: Final = re.compile(r" at 0x[0-9a-fA-F]+")


@dataclass(slots=True)
class Tally:
    """What became of the draws of one generator; `rejected` counts values by constraint."""

    calls: int = 0
    yielded: int = 0
    ended: int = 0
    limited: int = 0
    rejected: Counter[str] = field(default_factory=Counter)

    def json(self) -> dict[str, Any]:
        """The figures, for the statistics of a search."""
        counts = {"calls": self.calls, "yielded": self.yielded}
        return {**counts, "ended": self.ended, "limited": self.limited,
                "rejected": dict(self.rejected)}  # fmt: skip


class Stream:
    """The values of one call of a generator, drawn as far as they were asked for.

    An item is a tuple of outputs; of a batch, a tuple of arrays.
    """

    def __init__(
        self, python: PythonGenerator, values: Iterator[Any], limit: int, tally: Tally, key: str
    ) -> None:
        self.python = python
        self.limit = limit
        self.key = key
        self.is_ended = False
        self.is_limited = False
        self._values = values
        self._tally = tally
        self._drawn: list[tuple[Any, ...]] = []
        self._count = 0

    def item(self, index: int) -> Any:
        """The item drawn as that one; None if there is none, or the limit is reached.

        Raises crow.FunctionError for Python that fails.
        """
        while len(self._drawn) <= index:
            if self.is_ended or not self._draw():
                return None
        return self._drawn[index]

    def _draw(self) -> bool:
        if self._count >= self.limit:
            if not self.is_limited:
                self.is_limited = True
                self._tally.limited += 1
            return False
        item: Any = next(self._values, None)
        if item is None:
            self.is_ended = True
            self._tally.ended += 1
            return False
        count = len(item[0]) if self.python.is_batch else 1
        if self._count + count > self.limit:
            count = self.limit - self._count
            item = tuple([array[:count] for array in item])
        self._count += count
        self._tally.yielded += count
        self._drawn.append(item)
        return True


class Draws:
    """The random values of one search; `limit` is the most of a call, a generator may say less."""

    def __init__(
        self,
        world: World,
        seed: int = 0,
        limit: int | None = None,
        python: "Python | None" = None,
    ) -> None:
        self.world = world
        self.seed = seed
        self.limit = DEFAULT_LIMIT if limit is None else limit
        self.tallies: dict[str, Tally] = {}
        self._python: Any = world.externals if python is None else python
        self._parts: dict[frozenset[tuple[Cell, object]], str] = {}
        self._streams: dict[str, Stream] = {}
        self._sources: dict[int, tuple[object, str]] = {}

    def stream(self, generator: str, path: str, cells: Cells, inputs: Row) -> Stream:
        """The values of a generator for some inputs, in the cells of a state, at a place."""
        python: PythonGenerator = self._python.generators[generator]
        key = self._key(python, generator, path, cells, inputs)
        found = self._streams.get(key)
        if found is None:
            tally = self.tallies.setdefault(generator, Tally())
            tally.calls += 1
            draw = python.arrays if python.is_batch else python.draw
            values = draw(State(cells), inputs, _random(key))
            limit = self.limit if python.limit is None else min(python.limit, self.limit)
            found = self._streams[key] = Stream(python, values, limit, tally, key)
        return found

    def came_from(self, value: Value, source: str) -> None:
        """Note where an opaque value came from: it is what it is known by in other processes."""
        if isinstance(value, tuple):
            for index, element in enumerate(value):
                self.came_from(element, f"{source}.{index}")
        elif not isinstance(value, bool | int | float | str):
            self._sources.setdefault(id(value), (value, source))

    def rejected(self, generator: str, constraint: Constraint, count: int = 1) -> None:
        """Count values that a constraint did not let pass."""
        self.tallies.setdefault(generator, Tally()).rejected[str(constraint)] += count

    def statistics(self) -> dict[str, Any]:
        """The figures of each generator."""
        return {name: tally.json() for name, tally in sorted(self.tallies.items())}

    def _key(
        self, python: PythonGenerator, generator: str, path: str, cells: Cells, inputs: Row
    ) -> str:
        told = [str(self.seed), generator, path, self.told(inputs)]
        if python.reads:
            told.append(self._told_part(part_read(cells, python.reads)))
        return hashlib.blake2b("\n".join(told).encode(), digest_size=16).hexdigest()

    def _told_part(self, part: frozenset[tuple[Cell, object]]) -> str:
        """Cells as text that is the same in each process."""
        found = self._parts.get(part)
        if found is None:
            own = sorted(part, key=lambda item: item[0])
            found = "\n".join(f"{cell!r} {self.told(value)}" for cell, value in own)
            self._parts[part] = found
        return found

    def told(self, value: Value) -> str:
        """A value as text that is the same in each process."""
        if isinstance(value, tuple):
            return f"({', '.join(map(self.told, value))},)"
        if value is None or isinstance(value, bool | int | float | str):
            return repr(value)
        known = self._sources.get(id(value))
        if known is not None:
            return f"<{known[1]}>"
        return _opaque_text(value.value if isinstance(value, Opaque) else value)


def _opaque_text(value: object) -> str:
    """An opaque value that no generator gave: what it prints as, or what it is made of."""
    text = repr(value)
    if _ADDRESS.search(text) is None:
        return text
    try:
        return hashlib.blake2b(pickle.dumps(value), digest_size=16).hexdigest()
    except Exception:  # noqa: BLE001 - whatever an object does that cannot be pickled
        return _ADDRESS.sub("", text)


def _random(key: str) -> Any:
    import numpy as np

    return np.random.Generator(np.random.PCG64(int(key, 16)))
