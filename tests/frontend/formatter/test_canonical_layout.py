"""Canonical layout by example: each case and, beside it, what formatting makes of it."""

from pathlib import Path

import pytest
from conftest import Golden
from support import EXAMPLES, ROOT

from cdlc.diagnostics import Collector
from cdlc.frontend.formatter import format_source
from cdlc.frontend.loader import Files
from cdlc.source import SourceFile

FOLDER = ROOT / "tests" / "golden" / "fmt"
CASES = sorted(FOLDER.glob("*.cdl"))
PROGRAMS = sorted(EXAMPLES.rglob("*.cdl"))


def formatted(path: Path) -> str:
    found = Collector()
    source = Files(found, lambda: b"").read(str(path))
    assert source is not None
    text = format_source(source, found)
    assert text is not None, [diagnostic.message() for diagnostic in found]
    return text


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_golden(path: Path, golden: Golden) -> None:
    golden(path.with_suffix(".fmt"), formatted(path))


@pytest.mark.parametrize("path", [*CASES, *PROGRAMS], ids=lambda path: path.stem)
def test_formatting_again_changes_nothing(path: Path) -> None:
    text = formatted(path)
    assert format_source(SourceFile("again.cdl", text), Collector()) == text


def test_there_are_cases() -> None:
    assert len(CASES) > 5
