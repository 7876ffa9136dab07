"""Diagnostics as text and as JSON: one object, two renderings."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from checking import check_text, lint_file
from support import ROOT

from cdlc.diagnostics import Diagnostic, Help, Label, Replacement
from cdlc.render import as_json, as_text, printable, summary
from cdlc.source import SourceFile, Span
from crow.program import Location

BAD = sorted((ROOT / "tests" / "errors").glob("*/bad.cdl"))
KINDS = dict(Diagnostic.kinds)


class Made(Diagnostic):
    """A diagnostic with the texts a test gives it."""

    def __init__(self, location: Location, label: str = "", *labels: Label, note: str = "") -> None:
        super().__init__(location=location)
        object.__setattr__(self, "said", (label, labels, note))

    said: tuple[str, tuple[Label, ...], str]

    def message(self) -> str:
        return "something is wrong"

    def label(self) -> str:
        return self.said[0]

    def labels(self) -> tuple[Label, ...]:
        return self.said[1]

    def notes(self) -> tuple[str, ...]:
        return (self.said[2],) if self.said[2] else ()

    def help(self) -> tuple[Help, ...]:
        return (Help("mend it", Replacement(self.location, "x")),)


Diagnostic.kinds.clear()
Diagnostic.kinds.update(KINDS)


def at(source: SourceFile, piece: str, *, after: int = 0) -> Location:
    start = source.text.index(piece, after)
    return source.location(Span(start, start + len(piece)))


def rendered(source: SourceFile, diagnostic: Diagnostic, **options: Any) -> list[str]:
    text = as_text([diagnostic], {source.name: source}, **options)
    return text.removesuffix("\nhelp: mend it\n").split("\n")


def test_labels_of_one_line_share_it() -> None:
    source = SourceFile("f.cdl", "one two three\nfour\n")
    label, other = Label(at(source, "three"), "here"), Label(at(source, "four"), "and here")
    assert rendered(source, Made(at(source, "one"), "this", label, other, note="why")) == [
        "error[made]: something is wrong",
        " --> f.cdl:1:1",
        "  |",
        "1 | one two three",
        "  | ^^^ this",
        "  |         ----- here",
        "  |",
        "2 | four",
        "  | ---- and here",
        "note: why",
    ]


def test_a_label_in_another_file_names_it() -> None:
    first, second = SourceFile("a.cdl", "one\n"), SourceFile("b.cdl", "two\n")
    diagnostic = Made(at(first, "one"), "this", Label(at(second, "two"), "that"))
    text = as_text([diagnostic], {"a.cdl": first, "b.cdl": second})
    assert " --> b.cdl:1:1\n  |\n1 | two\n  | --- that\n" in text


@pytest.mark.parametrize(
    ("line", "carets"),
    [
        ("漢字 here", "     ^^^^"),
        ("e\u0301\u0301 here", "  ^^^^"),
        ("\there", "    ^^^^"),
        ("\x1b[1m here", "\\x1b[1m here".replace("here", "^^^^").replace("\\x1b[1m", " " * 7)),
        ("\u202e here", "       ^^^^"),
    ],
)
def test_carets_stand_under_what_is_shown(line: str, carets: str) -> None:
    source = SourceFile("f.cdl", line)
    _, _, _, text, marks = rendered(source, Made(at(source, "here")))
    assert marks == f"  | {carets}"
    assert all(c.isprintable() for c in text)


def test_spans_over_lines_and_without_width() -> None:
    source = SourceFile("f.cdl", "one two\nthree\n")
    spanning = Made(source.location(Span(4, 11)))
    assert rendered(source, spanning)[3:] == ["1 | one two", "  |     ^^^"]
    assert rendered(source, Made(source.location(Span(7, 7))))[-1] == "  |        ^"
    assert rendered(source, Made(source.location(Span(14, 14))))[1:] == [
        " --> f.cdl:3:1", "  |", "3 |", "  | ^",
    ]  # fmt: skip


def test_long_lines_are_shown_around_the_place() -> None:
    source = SourceFile("f.cdl", "x " * 300 + "here" + " y" * 300_000)
    diagnostic = Made(at(source, "here"), "label", Label(at(source, "y"), "other"))
    for width in (40, 80, 160):
        lines = rendered(source, diagnostic, width=width)
        assert all(len(line) <= width + 10 for line in lines[2:])
        text, carets = lines[3], lines[4]
        assert text[carets.index("^") : carets.rindex("^") + 1] == "here"
        assert text.startswith("1 | …")
        assert text.endswith("…")


def test_color_only_when_asked_for() -> None:
    source = SourceFile("f.cdl", "one\n")
    plain = "\n".join(rendered(source, Made(at(source, "one"), "this")))
    colored = "\n".join(rendered(source, Made(at(source, "one"), "this"), color=True))
    assert "\x1b" not in plain
    assert "\x1b[1;31merror[made]\x1b[0m" in colored


def test_nothing_of_the_input_acts_on_a_terminal() -> None:
    text = check_text(
        'feature f(x: object)\nfeature \x1b]0;x\x07(y: "\x9b")\n\u202efeature g()\n'
    ).text
    assert all(c == "\n" or c.isprintable() for c in text)
    assert printable("a\x1b[0m\n") == "a\\x1b[0m\\n"
    assert len(printable("a" * 10_000)) < 400


def test_the_summary_counts() -> None:
    assert summary([]) == ""
    assert summary(check_text("feature f(x: T, y: U)\n").diagnostics) == "2 errors"
    assert summary(check_text("#!pragma x\nfeature f()\n").diagnostics) == "1 warning"


SCHEMA = json.loads((ROOT / "cdlc" / "schemas" / "check.json").read_text())


@pytest.mark.parametrize("file", BAD, ids=lambda file: file.parent.name)
def test_json_is_as_the_schema_says(file: Path) -> None:
    checked = lint_file(file)
    document = json.loads(json.dumps(as_json(checked.diagnostics)))
    jsonschema.validate(document, SCHEMA)
    listed = [(d["code"], d["span"]["start"]["line"]) for d in document["diagnostics"]]
    assert listed == [(code, line) for line, code in checked.places]
    for diagnostic in document["diagnostics"]:
        for span in _spans(diagnostic):
            start, end = span["start"], span["end"]
            assert (start["line"], start["column"]) <= (end["line"], end["column"])


def _spans(node: Any) -> Iterator[Any]:
    if isinstance(node, dict):
        if set(node) == {"start", "end"}:
            yield node
        for part in node.values():
            yield from _spans(part)
    elif isinstance(node, list):
        for part in node:
            yield from _spans(part)
