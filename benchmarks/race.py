"""Racing seeds on the hard map: the time to the first plan with one job and with two.

Each trial has seeds of its own. With one job they are tried in turn, each up to the limit; with two
the first plan of two at a time wins. Processes have started before anything is timed.
"""

import multiprocessing
import os
from pathlib import Path
from statistics import median, quantiles
from time import perf_counter

import crow
from benchmarks.table import Figure, Table
from examples import namo

_TRIALS = 40
_SEEDS = 4
_LIMIT = 60
_COLUMNS = (
    "jobs", "trials", "plans", "median CPU s", "90 % CPU s", "median wall s", "90 % wall s",
    "nodes of the winner",
)  # fmt: skip
_NOTE = (
    "target: the median with two jobs below that with one, from the problem to the plan. CPU is"
    " that of the process that used most of it: the time it takes where each has a core of its own;"
    " nodes are a median"
)
Measured = tuple[float, float, float]


def run(quick: bool) -> Table:
    """The same trials with one job and with two, by turns, so that both have the same machine."""
    trials = 3 if quick else _TRIALS
    problem = namo.problem("hard")
    found: dict[int, list[Measured]] = {1: [], 2: []}
    with crow.Processes(1) as one, crow.Processes(2) as two:
        executors = {1: one, 2: two}
        for executor in executors.values():
            easy = [namo.problem("easy")] * 4
            list(crow.solve_many(easy, executor=executor))
        for trial in range(trials):
            for jobs, executor in executors.items():
                found[jobs].append(_raced(problem, trial, executor))
    rows = tuple(_row(jobs, measured) for jobs, measured in found.items())
    return Table("race", _COLUMNS, rows, _NOTE)


def _raced(problem: crow.Problem, trial: int, executor: crow.Processes) -> Measured:
    """CPU and wall seconds until there is a plan, and the nodes it took."""
    seeds = range(_SEEDS * trial, _SEEDS * (trial + 1))
    configurations = [crow.Configuration(seed=seed, time_limit=_LIMIT) for seed in seeds]
    before = _cpu_seconds()
    began = perf_counter()
    race = crow.race(problem, configurations, executor=executor)
    seconds = perf_counter() - began
    after = _cpu_seconds()
    assert isinstance(race.result, crow.Plan), race
    used = max(after[pid] - before.get(pid, 0.0) for pid in after)
    return used, seconds, race.result.statistics["nodes"]


def _cpu_seconds() -> dict[int, float]:
    """The CPU seconds of each worker so far."""
    ticks = os.sysconf("SC_CLK_TCK")
    found = {}
    for child in multiprocessing.active_children():
        assert child.pid is not None
        figures = Path(f"/proc/{child.pid}/stat").read_text().rsplit(")", 1)[1].split()
        found[child.pid] = (int(figures[11]) + int(figures[12])) / ticks
    return found


def _row(jobs: int, measured: list[Measured]) -> tuple[Figure, ...]:
    cpu, wall, nodes = zip(*measured, strict=True)
    return (
        jobs, len(measured), len(measured), median(cpu), quantiles(cpu, n=10)[-1],
        median(wall), quantiles(wall, n=10)[-1], median(nodes),
    )  # fmt: skip
