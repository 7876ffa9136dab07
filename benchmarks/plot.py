"""Plots of tables, as PNG and SVG; matplotlib is imported where one is drawn."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

Figure = str | int | float
Rows = tuple[tuple[Figure, ...], ...]


@dataclass(frozen=True, slots=True)
class Plot:
    """Columns of a table over another: a line for each, and for each value of column `by`.

    `scale` is `loglog`, `semilogy`, `semilogx` or `linear`; `name` is a suffix of the file's name.
    `panels` is a column for each value of which there are axes of their own, side by side; `steps`
    keep their height until the next point. Figures that are text are left out, and all points of a
    line without any.
    """

    x: str
    ys: tuple[str, ...]
    label: str
    by: str | None = None
    scale: Literal["loglog", "semilogy", "semilogx", "linear"] = "loglog"
    name: str = ""
    panels: str | None = None
    steps: bool = False

    def parts(self, columns: tuple[str, ...], rows: Rows) -> list[tuple[str, Rows]]:
        """The rows of each panel, with its title."""
        if self.panels is None:
            return [("", rows)]
        place = columns.index(self.panels)
        titles = dict.fromkeys(row[place] for row in rows)
        return [(f"{t}", tuple(row for row in rows if row[place] == t)) for t in titles]

    def lines(
        self, columns: tuple[str, ...], rows: Rows
    ) -> Iterator[tuple[str, list[float], list[float]]]:
        """The lines: label, xs and ys, in the order of the rows."""
        by = None if self.by is None else columns.index(self.by)
        groups = [None] if by is None else list(dict.fromkeys(row[by] for row in rows))
        for y in self.ys:
            for group in groups:
                chosen = [row for row in rows if by is None or row[by] == group]
                pairs = [(row[columns.index(self.x)], row[columns.index(y)]) for row in chosen]
                known = [
                    (float(a), float(b))
                    for a, b in pairs
                    if not isinstance(a, str) and not isinstance(b, str)
                ]
                parts = [y] * (len(self.ys) > 1 or by is None) + [f"{group}"] * (by is not None)
                if known:
                    yield ", ".join(parts), [a for a, _ in known], [b for _, b in known]


def draw(title: str, columns: tuple[str, ...], rows: Rows, plot: Plot, stem: Path) -> None:
    """Write a plot to `STEM.png` and `STEM.svg`. Raises ImportError without matplotlib."""
    from matplotlib.figure import Figure as Canvas
    from matplotlib.ticker import MaxNLocator

    parts = plot.parts(columns, rows)
    canvas = Canvas(figsize=(7 if len(parts) == 1 else 4 * len(parts), 4.5), layout="constrained")
    for part, (panel, chosen) in enumerate(parts):
        axes = canvas.add_subplot(1, len(parts), part + 1)
        heading = f"{title}: {panel}" if panel else title
        axes.set(title=heading, xlabel=plot.x, ylabel=plot.label)
        style = "steps-post" if plot.steps else "default"
        for number, (label, xs, ys) in enumerate(plot.lines(columns, chosen)):
            marker = "osD^vP*X"[number % 8]
            axes.plot(
                xs, ys, marker=marker, linewidth=1.2, markersize=4, label=label, drawstyle=style
            )
        if plot.scale in ("loglog", "semilogy"):
            axes.set_yscale("log")
        if plot.scale in ("loglog", "semilogx"):
            axes.set_xscale("log")
        else:
            axes.xaxis.set_major_locator(MaxNLocator(integer=True))
        axes.grid(visible=True, which="major", alpha=0.3)
        if axes.has_data():
            axes.legend(fontsize="small")
    for kind in ("png", "svg"):
        new = stem.with_suffix(f".new.{kind}")
        canvas.savefig(new, dpi=150)
        new.replace(stem.with_suffix(f".{kind}"))
