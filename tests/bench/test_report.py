"""`cdlc report`: tables of records, charts of them, and one page with all."""

import json
import re
from pathlib import Path
from typing import Any

import pytest
from browser import browser
from conftest import Golden
from hypothesis import given
from hypothesis import strategies as st
from support import cdlc

from cdlc.bench.curves import charts
from cdlc.bench.results import read_results
from cdlc.bench.tables import STATUSES, Row, labels_of, rows_of, shared_by_all, tables, text
from cdlc.diagnostics import Collector
from cdlc.view.charts import drawn

HERE = Path(__file__).parent


def record(
    engine: str, file: str, seed: int, status: str, seconds: float, **more: Any
) -> dict[str, Any]:
    """A record as a file of results has it."""
    configuration = {"engine": engine, "time_limit": 10.0} | ({"seed": seed} if seed else {})
    document = {
        "key": f"{file} {engine} seed={seed}", "file": file, "problem": Path(file).stem,
        "configuration": configuration, "status": status, "seconds": seconds,
    }  # fmt: skip
    if status != "fault":
        document |= {"steps": [], "cost": None, "statistics": {"nodes": int(seconds * 1_000)}}
    return {**document, **more}


RECORDS = [
    record("auto", "easy/a.cdl", 0, "plan", 0.1, steps=[{}, {}]),
    record("auto", "easy/a.cdl", 1, "plan", 0.3, steps=[{}, {}, {}, {}]),
    record("auto", "hard/b.cdl", 0, "timeout", 10.0),
    record("auto", "hard/b.cdl", 1, "plan", 8.0, steps=[{}] * 9),
    record("best", "easy/a.cdl", 0, "unsolvable", 0.02),
    record("best", "easy/a.cdl", 1, "plan", 0.04, steps=[{}]),
    record("best", "hard/b.cdl", 0, "memory", 3.0),
    record(
        "best", "hard/b.cdl", 1, "fault", 1.0,
        fault={"kind": "function", "message": "hard/b.cdl:3:4: `f(x)` <raised>\nmore of it"},
    ),
]  # fmt: skip
HEADER = {"version": 1, "cdlc": "0.1.0", "suite": "x", "runs": 9}


@pytest.fixture
def results(tmp_path: Path) -> Path:
    file = tmp_path / "results.jsonl"
    lines = [json.dumps(document) + "\n" for document in (HEADER, *RECORDS)]
    file.write_text("".join(lines) + '{"key": "cut o')
    return file


def test_tables(results: Path, golden: Golden) -> None:
    ran = cdlc("report", results)
    assert (ran.status, ran.err) == (0, "8 of 9 runs\n")
    golden(HERE / "report.txt", ran.out)


def test_tables_as_json(results: Path) -> None:
    ran = cdlc("report", results, "--format", "json")
    document = json.loads(ran.out)
    assert document["planned"] == 9
    by_title = {table["title"]: table for table in document["tables"]}
    assert by_title["Coverage"]["headings"] == ["folder", "auto", "best"]
    assert by_title["Coverage"]["rows"] == [
        ["easy", "2/2", "2/2"], ["hard", "1/2", "0/2"], ["all", "3/4", "2/4"],
    ]  # fmt: skip
    assert ran.err == "8 of 9 runs\n"


def test_several_files_stand_side_by_side(results: Path) -> None:
    other = results.with_name("other.jsonl")
    other.write_text(results.read_text().replace('"seconds": 0.1', '"seconds": 0.2'))
    ran = cdlc("report", results, other)
    assert ran.status == 0
    for label in ("results: auto", "other: auto", "results: best", "other: best"):
        assert label in ran.out


@pytest.mark.parametrize(
    ("spoilt", "told"),
    [
        ("", "it has no header"),
        ('{"key": "x"}\n', "the first line is no header"),
        ("nothing\n", "a line is no JSON object"),
        ('{"version": 2, "suite": "x", "runs": 1}\n', "it has version 2 of the format, not 1"),
        ('{"version": 1, "suite": "x", "runs": 1}\n{"key": "x"}\n', "no record"),
    ],
)
def test_what_is_no_file_of_results_is_told(spoilt: str, told: str, tmp_path: Path) -> None:
    file = tmp_path / "spoilt.jsonl"
    file.write_text(spoilt)
    found = Collector()
    assert read_results(str(file), found) is None
    assert [diagnostic.code for diagnostic in found] == ["bad-results"]
    ran = cdlc("report", file)
    assert (ran.status, ran.out) == (1, "")
    assert f"error[bad-results]: not a file of results: {told}" in ran.err
    line = max(1, spoilt.count("\n"))
    assert f" --> {file}:{line}:1" in ran.err


