"""Rows to what charts show: cactus, success against time, and one configuration against another."""

from collections.abc import Sequence
from itertools import combinations
from typing import Final

from cdlc.bench.tables import Row, labels_of
from cdlc.view.charts import Chart, Curve

_MOST_PAIRS: Final = 6
_LEAST_SECONDS: Final = 1e-4
"""What is quicker is shown like this, on scales that have no 0."""


def charts(rows: Sequence[Row]) -> list[Chart]:
    """All charts of a report."""
    labels = labels_of(rows)
    pairs = list(combinations(labels, 2))[:_MOST_PAIRS]
    return [_cactus(rows), _success(rows), *(_scatter(rows, *pair) for pair in pairs)]


def _cactus(rows: Sequence[Row]) -> Chart:
    """How long the n quickest runs took, each."""
    curves = []
    for label in labels_of(rows):
        seconds = _solved_seconds(rows, label)
        curves.append(Curve(label, tuple(map(float, range(1, len(seconds) + 1))), seconds))
    return Chart(
        "cactus", "Runs solved within a time each", "runs solved", "seconds of a run",
        tuple(curves), scale="semilogy",
    )  # fmt: skip


def _success(rows: Sequence[Row]) -> Chart:
    """Which share of the runs is solved after so long."""
    curves = []
    most = max((row.seconds for row in rows), default=1.0)
    for label in labels_of(rows):
        total = sum(row.label == label for row in rows)
        seconds = _solved_seconds(rows, label)
        shares = [100 * number / total for number in range(1, len(seconds) + 1)]
        start = (min(seconds, default=_LEAST_SECONDS), 0.0)
        points = [start, *zip(seconds, shares, strict=True)]
        points.append((max(most, _LEAST_SECONDS), points[-1][1]))
        xs, ys = zip(*points, strict=True)
        curves.append(Curve(label, xs, ys))
    return Chart(
        "success", "Success against time", "seconds", "% of runs solved", tuple(curves),
        scale="semilogx", is_stepped=True,
    )  # fmt: skip


def _scatter(rows: Sequence[Row], one: str, other: str) -> Chart:
    """Each run of two configurations, by its time in both; what was not solved is at the rim."""
    chosen = [row for row in rows if row.label in (one, other)]
    rim = 2 * max((_seconds(row) for row in chosen), default=1.0)
    times = {
        (row.label, row.file, row.seed): _seconds(row) if row.is_solved else rim for row in chosen
    }
    folders = sorted({row.folder for row in chosen})
    curves = []
    for folder in folders:
        keys = [(r.file, r.seed) for r in chosen if r.label == one and r.folder == folder]
        both = [(times[one, *key], times[other, *key]) for key in keys if (other, *key) in times]
        if both:
            xs, ys = zip(*both, strict=True)
            curves.append(Curve(folder, xs, ys))
    name = f"scatter-{labels_of(rows).index(one) + 1}-{labels_of(rows).index(other) + 1}"
    return Chart(
        name, f"{one} against {other}", f"seconds, {one}", f"seconds, {other}", tuple(curves),
        scale="loglog", rim=rim,
    )  # fmt: skip


def _solved_seconds(rows: Sequence[Row], label: str) -> tuple[float, ...]:
    return tuple(sorted(_seconds(row) for row in rows if row.label == label and row.is_solved))


def _seconds(row: Row) -> float:
    return max(row.seconds, _LEAST_SECONDS)
