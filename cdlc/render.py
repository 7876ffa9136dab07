"""Diagnostics as text for people and as JSON for programs; both show the same object."""

import os
import sys
from collections.abc import Iterable, Mapping
from typing import Any, TextIO

from crow.program import Location

from cdlc.diagnostics import Diagnostic, Help, Label, Severity
from cdlc.source import SourceFile

_STYLES = {
    "error": "\x1b[1;31m",
    "warning": "\x1b[1;33m",
    "place": "\x1b[1;34m",
    "help": "\x1b[1;32m",
    "bold": "\x1b[1m",
}
_RESET = "\x1b[0m"
# Longer lines are shown around the place only.
_WIDTH = 160


def wants_color(stream: TextIO) -> bool:
    """Whether to color what goes to a stream: on a terminal, unless NO_COLOR is set."""
    return stream.isatty() and not os.environ.get("NO_COLOR") and sys.platform != "win32"


def as_text(
    diagnostics: Iterable[Diagnostic], sources: Mapping[str, SourceFile], *, color: bool = False
) -> str:
    """Diagnostics with source lines and carets, a blank line between two of them."""
    painter = _Painter(sources, color)
    return "\n".join(painter.render(diagnostic) for diagnostic in diagnostics)


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
    def __init__(self, sources: Mapping[str, SourceFile], color: bool) -> None:
        self.sources = sources
        self.color = color

    def render(self, diagnostic: Diagnostic) -> str:
        severity = str(diagnostic.severity)
        head = self._paint(f"{severity}[{diagnostic.code}]", severity)
        message = self._paint(f": {_printable(diagnostic.message())}", "bold")
        lines = [f"{head}{message}"]
        primary = Label(diagnostic.location, diagnostic.label())
        others = sorted(diagnostic.labels(), key=lambda label: label.location)
        margin = max(len(str(label.location.line)) for label in (primary, *others))
        lines += self._excerpt(primary, margin, "^", severity, first=True)
        file = diagnostic.location.file
        for label in others:
            moved = label.location.file != file
            lines += self._excerpt(label, margin, "-", "place", first=moved)
            file = label.location.file
        lines += [f"{self._paint('note', 'bold')}: {note}" for note in diagnostic.notes()]
        lines += [f"{self._paint('help', 'help')}: {help_.text}" for help_ in diagnostic.help()]
        return "\n".join(lines) + "\n"

    def _excerpt(
        self, label: Label, margin: int, mark: str, style: str, *, first: bool
    ) -> list[str]:
        location = label.location
        bar = self._paint("|", "place")
        lines = []
        if first:
            arrow = self._paint(f"{' ' * margin}-->", "place")
            lines.append(f"{arrow} {location}")
        source = self.sources.get(location.file)
        if source is None:
            return (
                lines
                if first and not label.text
                else [*lines, f"{' ' * margin} {bar} {label.text}"]
            )
        lines.append(f"{' ' * margin} {bar}")
        text, offset = _window(source.line(location.line), location)
        number = self._paint(f"{location.line:>{margin}}", "place")
        lines.append(f"{number} {bar} {text}".rstrip())
        end = location.end_column if location.end_line == location.line else len(text) + offset + 1
        width = max(1, min(end, len(text) + offset + 1) - location.column)
        carets = self._paint(f"{mark * width} {_printable(label.text)}".rstrip(), style)
        lines.append(f"{' ' * margin} {bar} {' ' * (location.column - 1 - offset)}{carets}")
        return lines

    def _paint(self, text: str, style: str) -> str:
        return f"{_STYLES[style]}{text}{_RESET}" if self.color else text


def _window(line: str, location: Location) -> tuple[str, int]:
    """The part of a line to show and how many characters stand before it."""
    shown = "".join(c if c.isprintable() else " " for c in line)
    if len(shown) <= _WIDTH:
        return shown, 0
    start = max(0, min(location.column - 1 - _WIDTH // 2, len(shown) - _WIDTH))
    return shown[start : start + _WIDTH], start


def _printable(text: str) -> str:
    """Text without characters that would act on a terminal, and of bounded length."""
    shown = "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)
    return shown if len(shown) <= 300 else f"{shown[:300]}…"


def summary(diagnostics: Iterable[Diagnostic]) -> str:
    """The closing line: how many errors and warnings, or nothing when there are none."""
    listed = list(diagnostics)
    errors = sum(d.severity is Severity.ERROR for d in listed)
    counts = [(errors, "error"), (len(listed) - errors, "warning")]
    words = [f"{n} {word}{'' if n == 1 else 's'}" for n, word in counts if n]
    return " and ".join(words)
