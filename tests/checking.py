"""Checking a text or a file, with everything that is found."""

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import cdlc.ir.errors
from cdlc.diagnostics import Diagnostic, Lint
from cdlc.driver import CompileError, compilation
from cdlc.render import as_text
from cdlc.source import SourceFile


@dataclass(frozen=True)
class Checked:
    """What checking found, in source order, with the texts it points into."""

    diagnostics: tuple[Diagnostic, ...]
    sources: Mapping[str, SourceFile]

    @property
    def without_lints(self) -> "Checked":
        """Without warnings about what a whole program means, which small examples all get."""
        kept = tuple(d for d in self.diagnostics if not _is_lint(d))
        return Checked(kept, self.sources)

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
    """Check a file that is given as standard input; lints are left out."""
    data = text.encode() if isinstance(text, str) else text
    return _check("-", data).without_lints


def check_file(path: Path | str) -> Checked:
    """Check a file by name; lints are left out."""
    return lint_file(path).without_lints


def lint_file(path: Path | str) -> Checked:
    """Check a file by name, with all warnings."""
    return _check(os.fspath(path), b"")


def _is_lint(diagnostic: Diagnostic) -> bool:
    return isinstance(diagnostic, Lint) and type(diagnostic).__module__ == cdlc.ir.errors.__name__


def _check(name: str, data: bytes) -> Checked:
    done = compilation([name], read_standard_input=lambda: data)
    try:
        _ = done.checked
    except CompileError as error:
        return Checked(error.diagnostics, error.sources)
    return Checked(done.found.sorted(), done.sources)
