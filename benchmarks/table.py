"""Tables of figures: printed for people, written as CSV for plots."""

import csv
from dataclasses import dataclass
from pathlib import Path

Figure = str | int | float


@dataclass(frozen=True, slots=True)
class Table:
    """One benchmark's figures: a name, column titles, rows, and what is to be seen in them."""

    name: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Figure, ...], ...]
    note: str = ""

    def text(self) -> str:
        """The table with aligned columns."""
        cells = [self.columns, *(tuple(map(_shown, row)) for row in self.rows)]
        widths = [max(len(row[i]) for row in cells) for i in range(len(self.columns))]
        lines = ["  ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)) for row in cells]
        rule = "  ".join("-" * width for width in widths)
        parts = [f"== {self.name}", lines[0].rstrip(), rule, *(line.rstrip() for line in lines[1:])]
        return "\n".join([*parts, self.note] if self.note else parts) + "\n"

    def write(self, folder: Path) -> None:
        """Write the figures to `NAME.csv` in a folder. Raises OSError."""
        folder.mkdir(parents=True, exist_ok=True)
        with (folder / f"{self.name}.csv").open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(self.columns)
            writer.writerows(self.rows)


def _shown(figure: Figure) -> str:
    return f"{figure:.3g}" if isinstance(figure, float) else str(figure)
