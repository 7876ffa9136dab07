"""A bar on a terminal: how many problems are done, and what is being done now."""

import os
from typing import TextIO

from cdlc.render import terminal_width

_CELLS = 20
_WIDEST = 100
_CLEAR = "\r\033[K"


class Progress:
    """One line that is written over; nothing where it is not wanted."""

    def __init__(self, stream: TextIO, total: int, *, is_wanted: bool) -> None:
        self.stream = stream
        self.total = total
        self.is_shown = is_wanted and stream.isatty() and not os.environ.get("NO_COLOR")
        self.done = 0

    def show(self, file: str, stage: str) -> None:
        """Say what is being done with a problem."""
        if self.is_shown:
            cells = _CELLS * self.done // max(1, self.total)
            bar = "#" * cells + "." * (_CELLS - cells)
            line = f"[{bar}] {self.done}/{self.total} {file}: {stage}"
            # A line that wraps could not be written over.
            width = min(_WIDEST, terminal_width(self.stream)) - 1
            self.stream.write(_CLEAR + line[:width])
            self.stream.flush()

    def advance(self) -> None:
        """One more problem is done."""
        self.done += 1

    def clear(self) -> None:
        """Leave the line as it was."""
        if self.is_shown:
            self.stream.write(_CLEAR)
            self.stream.flush()
