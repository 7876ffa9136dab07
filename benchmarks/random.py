"""Blocks in random towers, planned by the complete program, beside planners of its PDDL."""

from time import process_time

import crow
from benchmarks.peers import cpu_seconds
from benchmarks.plot import Plot
from benchmarks.table import Figure, Table
from benchmarks.towers import instance, random_towers

_SIZES = (8, 10, 12, 15, 17, 20)
_SEEDS = 5
_LIMIT = 60
_COLUMNS = ("blocks", "seed", "status", "steps", "nodes", "CPU s", "pyperplan", "fast downward")
_NOTE = (
    "targets: all solved at 12 in at most 10 s each, ahead of pyperplan (gbf, hff) at every size;"
    " 20 in at most 60 s. Peers (lama-first for Fast Downward) are CPU s of whole processes"
)


def run(quick: bool) -> Table:
    """Each instance with `auto` and the peers."""
    sizes, seeds = (_SIZES[:2], 1) if quick else (_SIZES, _SEEDS)
    rows = tuple(_row(count, seed) for count in sizes for seed in range(seeds))
    ys = ("CPU s", "pyperplan", "fast downward")
    plot = Plot("blocks", ys, "CPU seconds", scale="semilogy")
    return Table("random", _COLUMNS, rows, _NOTE, (plot,))


def _row(count: int, seed: int) -> tuple[Figure, ...]:
    task = instance(*random_towers(count, seed))
    started = process_time()
    result = crow.plan(task.problem, time_limit=_LIMIT)
    seconds = process_time() - started
    steps: Figure = len(result.steps) if result.status == "plan" else "-"
    peers = (cpu_seconds(name, task.pddl, _LIMIT) for name in ("pyperplan", "up_fast_downward"))
    return (count, seed, result.status, steps, result.statistics["nodes"], seconds, *peers)
