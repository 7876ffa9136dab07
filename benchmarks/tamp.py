"""Picking and placing with continuous poses: task and motion planning as a peer ships it."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from statistics import median
from time import process_time
from typing import TYPE_CHECKING

import numpy as np

import crow
from benchmarks.namo import samples
from benchmarks.plot import Plot
from benchmarks.table import Figure, Table
from examples import pickplace
from examples.pickplace import world

if TYPE_CHECKING:
    from crow import StateView

_SEEDS = 10
_LIMIT = 60
_MOST = 5
_PROBLEMS: dict[str, Callable[[int], crow.Problem]] = {
    "tight": pickplace.tight,
    "blocked": pickplace.blocked,
    "crowded": pickplace.crowded,
}
_OF_PEER = {"tight": 2, "blocked": 3}
_COLUMNS = ("problem", "blocks", "seed", "status", "steps", "nodes", "samples", "CPU s")
_NOTE = """\
Places beside other things come first, then random ones; `uniform`: random ones alone, as the peer
has them. Targets: all solved, five times as fast as PDDLStream. Its adaptive algorithm took .34-.59
CPU s on tight with 2 blocks and .7-1.3 on blocked with 3, measured once elsewhere; its others
failed. PyPI does not have it, so it does not run here. CPU s are those of `crow.plan`."""
Row = tuple[Figure, ...]


def run(quick: bool) -> Table:
    """Each problem in several sizes, with several seeds; two of them as the peer has them, too."""
    crow.plan(pickplace.gate())  # imports
    most, seeds = (3, 2) if quick else (_MOST, _SEEDS)
    cases = [(name, made(n), n) for name, made in _PROBLEMS.items() for n in range(2, most + 1)]
    cases += [
        (f"{name}, uniform", uniformly(_PROBLEMS[name](n)), n) for name, n in _OF_PEER.items()
    ]
    rows: list[Row] = []
    notes = []
    for name, problem, count in cases:
        found = [_row(name, problem, count, seed) for seed in range(seeds)]
        notes.append(_summary(f"{name:<16}  {count} blocks", found))
        rows += found
    plot = Plot("blocks", ("CPU s",), "CPU seconds", by="problem", scale="semilogy")
    return Table("tamp", _COLUMNS, tuple(rows), "\n".join([*notes, _NOTE]), (plot,))


def _row(name: str, problem: crow.Problem, count: int, seed: int) -> Row:
    started = process_time()
    result = crow.plan(problem, seed=seed, time_limit=_LIMIT)
    seconds = process_time() - started
    steps: Figure = len(result.steps) if isinstance(result, crow.Plan) else "-"
    figures = result.statistics
    return (name, count, seed, result.status, steps, figures["nodes"], samples(figures), seconds)


def _summary(case: str, found: list[Row]) -> str:
    solved = sum(row[3] == "plan" for row in found)
    cpu = [float(row[-1]) for row in found]
    shown = f"median {median(cpu):.2g}, least {min(cpu):.2g}, most {max(cpu):.2g}"
    return f"{case}  {solved} of {len(found)} solved; CPU s {shown}"


def uniformly(problem: crow.Problem) -> crow.Problem:
    """The problem with places drawn from all of a region alike."""
    given = problem.world.registered
    generators = {**given.generators, "spots": replace(given.generators["spots"], call=_uniform)}
    own = replace(problem.world, registered=replace(given, generators=generators))
    return problem.changed(world=own)


def _uniform(
    state: "StateView", b: str, r: str, *, rng: np.random.Generator
) -> Iterator[world.Floats]:
    room = world.shrunk(np.asarray(state.area(r)), np.asarray(state.size(b)))
    while True:
        yield world.uniform(room, world.RANDOM, rng)
