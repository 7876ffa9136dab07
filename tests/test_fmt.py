"""Formatting files: what is written, what is left alone, and what is said about it."""

import os
import stat
from pathlib import Path

import pytest

from cdlc.fmt import Outcome, format_file, format_files

UGLY = "typedef  a\nfeature f( x:a )\n"
PRETTY = "typedef a\n\nfeature f(x: a)\n"


def no_input() -> bytes:
    raise AssertionError("standard input is not read")


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "a.cdl"
    path.write_text(UGLY)
    return path


def test_changed_file_is_written(file: Path) -> None:
    result = format_file(str(file), no_input)
    assert (result.outcome, result.text) == (Outcome.CHANGED, PRETTY)
    assert file.read_text() == PRETTY
    assert format_file(str(file), no_input).outcome is Outcome.UNCHANGED


def test_check_writes_nothing_and_shows_the_difference(file: Path) -> None:
    result = format_file(str(file), no_input, check=True)
    assert result.outcome is Outcome.CHANGED
    assert file.read_text() == UGLY
    assert result.diff.splitlines() == [
        f"--- {file}",
        f"+++ {file} (formatted)",
        "@@ -1,2 +1,3 @@",
        "-typedef  a",
        "-feature f( x:a )",
        "+typedef a",
        "+",
        "+feature f(x: a)",
    ]


def test_difference_of_the_last_line_end_is_shown(file: Path) -> None:
    file.write_text("typedef a")
    assert "-typedef a\n\\ No newline at end of file\n+typedef a\n" in (
        format_file(str(file), no_input, check=True).diff
    )


def test_file_with_errors_is_left_alone(file: Path) -> None:
    file.write_text("typedef  a\nfeature f(\n")
    result = format_file(str(file), no_input)
    assert (result.outcome, result.text, result.diff) == (Outcome.INVALID, None, "")
    assert "unclosed-bracket" in [d.code for d in result.diagnostics]
    assert str(file) in result.sources
    assert file.read_text() == "typedef  a\nfeature f(\n"


def test_missing_file_is_a_diagnostic(tmp_path: Path) -> None:
    result = format_file(str(tmp_path / "none.cdl"), no_input)
    assert [d.code for d in result.diagnostics] == ["unreadable-file"]


def test_marks_and_line_ends_of_other_systems_go(file: Path) -> None:
    file.write_bytes(b"\xef\xbb\xbf" + PRETTY.encode())
    assert format_file(str(file), no_input).outcome is Outcome.CHANGED
    file.write_bytes(PRETTY.replace("\n", "\r\n").encode())
    assert format_file(str(file), no_input).outcome is Outcome.CHANGED
    assert file.read_bytes() == PRETTY.encode()


def test_unchanged_file_is_not_touched(file: Path) -> None:
    file.write_text(PRETTY)
    os.utime(file, (1, 1))
    format_file(str(file), no_input)
    assert file.stat().st_mtime == 1


@pytest.mark.skipif(os.name != "posix", reason="permissions and links of POSIX")
def test_permissions_and_links_are_kept(file: Path) -> None:
    file.chmod(0o640)
    link = file.with_name("link.cdl")
    link.symlink_to(file.name)
    format_file(str(link), no_input)
    assert link.is_symlink()
    assert file.read_text() == PRETTY
    assert stat.S_IMODE(file.stat().st_mode) == 0o640
    assert sorted(p.name for p in file.parent.iterdir()) == ["a.cdl", "link.cdl"]


def test_standard_input_is_returned_only() -> None:
    result = format_file("-", UGLY.encode)
    assert (result.outcome, result.text) == (Outcome.CHANGED, PRETTY)


def test_one_bad_file_does_not_stop_the_others(file: Path, tmp_path: Path) -> None:
    bad = tmp_path / "bad.cdl"
    bad.write_text("nonsense (")
    results = format_files([str(bad), str(file)], no_input)
    assert [result.outcome for result in results] == [Outcome.INVALID, Outcome.CHANGED]


def test_deep_nesting_is_a_diagnostic(file: Path) -> None:
    deep = "minimize: " + "f(" * 900 + "1" + ")" * 900 + "\n"
    file.write_text(deep)
    result = format_file(str(file), no_input)
    assert [d.code for d in result.diagnostics] == ["nesting-too-deep"]
    assert file.read_text() == deep
