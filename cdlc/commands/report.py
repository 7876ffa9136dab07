"""The command report: tables and charts of what `cdlc bench` recorded."""

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from cdlc import driver
from cdlc.commands.shared import DONE, INPUT_ERRORS, print_json
from cdlc.diagnostics import Collector

if TYPE_CHECKING:
    from cdlc.bench.tables import Row


def report(options: argparse.Namespace) -> int:
    """`cdlc report`: tables on standard output, and with `-o` charts and a page in a folder."""
    from cdlc.bench.results import read_results
    from cdlc.bench.tables import rows_of, tables, text

    found = Collector()
    rows: list[Row] = []
    planned = 0
    for file in options.files:
        results = read_results(file, found)
        if results is not None:
            prefix = f"{Path(file).stem}: " if len(options.files) > 1 else ""
            rows += rows_of(results.records, prefix)
            planned += results.header["runs"]
    if found.has_errors:
        raise driver.CompileError(found.sorted(), {})
    made = tables(rows)
    if options.format == "json":
        print_json({
            "version": 1,
            "planned": planned,
            "tables": [{"title": t.title, "headings": t.headings, "rows": t.rows} for t in made],
        })  # fmt: skip
    else:
        print("\n".join(map(text, made)), end="")
    told = f"{len(rows)} of {planned} runs"
    print(told, file=sys.stderr)
    return DONE if options.output is None else _write(options, rows, told)


def _write(options: argparse.Namespace, rows: "list[Row]", told: str) -> int:
    """The page, and each chart as SVG and PNG."""
    from cdlc.bench.curves import charts
    from cdlc.bench.page import page
    from cdlc.bench.tables import tables
    from cdlc.output import write_whole
    from cdlc.view.charts import drawn
    from cdlc.view.draw import FORMATS, ViewMissing, require

    try:
        require()
    except ViewMissing as error:
        print(f"error[{error.code}]: {error}", file=sys.stderr)
        return INPUT_ERRORS
    folder: Path = options.output
    every = [
        (chart, {ending: drawn(chart, ending) for ending in FORMATS}) for chart in charts(rows)
    ]
    for chart, pictures in every:
        for ending, picture in pictures.items():
            write_whole(folder / f"{chart.name}.{ending}", picture)
    title = ", ".join(Path(file).name for file in options.files)
    shown = [(chart, pictures["svg"]) for chart, pictures in every]
    write_whole(folder / "report.html", page(title, told, tables(rows), shown))
    return DONE
