"""Diagnostics as text for people and as JSON for programs; both show the same object."""

import os
import shutil
import sys
import unicodedata
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, TextIO

from cdlc.diagnostics import Diagnostic, Help, Label, Severity
from cdlc.source import SourceFile
from crow.program import Location

_STYLES = {
    "error": "\x1b[1;31m",
    "warning": "\x1b[1;33m",
    "place": "\x1b[1;34m",
    "help": "\x1b[1;32m",
    "bold": "\x1b[1m",
}
_RESET = "\x1b[0m"
# Longer lines are shown around the place only.
WIDTH = 160
_TAB = " " * 4
# Longer messages name something generated.
_LONGEST = 300


def wants_color(stream: TextIO) -> bool:
    """Whether to color what goes to a stream: on a terminal, unless NO_COLOR is set."""
    return stream.isatty() and not os.environ.get("NO_COLOR") and sys.platform != "win32"


def terminal_width(stream: TextIO) -> int:
    """How wide lines may be on a stream: as the terminal, if it is one."""
    if not stream.isatty():
        return WIDTH
    return max(40, shutil.get_terminal_size((WIDTH, 24)).columns)


def as_text(
    diagnostics: Iterable[Diagnostic],
    sources: Mapping[str, SourceFile],
    *,
    color: bool = False,
    width: int = WIDTH,
) -> str:
    """Diagnostics with source lines and carets, a blank line between two of them."""
    painter = _Painter(sources, color, width)
    return "\n".join(painter.render(diagnostic) for diagnostic in diagnostics)


def excerpts(
    places: Iterable[Location],
    sources: Mapping[str, SourceFile],
    *,
    color: bool = False,
    width: int = WIDTH,
) -> list[str]:
    """Lines that show places in their sources, marked as in diagnostics, in the order given."""
    painter = _Painter(sources, color, width)
    shown = list(places)
    margin = max((len(str(place.line)) for place in shown), default=0)
    lines: list[str] = []
    before = None
    for place in shown:
        lines += painter.excerpt(Label(place, ""), before, margin, "^", "place")
        before = place
    return lines


def as_json(diagnostics: Iterable[Diagnostic]) -> dict[str, Any]:
    """The `check --format json` document (schemas/check.json)."""
    return {"version": 1, "diagnostics": [_diagnostic(d) for d in diagnostics]}


def _diagnostic(diagnostic: Diagnostic) -> dict[str, Any]:
    primary = diagnostic.label()
    labels = [Label(diagnostic.location, primary)] if primary else []
    return {
        "code": diagnostic.code,
        "severity": str(diagnostic.severity),
        "message": diagnostic.message(),
        "file": diagnostic.location.file,
        "span": span_json(diagnostic.location),
        "labels": [
            {"file": label.location.file, "span": span_json(label.location), "text": label.text}
            for label in (*labels, *diagnostic.labels())
        ],
        "notes": list(diagnostic.notes()),
        "help": [_help(h) for h in diagnostic.help()],
    }


def span_json(location: Location) -> dict[str, Any]:
    """A place as start and end, lines and columns from 1."""
    return {
        "start": {"line": location.line, "column": location.column},
        "end": {"line": location.end_line, "column": location.end_column},
    }


def _help(help_: Help) -> dict[str, Any]:
    if help_.replacement is None:
        return {"text": help_.text}
    replacement = help_.replacement
    span = span_json(replacement.location)
    return {"text": help_.text, "replacement": {"span": span, "text": replacement.text}}


