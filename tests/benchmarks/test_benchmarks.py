"""Every benchmark runs in its quick form: a table, figures as CSV, and plots."""

import csv
import importlib
import re
from pathlib import Path

import pytest

from benchmarks.__main__ import NAMES, main
from benchmarks.fit import exponential, power
from benchmarks.imports import instances
from benchmarks.plot import Plot
from benchmarks.table import Table


@pytest.mark.parametrize("name", NAMES)
def test_the_quick_form_runs(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    if name == "imports" and not instances():
        pytest.skip("no public PDDL here; CDLC_PDDL says where it is")
    assert main([name, "--quick", "-o", str(tmp_path)]) == 0
    assert capsys.readouterr().out.startswith(f"== {name}\n")
    with (tmp_path / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        columns, *rows = csv.reader(file)
    assert rows
    assert all(len(row) == len(columns) for row in rows)
    drawn = {file.suffix for file in tmp_path.iterdir()} - {".csv"}
    assert drawn in (set(), {".png", ".svg"})


def test_an_unknown_name_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["nothing"])
    assert "no benchmark nothing; there are start," in capsys.readouterr().err


def test_every_module_with_a_run_is_listed() -> None:
    folder = Path(importlib.import_module("benchmarks").__path__[0])
    modules = {file.stem for file in folder.glob("*.py") if "\ndef run(quick" in file.read_text()}
    assert modules == set(NAMES)


# ----------------------------------------------------------------------------- fits and plots


def test_fits_find_what_made_the_figures() -> None:
    sizes = [2.0, 3.0, 5.0, 9.0]
    found = power(sizes, [7 * n**2.5 for n in sizes])
    assert found.value == pytest.approx(2.5)
    assert found.quality == pytest.approx(1)
    assert exponential(sizes, [7 * 1.3**n for n in sizes]).value == pytest.approx(1.3)
    assert exponential(sizes, [7 * n**2.5 for n in sizes]).quality < 0.97


def test_lines_of_a_plot_leave_out_what_is_no_figure() -> None:
    columns = ("n", "kind", "ours", "theirs")
    rows = ((1, "a", 2.0, "-"), (2, "a", 4.0, "none in 60 s"), (1, "b", 3.0, 5))
    plot = Plot("n", ("ours", "theirs"), "s", by="kind")
    assert list(plot.lines(columns, rows)) == [
        ("ours, a", [1, 2], [2, 4]),
        ("ours, b", [1], [3]),
        ("theirs, b", [1], [5]),
    ]
    plain = Plot("n", ("ours",), "s")
    assert [line[1] for line in plain.lines(columns, rows)] == [[1, 2, 1]]


def test_panels_have_the_rows_of_one_value_each(tmp_path: Path) -> None:
    rows = (("b", 1, 2.0), ("a", 1, 3.0), ("b", 2, 4.0))
    plot = Plot("n", ("s",), "seconds", panels="map", scale="semilogx", steps=True)
    parts = plot.parts(("map", "n", "s"), rows)
    assert parts == [("b", (rows[0], rows[2])), ("a", (rows[1],))]
    assert Plot("n", ("s",), "seconds").parts(("map", "n", "s"), rows) == [("", rows)]
    pytest.importorskip("matplotlib")
    Table("some", ("map", "n", "s"), rows, "", (plot,)).write(tmp_path)
    assert {"some: a", "some: b"} <= set(svg_titles(tmp_path / "some.svg"))


def svg_titles(file: Path) -> list[str]:
    """What matplotlib notes of each text that it draws."""
    return re.findall(r"<!-- (.*?) -->", file.read_text())


def test_plots_are_images_and_nothing_is_left_beside_them(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    plots = (Plot("n", ("s",), "seconds"), Plot("n", ("s",), "seconds", scale="linear", name="-2"))
    Table("some", ("n", "s"), ((1, 2.0), (2, 5.0)), "", plots).write(tmp_path)
    files = sorted(file.name for file in tmp_path.iterdir())
    assert files == ["some-2.png", "some-2.svg", "some.csv", "some.png", "some.svg"]
    assert (tmp_path / "some.png").read_bytes().startswith(b"\x89PNG")
    assert "<svg" in (tmp_path / "some.svg").read_text()