def test_a_file_that_is_not_there_is_told(tmp_path: Path) -> None:
    ran = cdlc("report", tmp_path / "none.jsonl")
    assert ran.status == 1
    assert "no such file" in ran.err.lower()
    assert "Traceback" not in ran.err


def test_a_page_and_pictures(results: Path, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib", reason="matplotlib is not installed (extra `view`)")
    folder = tmp_path / "report"
    ran = cdlc("report", results, "-o", folder)
    assert ran.status == 0, ran
    names = {"cactus", "success", "scatter-1-2"}
    assert {f.name for f in folder.iterdir()} == {
        "report.html", *(f"{name}.{ending}" for name in names for ending in ("png", "svg")),
    }  # fmt: skip
    for name in names:
        assert (folder / f"{name}.png").read_bytes().startswith(b"\x89PNG")
        svg = (folder / f"{name}.svg").read_text()
        assert "<text" in svg
        assert "$" not in svg
    page = (folder / "report.html").read_text()
    assert "&lt;raised&gt;" in page
    assert not re.search(r'(?:src|href)="(?!data:)', page)
    with browser(tmp_path / "profile") as shown:
        shown.open(folder / "report.html")
        assert shown.value("document.querySelectorAll('table').length") == 4
        widths = shown.value("[...document.images].map(i => i.naturalWidth)")
        assert len(widths) == 3
        assert min(widths) > 100
        assert shown.complaints == []
        asked = [url for url in shown.requests if not url.startswith("data:")]
        assert asked == [(folder / "report.html").as_uri()]


STATUS = st.sampled_from(STATUSES)
TIMES = st.floats(0, 1e6, allow_nan=False)


@st.composite
def documents(draw: st.DrawFn) -> list[dict[str, Any]]:
    files = st.sampled_from(["x/p", "x/q", "y/p"])
    keys = st.tuples(st.sampled_from("abc"), files, st.integers(0, 2))
    chosen = draw(st.lists(keys, min_size=1, max_size=20))
    return [record(engine, file, seed, draw(STATUS), draw(TIMES)) for engine, file, seed in chosen]


@given(documents())
def test_tables_count_every_run_once(found: list[dict[str, Any]]) -> None:
    rows = rows_of(found)
    assert len(rows) == len({document["key"] for document in found})
    endings, coverage, *_ = tables(rows)
    assert sum(int(row[-1]) for row in endings.rows) == len(rows)
    solved = sum(row.is_solved for row in rows)
    assert sum(int(cell.split("/")[0]) for cell in coverage.rows[-1][1:]) == solved
    assert sum(int(cell.split("/")[1]) for cell in coverage.rows[-1][1:]) == len(rows)
    for file, seed in shared_by_all(rows):
        own = [row for row in rows if (row.file, row.seed) == (file, seed)]
        assert len(own) == len(labels_of(rows))
        assert all(row.is_solved for row in own)
    for table in tables(rows):
        assert len({len(line) for line in (table.headings, *table.rows)}) == 1
        assert text(table).startswith(table.title)


@given(documents())
def test_curves_rise_and_count_what_was_solved(found: list[dict[str, Any]]) -> None:
    rows = rows_of(found)
    cactus, success, *scatters = charts(rows)
    for curve in cactus.curves:
        own = [row for row in rows if row.label == curve.label and row.is_solved]
        assert len(curve.xs) == len(own)
        assert list(curve.ys) == sorted(curve.ys)
    for curve in success.curves:
        own = [row for row in rows if row.label == curve.label]
        assert curve.ys[-1] == pytest.approx(100 * sum(r.is_solved for r in own) / len(own))
        assert list(curve.xs) == sorted(curve.xs)
    for chart in scatters:
        assert chart.rim is not None
        assert all(0 < v <= chart.rim for c in chart.curves for v in (*c.xs, *c.ys))


def test_charts_of_nothing_solved_are_drawn() -> None:
    pytest.importorskip("matplotlib", reason="matplotlib is not installed (extra `view`)")
    lost = [record(engine, "a/b.cdl", 0, "timeout", 1.0) for engine in ("auto", "best")]
    for chart in (*charts(rows_of(lost)), *charts(rows_of(RECORDS))):
        assert drawn(chart, "svg") == drawn(chart, "svg")


def test_labels_say_what_differs() -> None:
    def row(**configuration: Any) -> dict[str, Any]:
        return {**record("auto", "a.cdl", 0, "plan", 1), "key": str(configuration), "steps": [],
                "configuration": configuration}  # fmt: skip

    found = [
        row(engine="auto", node_limit=5, seed=3),
        row(engine="auto", node_limit=5, h="add"),
        row(engine="auto", node_limit=5, name="mine"),
    ]
    assert [r.label for r in rows_of(found)] == ["auto", "auto h=add", "mine"]
    assert [Row.__name__, rows_of(found)[0].seed] == ["Row", 3]
