"""Checking a text or a file, with everything that is found."""

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from cdlc.diagnostics import Diagnostic
from cdlc.driver import CompileError, compilation
from cdlc.render import as_text
from cdlc.source import SourceFile


@dataclass(frozen=True)
class Checked:
    """What checking found, in source order, with the texts it points into."""

    diagnostics: tuple[Diagnostic, ...]
    sources: Mapping[str, SourceFile]

    @property
    def codes(self) -> list[str]:
        return [diagnostic.code for diagnostic in self.diagnostics]

    @property
    def places(self) -> list[tuple[int, str]]:
        """The lines with what is said there."""
        return [(d.location.line, d.code) for d in self.diagnostics]

    @property
    def text(self) -> str:
        return as_text(self.diagnostics, self.sources)


def check_text(text: str | bytes) -> Checked:
    """Check a file that is given as standard input."""
    data = text.encode() if isinstance(text, str) else text
    return _check("-", data)


def check_file(path: Path | str) -> Checked:
    """Check a file by name."""
    return _check(os.fspath(path), b"")


def _check(name: str, data: bytes) -> Checked:
    done = compilation([name], read_standard_input=lambda: data)
    try:
        _ = done.checked
    except CompileError as error:
        return Checked(error.diagnostics, error.sources)
    return Checked(done.found.sorted(), done.sources)
