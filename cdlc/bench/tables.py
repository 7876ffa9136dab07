"""Records to tables: what was solved, how it ended, and how long it took."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePosixPath
from statistics import fmean, median
from typing import Any, Final

STATUSES: Final = ("plan", "unsolvable", "limit", "timeout", "memory", "fault")
SOLVED: Final = ("plan", "unsolvable")
"""A plan, or a proof that there is none."""

_MOST_FAULTS: Final = 20


@dataclass(frozen=True, slots=True)
class Row:
    """One run, as tables and charts need it; `label` is that of its configuration, seeds aside."""

    label: str
    folder: str
    file: str
    seed: int
    status: str
    seconds: float
    nodes: float | None
    steps: int | None
    fault: str

    @property
    def is_solved(self) -> bool:
        """Whether there is a plan, or a proof that there is none."""
        return self.status in SOLVED


@dataclass(frozen=True, slots=True)
class Table:
    """A table: a title, headings and rows of text, and what is to be said of it."""

    title: str
    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str = ""


def rows_of(documents: Iterable[Mapping[str, Any]], prefix: str = "") -> list[Row]:
    """The rows of records; of two with one key the first counts."""
    unique = {document["key"]: document for document in reversed(list(documents))}
    documents = list(reversed(unique.values()))
    labels = _labels([document["configuration"] for document in documents])
    return [
        Row(
            prefix + label,
            PurePosixPath(document.get("file", "")).parent.name or ".",
            document.get("file", document["problem"]),
            document["configuration"].get("seed", 0),
            document["status"],
            document["seconds"],
            document.get("statistics", {}).get("nodes"),
            len(document["steps"]) if document["status"] == "plan" else None,
            _fault(document.get("fault")),
        )
        for document, label in zip(documents, labels, strict=True)
    ]


def _fault(fault: Mapping[str, Any] | None) -> str:
    if fault is None:
        return ""
    lines = str(fault.get("message", "")).splitlines() or [""]
    return f"{fault.get('kind')}: {lines[0]}"


def _labels(configurations: Sequence[Mapping[str, Any]]) -> list[str]:
    """What each configuration is called: its name, or its engine and what differs from others."""
    keys = {key for one in configurations for key in one} - {"engine", "seed", "name"}
    differing = [k for k in sorted(keys) if len({str(one.get(k)) for one in configurations}) > 1]
    labels = []
    for one in configurations:
        parts = [f"{key}={one[key]}" for key in differing if key in one]
        labels.append(one.get("name") or " ".join([str(one.get("engine")), *parts]))
    return labels


# ------------------------------------------------------------------------------------------- tables


def tables(rows: Sequence[Row]) -> list[Table]:
    """All tables of a report."""
    made = [_endings(rows), _coverage(rows), _times(rows)]
    return [*made, _faults(rows)] if any(row.status == "fault" for row in rows) else made


def labels_of(rows: Iterable[Row]) -> list[str]:
    """The labels of rows, in the order in which they come."""
    return list(dict.fromkeys(row.label for row in rows))


def _endings(rows: Sequence[Row]) -> Table:
    found = []
    for label in labels_of(rows):
        count = Counter(row.status for row in rows if row.label == label)
        found.append((label, *(str(count[status]) for status in STATUSES), str(count.total())))
    return Table("How runs ended", ("configuration", *STATUSES, "runs"), tuple(found))


def _coverage(rows: Sequence[Row]) -> Table:
    labels = labels_of(rows)
    folders = sorted({row.folder for row in rows})
    found = [(folder, *_shares(rows, folder, labels)) for folder in folders]
    found.append(("all", *_shares(rows, None, labels)))
    note = "Runs with a plan, or a proof that there is none, of all runs."
    return Table("Coverage", ("folder", *labels), tuple(found), note)


def _shares(rows: Sequence[Row], folder: str | None, labels: Sequence[str]) -> list[str]:
    chosen = [row for row in rows if folder in (None, row.folder)]
    shares = []
    for label in labels:
        own = [row.is_solved for row in chosen if row.label == label]
        shares.append(f"{sum(own)}/{len(own)}")
    return shares


_TIMES: Final = ("median s", "90 % s", "most s", "all s", "shared s", "nodes", "steps")


def _times(rows: Sequence[Row]) -> Table:
    shared = shared_by_all(rows)
    found = []
    for label in labels_of(rows):
        solved = [row for row in rows if row.label == label and row.is_solved]
        seconds = sorted(row.seconds for row in solved)
        common = [row.seconds for row in solved if (row.file, row.seed) in shared]
        nodes = [row.nodes for row in solved if row.nodes is not None]
        steps = [row.steps for row in solved if row.steps is not None]
        cells = (
            _shown(median, seconds),
            _shown(_ninth, seconds),
            _shown(max, seconds),
            _shown(sum, seconds),
            _shown(sum, common),
            _shown(median, nodes),
            _shown(fmean, steps),
        )
        found.append((label, *cells))
    note = (
        "Of runs that were solved. Shared: all seconds of those that each configuration solved"
        f" ({len(shared)} of each); nodes are a median, steps a mean over plans."
    )
    return Table("Times", ("configuration", *_TIMES), tuple(found), note)


def shared_by_all(rows: Sequence[Row]) -> frozenset[tuple[str, int]]:
    """The runs, by file and seed, that every configuration solved."""
    each = [
        {(row.file, row.seed) for row in rows if row.label == label and row.is_solved}
        for label in labels_of(rows)
    ]
    return frozenset(set.intersection(*each)) if each else frozenset()


def _ninth(ordered: Sequence[float]) -> float:
    """What nine of ten stay within."""
    return ordered[max(0, -(-9 * len(ordered) // 10) - 1)]


def _shown(measure: Any, figures: Sequence[float]) -> str:
    return f"{measure(figures):,.4g}" if figures else "-"


def _faults(rows: Sequence[Row]) -> Table:
    faulty = [row for row in rows if row.status == "fault"]
    found = [(row.file, row.label, str(row.seed), row.fault) for row in faulty[:_MOST_FAULTS]]
    more = len(faulty) - len(found)
    note = f"And {more} more." if more else ""
    return Table("Faults", ("file", "configuration", "seed", "fault"), tuple(found), note)


def text(table: Table) -> str:
    """A table with aligned columns: the first to the left, figures to the right."""
    lines = [table.headings, *table.rows]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    told = [f"{table.title}\n"]
    is_prose = table.title == "Faults"
    for line in lines:
        cells = [
            cell.ljust(width) if is_prose or not number else cell.rjust(width)
            for number, (cell, width) in enumerate(zip(line, widths, strict=True))
        ]
        told.append("  " + "  ".join(cells).rstrip() + "\n")
    return "".join(told)
