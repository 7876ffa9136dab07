"""`cdlc fmt`: files brought to the canonical layout, each written whole or left alone."""

import difflib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from io import StringIO
from pathlib import Path

from cdlc.diagnostics import Collector, Diagnostic
from cdlc.frontend.formatter import format_source
from cdlc.frontend.loader import STANDARD_INPUT, Files
from cdlc.output import write_whole
from cdlc.source import SourceFile


class Outcome(StrEnum):
    """What became of a file."""

    UNCHANGED = "unchanged"
    CHANGED = "changed"
    """It differs from its canonical layout, and is written unless only checked."""
    INVALID = "invalid"
    """It cannot be read completely and is left alone; the diagnostics say why."""


@dataclass(frozen=True, slots=True)
class Formatted:
    """A file and its canonical layout; `text` is None for an invalid file.

    Standard input is never written: its canonical text is for the caller to print.
    """

    name: str
    outcome: Outcome
    text: str | None
    diff: str
    diagnostics: tuple[Diagnostic, ...]
    sources: Mapping[str, SourceFile]


def format_files(
    names: Sequence[str], read_standard_input: Callable[[], bytes], *, check: bool = False
) -> list[Formatted]:
    """Format files, or with `check` only say which would change; `-` is standard input.

    Raises OSError when a file cannot be written.
    """
    return [format_file(name, read_standard_input, check=check) for name in names]


def format_file(
    name: str, read_standard_input: Callable[[], bytes], *, check: bool = False
) -> Formatted:
    """Format one file; see format_files."""
    data: list[bytes] = []

    def read() -> bytes:
        data.append(read_standard_input())
        return data[-1]

    found = Collector()
    files = Files(found, read)
    source = files.read(name)
    text = None if source is None else format_source(source, found)
    if source is None or text is None:
        return Formatted(name, Outcome.INVALID, None, "", found.sorted(), files.sources)
    written = data[0] if name == STANDARD_INPUT else Path(name).read_bytes()
    is_changed = written != text.encode()
    if is_changed and not check and name != STANDARD_INPUT:
        write_whole(Path(name).resolve(), text)
    return Formatted(
        name,
        Outcome.CHANGED if is_changed else Outcome.UNCHANGED,
        text,
        _diff(name, written.decode(errors="replace"), text) if is_changed else "",
        found.sorted(),
        files.sources,
    )


def _diff(name: str, before: str, after: str) -> str:
    """What formatting changes, as a unified diff."""
    lines = difflib.unified_diff(
        _lines(before), _lines(after), fromfile=name, tofile=f"{name} (formatted)"
    )
    return "".join(
        line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n" for line in lines
    )


def _lines(text: str) -> list[str]:
    """Lines with their ends; only line feeds end a line."""
    return list(StringIO(text, newline="\n"))
