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


# Subclasses say `repr=False`: a `__repr__` generated for each is a third of the time that importing
# them takes, and commands that end in a tenth of a second import them all.
@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Node:
    """What every node of a program carries: its place, which equality ignores."""

    location: Location | None = field(default=None, compare=False)

    def __repr__(self) -> str:
        shown = (f"{f.name}={getattr(self, f.name)!r}" for f in fields(self) if f.compare)
        return f"{type(self).__name__}({', '.join(shown)})"
