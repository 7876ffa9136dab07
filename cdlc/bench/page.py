"""A report as one page of HTML that needs nothing else."""

from base64 import b64encode
from collections.abc import Sequence
from html import escape

from cdlc.bench.tables import Table
from cdlc.view.charts import Chart
from cdlc.view.page import POLICY

_STYLE = """\
body { font: 15px/1.45 system-ui, sans-serif; color: #1d1f24; background: #fff;
       max-width: 62rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.4rem; } h2 { font-size: 1.1rem; margin: 2rem 0 .4rem; }
p { color: #666b76; margin: .4rem 0; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .2rem .8rem .2rem 0; text-align: right; border-bottom: 1px solid #e3e5ea; }
th { font-weight: 600; } th:first-child, td:first-child { text-align: left; }
table.prose th, table.prose td { text-align: left; }
.charts { display: flex; flex-wrap: wrap; gap: 1rem; margin-top: 1.5rem; }
.charts img { width: 29rem; max-width: 100%; height: auto; }
"""


def page(
    title: str, told: str, tables: Sequence[Table], charts: Sequence[tuple[Chart, bytes]]
) -> str:
    """The page; charts come with their SVG."""
    shown = "".join(_image(chart, svg) for chart, svg in charts)
    return "".join(
        (
            '<!doctype html>\n<html lang="en">\n<meta charset="utf-8">\n',
            f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">\n',
            '<meta name="viewport" content="width=device-width">\n',
            '<link rel="icon" href="data:,">\n',
            f"<title>{escape(title)}</title>\n<style>\n{_STYLE}</style>\n",
            f"<body>\n<h1>{escape(title)}</h1>\n<p>{escape(told)}</p>\n",
            *map(_table, tables),
            f'<div class="charts">\n{shown}</div>\n</body>\n</html>\n',
        )
    )


def _image(chart: Chart, svg: bytes) -> str:
    data = b64encode(svg).decode()
    return f'<img alt="{escape(chart.title)}" src="data:image/svg+xml;base64,{data}">\n'


def _table(table: Table) -> str:
    kind = ' class="prose"' if table.title == "Faults" else ""
    head = "".join(f"<th>{escape(cell)}</th>" for cell in table.headings)
    rows = "".join(
        f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>\n" for row in table.rows
    )
    note = f"<p>{escape(table.note)}</p>\n" if table.note else ""
    return (
        f'<h2>{escape(table.title)}</h2>\n<div class="wide"><table{kind}>\n'
        f"<tr>{head}</tr>\n{rows}</table></div>\n{note}"
    )
