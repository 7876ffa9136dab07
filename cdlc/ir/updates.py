"""What effects do: writes over the state before, in layers."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from crow.program import Expression, Location


class NotModelled(Exception):  # noqa: N818 - not an error of the program
    """A construct that has no Hoare model, with its place."""

    def __init__(self, construct: str, location: Location | None) -> None:
        super().__init__(construct)
        self.construct = construct
        self.location = location


@dataclass(frozen=True, slots=True, eq=False)
class Update:
    """`feature[arguments] := value` where `guard` holds, for all `variables`.

    Everything reads the state before. `variables` are fresh ones of the pool.
    """

    feature: str
    arguments: tuple[Expression, ...]
    value: Expression
    guard: Expression
    variables: tuple[Expression, ...] = ()
    location: Location | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Conflict:
    """Two iterations of a `foreach` that may write one cell: when, and where both stand.

    `condition` is over the state before and over the variables of both iterations, `variables`;
    where it holds, the values differ.
    """

    condition: Expression
    variables: tuple[Expression, ...]
    first: Update
    second: Update


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
