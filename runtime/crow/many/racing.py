"""One problem in many ways at once: `crow.race`."""

from collections.abc import Iterable, Iterator
from contextlib import ExitStack, closing
from dataclasses import dataclass

from crow.many.executors import Executor
from crow.many.records import Record
from crow.many.solving import ExecutorName, opened, records
from crow.many.tasks import Configuration, Task
from crow.plan import Result
from crow.problem import Problem

DECISIVE = ("plan", "unsolvable")
"""What ends a race: a plan, which was replayed, or a proof that there is none."""


@dataclass(frozen=True, slots=True)
class Race:
    """How a race ended: the winner, if there was one, and the records of all that came to an end.

    Those that were cancelled have none.
    """

    winner: Record | None
    records: tuple[Record, ...]

    @property
    def result(self) -> Result | None:
        """The plan, or why there is none; without a winner, of the first that has something to say.

        None where all configurations ended with faults.
        """
        if self.winner is not None:
            return self.winner.result
        in_order = sorted(self.records, key=lambda record: record.index)
        return next((r.result for r in in_order if r.result is not None), None)


def race(
    problem: Problem,
    configurations: Iterable[Configuration],
    *,
    jobs: int | None = None,
    executor: Executor | ExecutorName | None = None,
    deterministic: bool = False,
) -> Race:
    """Search in several ways at once; the first plan, or proof that there is none, wins.

    The others are ended at once. `deterministic`: of the configurations that decide the problem
    the earliest wins, as if they were tried one after another, and only later ones are ended for
    it; under node limits, another run has the same winner. `jobs` and `executor` are as for
    `solve_many`, but with as many jobs as there are cores; in this process configurations are tried
    in turn.

    Raises ValueError without configurations, and crow.WorkersError.
    """
    given = list(configurations)
    if not given:
        raise ValueError("a race takes at least one configuration")
    if executor is None and jobs is None:
        from crow.many.processes import cores

        jobs = min(len(given), cores())
    with ExitStack() as at_end:
        chosen = opened(executor, jobs, at_end)
        return _raced(problem, given, chosen, deterministic=deterministic)


def _raced(
    problem: Problem,
    configurations: list[Configuration],
    executor: Executor,
    *,
    deterministic: bool,
) -> Race:
    best: Record | None = None
    ended: list[Record] = []

    def wanted() -> Iterator[Task]:
        for configuration in configurations:
            yield Task(problem, configuration)

    def later() -> range:
        """Configurations that cannot win any more."""
        return range(0) if best is None else range(best.index + 1, len(configurations))

    with closing(records(executor, wanted(), later)) as running:
        for record in running:
            ended.append(record)
            if record.status in DECISIVE:
                if best is None or record.index < best.index:
                    best = record
                if not deterministic:
                    break
    return Race(best, tuple(ended))
