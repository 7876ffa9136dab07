"""Where in the source text a piece of a program stands."""

from dataclasses import dataclass, field, fields
from functools import total_ordering


@total_ordering
@dataclass(frozen=True, slots=True)
class Location:
    """A stretch of a file; lines and columns count from 1 and the end column is exclusive."""

    file: str
    line: int
    column: int
    end_line: int
    end_column: int

    def __lt__(self, other: "Location") -> bool:
        return self._key() < other._key()

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"

    def _key(self) -> tuple[str, int, int, int, int]:
        return (self.file, self.line, self.column, self.end_line, self.end_column)


_compared: dict[type, tuple[str, ...]] = {}


def _compared_fields(node: "Node") -> tuple[str, ...]:
    cls = type(node)
    if cls not in _compared:
        _compared[cls] = tuple(f.name for f in fields(node) if f.compare)
    return _compared[cls]


# Subclasses say `repr=False`, and `eq=False` unless they are compared often: dataclass compiles
# each such method for each class, which was half the start-up time of `cdlc check`.
@dataclass(frozen=True, slots=True, kw_only=True, repr=False, eq=False)
class Node:
    """What every node of a program carries: its place, which equality ignores."""

    location: Location | None = field(default=None, compare=False)

    def __repr__(self) -> str:
        shown = (f"{name}={getattr(self, name)!r}" for name in _compared_fields(self))
        return f"{type(self).__name__}({', '.join(shown)})"

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and all(
            getattr(self, name) == getattr(other, name) for name in _compared_fields(self)
        )

    def __hash__(self) -> int:
        return hash((type(self), *(getattr(self, name) for name in _compared_fields(self))))
