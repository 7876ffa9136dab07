"""One live line on a terminal while a search runs."""

import os
from time import monotonic
from typing import TYPE_CHECKING, Any, Self, TextIO

if TYPE_CHECKING:
    from rich.live import Live

_FIRST_SECONDS = 0.3
"""Shorter searches show nothing: rich takes a while to load."""


class Progress:
    """Shows statistics in a line that is written over; nothing where it is not wanted.

    A context manager: however it is left, the terminal is as it was.
    """

    def __init__(self, stream: TextIO, *, is_wanted: bool) -> None:
        self.stream = stream
        self.is_wanted = (
            is_wanted
            and stream.isatty()
            and not os.environ.get("NO_COLOR")
            and os.environ.get("TERM") != "dumb"
        )
        self.started = monotonic()
        self.statistics: dict[str, Any] = {}
        self.live: Live | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def show(self, statistics: dict[str, Any]) -> None:
        """Show figures from now on; the seconds go on by themselves."""
        self.statistics = statistics
        if self.live is None and monotonic() - self.started >= _FIRST_SECONDS:
            self._start()

    def stop(self) -> None:
        """Take the line away."""
        live, self.live = self.live, None
        if live is not None:
            live.stop()

    def _start(self) -> None:
        from rich.console import Console
        from rich.live import Live

        console = Console(file=self.stream)
        if console.is_terminal and not console.is_dumb_terminal:
            self.live = Live(
                get_renderable=self._line, console=console, transient=True, refresh_per_second=8,
                redirect_stdout=False, redirect_stderr=False,
            )  # fmt: skip
            self.live.start()

    def _line(self) -> Any:
        from rich.text import Text

        text = line_text(self.statistics, monotonic() - self.started)
        return Text(text, no_wrap=True, overflow="ellipsis")


def line_text(statistics: dict[str, Any], seconds: float) -> str:
    """`searching: 12,345 nodes, depth 4, 3 turns, 2.1 s`."""
    parts = [f"{statistics.get('nodes', 0):,} nodes"]
    if "depth" in statistics:
        parts.append(f"depth {statistics['depth']}")
    if "turn" in statistics:
        parts.append(f"turn {statistics['turn']}")
    return f"searching: {', '.join(parts)}, {seconds:.1f} s"
