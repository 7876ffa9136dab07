"""Racing seeds on the hard map: the time to the first plan with one job and with two.

Each trial has seeds of its own. With one job they are tried in turn, each up to the limit; with two
the first plan of two at a time wins. Processes have started before anything is timed.
"""

from statistics import median, quantiles
from time import perf_counter

import crow
from benchmarks.table import Figure, Table
from examples import namo

_TRIALS = 40
_SEEDS = 4
_LIMIT = 60
_COLUMNS = ("jobs", "trials", "plans", "median s", "90 % s", "most s", "nodes of the winner")
_NOTE = (
    "target: the median with two jobs below that with one. Wall time from the problem to the plan;"
    " nodes are a median"
)


def run(quick: bool) -> Table:
    """The same trials with one job and with two, by turns, so that both have the same machine."""
    trials = 3 if quick else _TRIALS
    problem = namo.problem("hard")
    found: dict[int, list[tuple[float, float]]] = {1: [], 2: []}
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


def _raced(problem: crow.Problem, trial: int, executor: crow.Processes) -> tuple[float, float]:
    seeds = range(_SEEDS * trial, _SEEDS * (trial + 1))
    configurations = [crow.Configuration(seed=seed, time_limit=_LIMIT) for seed in seeds]
    began = perf_counter()
    race = crow.race(problem, configurations, executor=executor)
    seconds = perf_counter() - began
    assert isinstance(race.result, crow.Plan), race
    return seconds, race.result.statistics["nodes"]


def _row(jobs: int, measured: list[tuple[float, float]]) -> tuple[Figure, ...]:
    seconds, nodes = zip(*measured, strict=True)
    return (
        jobs, len(measured), len(measured), median(seconds),
        quantiles(seconds, n=10)[-1], max(seconds), median(nodes),
    )  # fmt: skip
