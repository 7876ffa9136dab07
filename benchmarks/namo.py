"""Navigation among movable obstacles: maps and strategies of the paper (§3.2, Fig. 3)."""

from statistics import median
from time import perf_counter, process_time

import crow
from benchmarks.plot import Plot
from benchmarks.table import Figure, Table
from examples import namo

_SEEDS = 10
_LIMIT = 60
_COLUMNS = (
    "map", "strategy", "seed", "status", "steps", "nodes", "samples", "CPU s", "wall s", "solved %",
)  # fmt: skip
_TARGETS = (
    "targets: plans for each seed of direct on easy, waypoint on easy, medium, interleaved on all,"
    " and `unsolvable` elsewhere; medians of CPU s at most .2 on easy, .5 on medium, 1 on hard"
)
Row = tuple[Figure, ...]


def run(quick: bool) -> Table:
    """Each map by each strategy with several seeds; those that were solved by their time."""
    seeds = range(2 if quick else _SEEDS)
    namo.problem(namo.MAPS[0])  # imports
    rows: list[Row] = []
    notes = []
    for name in namo.MAPS:
        for strategy in namo.STRATEGIES:
            found = [_row(name, strategy, seed) for seed in seeds]
            rows += _with_shares(found)
            notes.append(_summary(name, strategy, found))
    plot = Plot(
        "wall s",
        ("solved %",),
        "solved, %",
        by="strategy",
        panels="map",
        scale="semilogx",
        steps=True,
    )
    return Table("namo", _COLUMNS, tuple(rows), "\n".join([*notes, _TARGETS]), (plot,))


def _row(name: str, strategy: namo.Strategy, seed: int) -> Row:
    problem = namo.problem(name, strategy)
    cpu, wall = process_time(), perf_counter()
    result = crow.plan(problem, seed=seed, time_limit=_LIMIT)
    cpu, wall = process_time() - cpu, perf_counter() - wall
    steps: Figure = len(result.steps) if isinstance(result, crow.Plan) else "-"
    figures = result.statistics
    return (
        name,
        strategy,
        seed,
        result.status,
        steps,
        figures["nodes"],
        samples(figures),
        cpu,
        wall,
    )


def samples(figures: dict[str, object]) -> int:
    """How many values were drawn."""
    generators = figures.get("generators", {})
    assert isinstance(generators, dict)
    return sum(one["yielded"] for one in generators.values())


def _with_shares(found: list[Row]) -> list[Row]:
    """The rows by time, each with the share of runs that were solved until then."""
    by_time = sorted(found, key=lambda row: row[-1])
    solved, rows = 0, []
    for row in by_time:
        solved += row[3] == "plan"
        rows.append((*row, 100 * solved / len(found) if row[3] == "plan" else "-"))
    return rows


def _summary(name: str, strategy: str, found: list[Row]) -> str:
    statuses = [row[3] for row in found]
    counted = ", ".join(f"{statuses.count(s)} {s}" for s in dict.fromkeys(statuses))
    cpu = median(float(row[-2]) for row in found)
    return f"{name:<6}  {strategy:<11}  {counted}; median CPU {cpu:.2g} s"
