"""Maps that are never changed, and share what they have with the maps made from them."""

from collections.abc import Iterator, Mapping
from typing import Any, Final, Generic, TypeVar

K = TypeVar("K")
V = TypeVar("V")

GONE: Final[Any] = object()
"""As a change: the key has no value any more."""
_ABSENT: Final[Any] = object()
_SMALL: Final = 32


class Layered(Mapping[K, V], Generic[K, V]):
    """A map as changes above a larger one that others share.

    A changed map takes time in the square root of its size, over many changes.
    """

    __slots__ = ("_above", "_below", "_count")

    def __init__(self, below: dict[K, V] | None = None) -> None:
        self._below: dict[K, V] = {} if below is None else below
        self._above: dict[K, V] = {}
        self._count = len(self._below)

    @property
    def layers(self) -> tuple[dict[K, V], dict[K, V]]:
        """The changes, some of them GONE, and what they are above; to be read alone."""
        return self._above, self._below

    def changed(self, changes: Mapping[K, V]) -> "Layered[K, V]":
        """The map with other values for some keys, or none where a value is GONE."""
        if not changes:
            return self
        made: Layered[K, V] = Layered(self._below)
        made._above = {**self._above, **changes}
        made._count = self._count + self._grown(changes)
        if len(made._above) ** 2 > len(self._below) + _SMALL**2:
            made._below = {**self._below, **made._above}
            for key, value in made._above.items():
                if value is GONE:
                    made._below.pop(key)
            made._above = {}
        return made

    def _grown(self, changes: Mapping[K, V]) -> int:
        return sum((value is not GONE) - (key in self) for key, value in changes.items())

    def get(self, key: K, default: Any = None) -> Any:
        """The value of a key, or the default."""
        found = self._above.get(key, _ABSENT)
        if found is _ABSENT:
            return self._below.get(key, default)
        return default if found is GONE else found

    def __getitem__(self, key: K) -> V:
        found = self.get(key, _ABSENT)
        if found is _ABSENT:
            raise KeyError(key)
        return found  # type: ignore[no-any-return]

    def __contains__(self, key: object) -> bool:
        return self.get(key, _ABSENT) is not _ABSENT  # type: ignore[arg-type]

    def __len__(self) -> int:
        return self._count

    def __iter__(self) -> Iterator[K]:
        above = self._above
        for key in self._below:
            if key not in above:
                yield key
        for key, value in above.items():
            if value is not GONE:
                yield key

    def first(self) -> K | None:
        """The key that has been here longest, about; None if there is none."""
        return next(iter(self), None)


class Draft(Generic[K, V]):
    """Changes to a map while they are being made."""

    __slots__ = ("_above", "_below", "before", "changes")

    def __init__(self, before: Layered[K, V]) -> None:
        self.before = before
        self.changes: dict[K, V] = {}
        self._above, self._below = before.layers

    def get(self, key: K, default: Any = None) -> Any:
        """The value of a key, or the default."""
        # Propagation does this more than anything else: the map below is not asked to do it.
        found: Any = self.changes.get(key, _ABSENT)
        if found is _ABSENT:
            found = self._above.get(key, _ABSENT)
            if found is _ABSENT:
                return self._below.get(key, default)
        return default if found is GONE else found

    def __contains__(self, key: K) -> bool:
        return self.get(key, _ABSENT) is not _ABSENT

    def __setitem__(self, key: K, value: V) -> None:
        self.changes[key] = value

    def drop(self, key: K) -> None:
        """Take a key away, if it is there."""
        if key in self:
            self.changes[key] = GONE

    def made(self) -> Layered[K, V]:
        """The map with the changes."""
        return self.before.changed(self.changes)
