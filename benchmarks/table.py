"""Tables of figures: printed for people, written as CSV and drawn as plots."""

import csv
import sys
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from benchmarks.plot import Figure, Plot, draw


@dataclass(frozen=True, slots=True)
class Table:
    """One benchmark's figures: a name, column titles, rows, and what is to be seen in them."""

    name: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Figure, ...], ...]
    note: str = ""
    plots: tuple[Plot, ...] = ()

    def text(self) -> str:
        """The table with aligned columns."""
        cells = [self.columns, *(tuple(map(_shown, row)) for row in self.rows)]
        widths = [max(len(row[i]) for row in cells) for i in range(len(self.columns))]
        lines = ["  ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)) for row in cells]
        rule = "  ".join("-" * width for width in widths)
        parts = [f"== {self.name}", lines[0].rstrip(), rule, *(line.rstrip() for line in lines[1:])]
        return "\n".join([*parts, self.note] if self.note else parts) + "\n"

    def write(self, folder: Path) -> None:
        """Write the figures to `NAME.csv` in a folder, and the plots beside it. Raises OSError."""
        folder.mkdir(parents=True, exist_ok=True)
        with (folder / f"{self.name}.csv").open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(self.columns)
            writer.writerows(self.rows)
        if self.plots and find_spec("matplotlib") is None:
            print("no plots: matplotlib is not installed (extra `view`)", file=sys.stderr)
            return
        for plot in self.plots:
            draw(self.name, self.columns, self.rows, plot, folder / f"{self.name}{plot.name}")


def _shown(figure: Figure) -> str:
    return f"{figure:.3g}" if isinstance(figure, float) else str(figure)
