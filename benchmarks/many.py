"""Many small problems: what each executor adds to a task, and whether the driver's memory is bound.

Each row is a process of its own. `nothing`: the goal holds already, so that what is measured is the
way to the worker and back; `small`: four blocks in random towers.
"""

import json
import os
import random
import resource
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from time import perf_counter

import cdlc
import crow
from benchmarks.table import Figure, Table
from benchmarks.towers import BLOCKS, names, on, random_towers
from crow.budget import resident_mb
from crow.many.solving import opened

_COUNT = 10_000
_EXECUTORS = (("in-process", 1), ("processes", 1), ("processes", 2), ("ray", 2))
_COLUMNS = (
    "work", "executor", "jobs", "problems", "start s", "wall s", "CPU s", "a second",
    "ms each", "driver MB, 1/10", "driver MB, end",
)  # fmt: skip
_NOTE = (
    "start: from nothing until the first record is there; wall: all others. CPU is that of the"
    " driver and its processes, but for Ray, whose processes are not the driver's. MB are resident,"
    " when a tenth of the records was there and at the end"
)
_ROOT = Path(__file__).resolve().parent.parent
Measured = dict[str, float]


def run(quick: bool) -> Table:
    """Each executor with each kind of work."""
    rows: list[tuple[Figure, ...]] = []
    count = 40 if quick else _COUNT
    for work in ("nothing", "small"):
        for executor, jobs in _EXECUTORS:
            if executor != "ray" or (_has_ray() and not quick):
                rows.append(_row(work, executor, jobs, count))
    return Table("many", _COLUMNS, tuple(rows), _NOTE)


def _has_ray() -> bool:
    from importlib.util import find_spec

    return find_spec("ray") is not None


def _row(work: str, executor: str, jobs: int, count: int) -> tuple[Figure, ...]:
    command = [sys.executable, "-m", "benchmarks.many", work, executor, str(jobs), str(count)]
    done = subprocess.run(command, check=True, capture_output=True, text=True, cwd=_ROOT)
    found: Measured = json.loads(done.stdout.splitlines()[-1])
    rate = (count - 1) / found["wall"]
    cpu: Figure = "-" if executor == "ray" else found["cpu"]
    return (
        work, executor, jobs, count, found["start"], found["wall"], cpu, rate, 1_000 / rate,
        found["early"], found["end"],
    )  # fmt: skip


def problems(work: str, count: int) -> Iterator[crow.Problem]:
    """Problems one after another, each with a world of its own."""
    domain = cdlc.load(BLOCKS)
    for number in range(count):
        start, goal = random_towers(4, number)
        pairs = on(start) if work == "nothing" else goal
        cells = [("on", pair) for pair in on(start)]
        cells += [("on_table", (tower[0],)) for tower in start]
        cells += [("clear", (tower[-1],)) for tower in start]
        yield crow.Problem(
            domain,
            objects=dict.fromkeys(names(4), "block"),
            init={**dict.fromkeys(cells, True), ("handempty", ()): True},
            goal=" and ".join(f"on({x}, {y})" for x, y in pairs) or "handempty()",
            name=f"p{number}",
        )


def _measured(work: str, executor: str, jobs: int, count: int) -> Measured:
    began = perf_counter()
    figures: Measured = {}
    statuses: Counter[str] = Counter()
    with ExitStack() as at_end:
        name = "in-process" if executor == "in-process" else executor
        used = opened(name, None if executor == "ray" else jobs, at_end)  # type: ignore[arg-type]
        limited = crow.Configuration(node_limit=20_000)
        for record in crow.solve_many(problems(work, count), limited, executor=used):
            statuses[record.status] += 1
            if statuses.total() == 1:
                figures["start"], began = perf_counter() - began, perf_counter()
            if statuses.total() == max(1, count // 10):
                figures["early"] = resident_mb()
        figures["wall"] = perf_counter() - began
        figures["end"] = resident_mb()
    own, others = map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    figures["cpu"] = own.ru_utime + own.ru_stime + others.ru_utime + others.ru_stime
    assert statuses == {"plan": count}, statuses
    return figures


if __name__ == "__main__":
    random.seed(0)
    os.chdir(_ROOT)
    print(json.dumps(_measured(sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4]))))
