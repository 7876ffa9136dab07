"""One live line on a terminal while a search runs, or many."""

import os
from time import monotonic
from typing import TYPE_CHECKING, Any, Self, TextIO

if TYPE_CHECKING:
    import rich.progress
    from rich.live import Live

_FIRST_SECONDS = 0.3
"""Shorter searches show nothing: rich takes a while to load."""


class Progress:
    """Shows statistics in a line that is written over; nothing where it is not wanted.

    A context manager: however it is left, the terminal is as it was.
    """

    def __init__(self, stream: TextIO, *, is_wanted: bool) -> None:
        self.stream = stream
        self.is_wanted = is_wanted and is_live(stream)
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


class Bar:
    """A bar of how many runs are done, on a terminal; nothing elsewhere.

    A context manager: however it is left, the terminal is as it was.
    """

    def __init__(self, stream: TextIO, total: int) -> None:
        self.stream = stream
        self.total = total
        self.live: rich.progress.Progress | None = None

    def __enter__(self) -> Self:
        if is_live(self.stream):
            self._start()
        return self

    def __exit__(self, *_: object) -> None:
        if self.live is not None:
            self.live.stop()

    def show(self, done: int, told: str) -> None:
        """Show how many are done, and what is told of them."""
        if self.live is not None:
            self.live.update(self.live.task_ids[0], completed=done, told=told)

    def _start(self) -> None:
        from rich.console import Console
        from rich.progress import (
            BarColumn,
            MofNCompleteColumn,
            Progress,
            TextColumn,
            TimeElapsedColumn,
            TimeRemainingColumn,
        )

        self.live = Progress(
            BarColumn(20), MofNCompleteColumn(), TimeElapsedColumn(), TimeRemainingColumn(),
            TextColumn("{task.fields[told]}", markup=False),
            console=Console(file=self.stream), transient=True, refresh_per_second=8,
            redirect_stdout=False, redirect_stderr=False,
        )  # fmt: skip
        self.live.add_task("", total=self.total, told="")
        self.live.start()


def is_live(stream: TextIO) -> bool:
    """Whether what is written to a stream may be written over."""
    is_wanted = not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"
    return stream.isatty() and is_wanted
