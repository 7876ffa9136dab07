"""Rooms full of obstacles, from 25 to 900 cells each, beside Fast Downward on a map of cells."""

from time import process_time

import crow
from benchmarks.namo import samples
from benchmarks.namo_pddl import pddl_of
from benchmarks.peers import cpu_seconds
from benchmarks.plot import Plot
from benchmarks.table import Figure, Table
from examples import namo

_SIZES = ((5, 4), (10, 7), (20, 10), (30, 14))
_SEEDS = 3
_LIMIT = 60
_PEER_LIMIT = 200
_COLUMNS = (
    "kind", "room", "obstacles", "seed", "status", "steps", "walked", "nodes", "samples", "CPU s",
    "fast downward",
)  # fmt: skip
_NOTE = (
    "three rooms in a row, or along a corridor, each as many cells wide and high; direct program."
    " Target: at most 5 CPU s in rooms of 30 by 30. Fast Downward: lama-first, whole process"
)


def run(quick: bool) -> Table:
    """Maps of growing rooms, a few of each size."""
    sizes, seeds = (_SIZES[:1], 1) if quick else (_SIZES, _SEEDS)
    kinds = ("suite",) if quick else ("suite", "corridor")
    namo.problem(namo.MAPS[0])  # imports
    rows = tuple(
        _row(kind, *size, seed) for kind in kinds for size in sizes for seed in range(seeds)
    )
    plot = Plot("room", ("CPU s", "fast downward"), "CPU seconds", panels="kind")
    return Table("rooms", _COLUMNS, rows, _NOTE, (plot,))


def _row(kind: str, size: int, obstacles: int, seed: int) -> tuple[Figure, ...]:
    text = (namo.suite if kind == "suite" else namo.corridor)(size, obstacles, seed)
    problem = namo.problem(text, "direct")
    started = process_time()
    result = crow.plan(problem, seed=seed, time_limit=_LIMIT)
    seconds = process_time() - started
    steps, walked = _lengths(result)
    peer: Figure = "-"
    if seed == 0:  # it takes minutes
        peer = cpu_seconds("up_fast_downward", pddl_of(text), _PEER_LIMIT)
    figures = result.statistics
    return (
        kind, size, obstacles, seed, result.status, steps, walked, figures["nodes"],
        samples(figures), seconds, peer,
    )  # fmt: skip


def _lengths(result: crow.Result) -> tuple[Figure, Figure]:
    """Steps of a plan, and cells that are walked."""
    if not isinstance(result, crow.Plan):
        return "-", "-"
    walks = [s.arguments[0] for s in result.steps if s.controller == "exec_traj"]
    return len(result.steps), sum(len(walk) - 1 for walk in walks)
