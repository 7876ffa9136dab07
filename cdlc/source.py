"""Source files and stretches of them."""

from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from crow.program import Location


class Span(NamedTuple):
    """Characters `start` to `end` (exclusive) of a source file."""

    start: int
    end: int


@dataclass(frozen=True)
class SourceFile:
    """A text with the name that diagnostics show for it."""

    name: str
    text: str

    @cached_property
    def line_starts(self) -> tuple[int, ...]:
        """The offset at which each line starts; lines end at a line feed."""
        starts = [0]
        position = self.text.find("\n")
        while position >= 0:
            starts.append(position + 1)
            position = self.text.find("\n", position + 1)
        return tuple(starts)

    def position(self, offset: int) -> tuple[int, int]:
        """Line and column, from 1, of an offset into the text."""
        line = bisect_right(self.line_starts, offset)
        return line, offset - self.line_starts[line - 1] + 1

    def location(self, span: Span) -> Location:
        """A span in lines and columns."""
        start, end = span
        starts = self.line_starts
        line = bisect_right(starts, start)
        offset = starts[line - 1] - 1
        if line == len(starts) or end < starts[line]:  # nearly all stand on one line
            return Location(self.name, line, start - offset, line, max(start, end) - offset)
        end_line, end_column = self.position(end)
        return Location(self.name, line, start - offset, end_line, end_column)

    def line(self, number: int) -> str:
        """The text of a line, counted from 1, without its end; empty past the last."""
        if number > len(self.line_starts):
            return ""
        start = self.line_starts[number - 1]
        end = self.text.find("\n", start)
        return self.text[start : None if end < 0 else end].rstrip("\r")
