"""What the uses of untyped parameters demand of their types, and the types that result."""

from dataclasses import dataclass, field

from cdlc.frontend import syntax
from cdlc.frontend.scope import (
    Declarations,
)
from crow.program import INT64, UNKNOWN, Type, UnknownType
from crow.program.types import (
    FLOAT32,
    INT32,
    NamedType,
    VectorType,
)


@dataclass(frozen=True, slots=True)
class Slot:
    """An untyped parameter: a definition and the position in its list."""

    owner: str
    index: int


@dataclass(frozen=True, slots=True)
class Hint:
    """What a literal suggests; it decides only where nothing else does."""

    type: Type


Known = Slot | Hint | Type | None
"""What is known of an expression: its type, that it is a parameter to infer, or nothing."""

Names = dict[str, Known]


@dataclass(slots=True)
class Demands:
    """What the uses of each untyped parameter want it to be."""

    declared: Declarations
    slots: set[Slot] = field(default_factory=set)
    wanted: dict[Slot, dict[Type, None]] = field(default_factory=dict)
    hinted: dict[Slot, dict[Type, None]] = field(default_factory=dict)
    flows: dict[Slot, dict[Slot, None]] = field(default_factory=dict)
    broken: set[str] = field(default_factory=set)

    def open(self, node: syntax.Procedure) -> None:
        """Make a slot for every untyped parameter of a definition."""
        for index, parameter in enumerate(node.parameters):
            if parameter.type is None:
                self.slots.add(Slot(node.name.text, index))

    def add(self, slot: Slot, known: Known) -> None:
        """Note that a parameter stands where something is wanted."""
        match known:
            case None:
                return
            case Slot():
                self.flows.setdefault(slot, {})[known] = None
            case Hint(type=type_):
                self.hinted.setdefault(slot, {})[type_] = None
            case _:
                self.wanted.setdefault(slot, {})[known] = None

    def close(self) -> None:
        """Pass the demands on parameters on to what callers pass for them, until none is new."""
        changed = True
        while changed:
            changed = False
            for slot, sources in self.flows.items():
                for source in sources:
                    for table in (self.wanted, self.hinted):
                        before = len(table.get(slot, {}))
                        table.setdefault(slot, {}).update(table.get(source, {}))
                        changed = changed or len(table[slot]) > before

    def resolve(self, slot: Slot) -> tuple[Type | None, tuple[str, ...]]:
        """The type of a parameter; None when undecided, with the types that contradict."""
        wanted = tuple(self.wanted.get(slot, {}))
        if any(isinstance(t, UnknownType) for t in wanted):
            return UNKNOWN, ()
        if not wanted:
            hints = sorted(self.hinted.get(slot, {}), key=str)
            return (hints[0] if hints else None), ()  # float64 before int64
        fits = self.declared.fits
        fitting = [t for t in wanted if all(fits(t, other) for other in wanted)]
        if not fitting:
            return None, tuple(str(t) for t in wanted)
        return max(fitting, key=_specificity), ()


def _specificity(type_: Type) -> tuple[int, int, int]:
    """Among types that convert into each other: typedefs, narrow numbers, vectors of a length."""
    depth, base = 0, type_
    while isinstance(base, NamedType):
        depth, base = depth + 1, base.base
    narrow = (FLOAT32, INT64, INT32).index(base) + 1 if base in (FLOAT32, INT64, INT32) else 0
    known_length = isinstance(base, VectorType) and base.length is not None
    return depth, narrow, int(known_length)