class _Painter:
    def __init__(self, sources: Mapping[str, SourceFile], color: bool, width: int) -> None:
        self.sources = sources
        self.color = color
        self.width = width

    def render(self, diagnostic: Diagnostic) -> str:
        severity = str(diagnostic.severity)
        head = self._paint(f"{severity}[{diagnostic.code}]", severity)
        message = self._paint(f": {printable(diagnostic.message())}", "bold")
        lines = [f"{head}{message}"]
        primary = Label(diagnostic.location, diagnostic.label())
        others = sorted(diagnostic.labels(), key=lambda label: label.location)
        margin = max(len(str(label.location.line)) for label in (primary, *others))
        lines += self.excerpt(primary, None, margin, "^", severity)
        before = primary.location
        for label in others:
            lines += self.excerpt(label, before, margin, "-", "place")
            before = label.location
        for note in diagnostic.notes():
            first, *more = note.split("\n") or [""]
            lines.append(f"{self._paint('note', 'bold')}: {printable(first)}")
            lines += [f"      {printable(line)}".rstrip() for line in more]
        for help_ in diagnostic.help():
            lines.append(f"{self._paint('help', 'help')}: {printable(help_.text)}")
        return "\n".join(lines) + "\n"

    def excerpt(
        self, label: Label, before: Location | None, margin: int, mark: str, style: str
    ) -> list[str]:
        """The place of a label, leaving out what the excerpt `before` it has shown."""
        place, gutter = label.location, " " * margin
        bar = self._paint("|", "place")
        lines = []
        if before is None or before.file != place.file:
            lines.append(f"{self._paint(f'{gutter}-->', 'place')} {printable(str(place))}")
        source = self.sources.get(place.file)
        if source is None:
            text = printable(label.text)
            return [*lines, f"{gutter} {bar} {text}"] if text else lines
        view = _view(source.line(place.line), place, before, self.width - margin - 3)
        if before is None or (before.file, before.line) != (place.file, place.line):
            number = self._paint(f"{place.line:>{margin}}", "place")
            lines += [f"{gutter} {bar}", f"{number} {bar} {view.text}".rstrip()]
        marks = mark * max(1, view.end - view.start)
        carets = self._paint(f"{marks} {printable(label.text)}".rstrip(), style)
        return [*lines, f"{gutter} {bar} {' ' * view.start}{carets}"]

    def _paint(self, text: str, style: str) -> str:
        return paint(text, style, color=self.color)


def paint(text: str, style: str, *, color: bool) -> str:
    """Text in a style: `error`, `warning`, `place`, `help` or `bold`."""
    return f"{_STYLES[style]}{text}{_RESET}" if color else text


@dataclass(frozen=True, slots=True)
class _View:
    """What is shown of a line, and the columns of it that are marked."""

    text: str
    start: int
    end: int


def _view(line: str, place: Location, shown: Location | None, width: int) -> _View:
    """The part of a line around a place, or around an earlier place on that line."""
    center = place
    if shown is not None and (shown.file, shown.line) == (place.file, place.line):
        center = shown
    offset = _offset(line, center.column - 1, width)
    cells: list[str] = []
    used = 1 if offset else 0
    # Every character takes a column at least, save combining ones.
    for character in line[offset : offset + 4 * width]:
        cell = _cell(character)
        used += _columns(cell)
        if used > width:
            break
        cells.append(cell)
    is_cut = offset + len(cells) < len(line)
    text = "…" * (offset > 0) + "".join(cells) + "…" * is_cut
    last = place.end_column if place.end_line == place.line else len(line) + 1
    columns = [
        (offset > 0) + _columns("".join(cells[: max(0, column - 1 - offset)]))
        for column in (place.column, last)
    ]
    return _View(text, columns[0], columns[1])


def _offset(line: str, column: int, width: int) -> int:
    """How many characters to leave out on the left; none where the line fits."""
    if len(line) <= width and sum(map(_columns, map(_cell, line))) <= width:
        return 0
    return max(0, min(column, len(line)) - width // 3)


def _cell(character: str) -> str:
    """What is shown for a character of the source: nothing that acts on a terminal."""
    if character.isprintable():
        return character
    return _TAB if character == "\t" else ascii(character)[1:-1]


def _columns(text: str) -> int:
    """How many columns a text takes on a terminal."""
    if text.isascii():
        return len(text)
    return sum(_width(character) for character in text)


def _width(character: str) -> int:
    if unicodedata.category(character) in ("Mn", "Me"):
        return 0
    return 2 if unicodedata.east_asian_width(character) in ("W", "F") else 1


def printable(text: str) -> str:
    """Text without characters that would act on a terminal, and of bounded length."""
    shown = "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text[:_LONGEST])
    return shown if len(text) <= _LONGEST else f"{shown}…"


def summary(diagnostics: Iterable[Diagnostic]) -> str:
    """The closing line: how many errors and warnings, or nothing when there are none."""
    listed = list(diagnostics)
    errors = sum(d.severity is Severity.ERROR for d in listed)
    counts = [(errors, "error"), (len(listed) - errors, "warning")]
    words = [f"{n} {word}{'' if n == 1 else 's'}" for n, word in counts if n]
    return " and ".join(words)
