"""What effects do: writes over the state before, in layers."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from crow.program import Location
from crow.program.triples import Update

# More than these statements behind one formula are not told apart.
MAX_SOURCES = 16


class NotModelled(Exception):  # noqa: N818 - not an error of the program
    """A construct that has no Hoare model, with its place."""

    def __init__(self, construct: str, location: Location | None) -> None:
        super().__init__(construct)
        self.construct = construct
        self.location = location


Cell = tuple[str, tuple[int, ...], int]
"""A feature with the identities of its arguments; the number tells quantified writes apart."""


@dataclass(frozen=True, slots=True, eq=False)
class Layer:
    """Writes over what is under them: the state before, or the state around a `foreach`."""

    under: "Layer | None" = None
    writes: Mapping[Cell, Update] = field(default_factory=dict)

    def all_writes(self) -> Iterator[Update]:
        """Every write from the state before on, in order."""
        if self.under is not None:
            yield from self.under.all_writes()
        yield from self.writes.values()


def cell_of(write: Update, number: int) -> Cell:
    """What a write is known by in its layer."""
    return (write.feature, tuple(map(id, write.arguments)), number)


def written(layer: Layer, write: Update, number: int = 0) -> Layer:
    """The layer with a write after all others; one of the same cell is gone."""
    cell = cell_of(write, number)
    others = {c: w for c, w in layer.writes.items() if c != cell}
    return Layer(layer.under, {**others, cell: write})


def merged(*sources: tuple[Location, ...]) -> tuple[Location, ...]:
    """Places in source order, each once; of very many one more than MAX_SOURCES."""
    if not sources:
        return ()
    first, *rest = sources
    if all(other == first or not other for other in rest):
        return first
    together = sorted({place for places in sources for place in places})
    return tuple(together[: MAX_SOURCES + 1])
