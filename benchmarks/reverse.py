"""Reversing one tower of blocks, with the conjuncts of the goal in different orders."""

import random
from time import process_time

import crow
from benchmarks.peers import cpu_seconds
from benchmarks.plot import Plot
from benchmarks.table import Figure, Table
from benchmarks.towers import instance, names

_SIZES = (5, 10, 20, 50)
_LIMIT = 60
_COLUMNS = ("blocks", "goal", "status", "steps", "nodes", "CPU s", "pyperplan", "fast downward")
_NOTE = "target: 50 in at most 1 s, all orders alike within 3 times; authors: 5 in over 60 s"


def run(quick: bool) -> Table:
    """Each size with the goal bottom-up, top-down and shuffled."""
    sizes = _SIZES[:2] if quick else _SIZES
    orders = ("bottom-up", "top-down", "shuffled")
    rows = tuple(_row(n, o) for n in sizes for o in orders)
    plots = (
        Plot("blocks", ("CPU s",), "CPU seconds", by="goal"),
        Plot("blocks", ("CPU s", "pyperplan", "fast downward"), "CPU seconds", name="-peers"),
    )
    return Table("reverse", _COLUMNS, rows, _NOTE, plots)


def _row(count: int, order: str) -> tuple[Figure, ...]:
    tower = names(count)
    # The tower stands with its last block on top, which is to be at the bottom.
    goal = [(tower[i], tower[i + 1]) for i in range(count - 1)][::-1]
    if order == "top-down":
        goal.reverse()
    elif order == "shuffled":
        random.Random(count).shuffle(goal)  # noqa: S311 - the same everywhere
    task = instance([tower], goal)
    started = process_time()
    result = crow.plan(task.problem, time_limit=_LIMIT)
    seconds = process_time() - started
    steps: Figure = len(result.steps) if result.status == "plan" else "-"
    peers = (cpu_seconds(name, task.pddl, _LIMIT) for name in ("pyperplan", "up_fast_downward"))
    return (count, order, result.status, steps, result.statistics["nodes"], seconds, *peers)
