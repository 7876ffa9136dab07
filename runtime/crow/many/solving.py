"""Many problems, each on its own: `crow.solve_many`."""

from collections.abc import Callable, Collection, Generator, Iterable, Iterator
from contextlib import ExitStack
from typing import Literal

from crow.many.attempt import Outcome
from crow.many.executors import Executor, Finished, InProcess
from crow.many.records import Fault, Record
from crow.many.tasks import Configuration, Task
from crow.problem import Problem

ExecutorName = Literal["in-process", "processes", "ray"]


def solve_many(
    problems: Iterable[Problem | Task],
    configuration: Configuration | None = None,
    *,
    jobs: int | None = None,
    executor: Executor | ExecutorName | None = None,
) -> Iterator[Record]:
    """Plan for each problem; the records come in the order in which searches end.

    `problems` are taken as there is room for them, and one ahead, so that there may be any number;
    a `Task` has a configuration of its own. With `jobs` more than 1 they are solved by processes on
    this machine, else in this process, unless `executor` says otherwise: `in-process`, `processes`,
    `ray`, or an executor, which stays open. Each problem has one record in the end, a fault if need
    be. Whatever way the iterator is left, what still runs is ended.

    Raises crow.WorkersError when processes do not start, and what iterating over `problems` raises.
    """
    usual = configuration or Configuration()
    tasks = (p if isinstance(p, Task) else Task(p, usual) for p in problems)
    return _solved(tasks, jobs, executor)


def _solved(
    tasks: Iterable[Task], jobs: int | None, executor: Executor | ExecutorName | None
) -> Iterator[Record]:
    with ExitStack() as at_end:
        yield from records(opened(executor, jobs, at_end), tasks)


def opened(
    executor: Executor | ExecutorName | None, jobs: int | None, at_end: ExitStack
) -> Executor:
    """The executor that is meant; one that is made here is closed at the end.

    Raises ValueError for one that there is not.
    """
    if jobs is not None and jobs < 1:
        raise ValueError(f"there has to be at least one job, not {jobs}")
    match executor:
        case None if jobs is None or jobs == 1:
            return at_end.enter_context(InProcess())
        case "in-process":
            return at_end.enter_context(InProcess())
        case None | "processes":
            from crow.many.processes import Processes

            return at_end.enter_context(Processes(jobs))
        case "ray":
            from crow.many.cluster import Ray

            return at_end.enter_context(Ray())
        case str():
            raise ValueError(f"no executor `{executor}`; there are in-process, processes and ray")
        case _:
            return executor


def records(
    executor: Executor,
    tasks: Iterable[Task],
    unwanted: Callable[[], Collection[int]] = tuple,
) -> Generator[Record, None, None]:
    """The records of tasks as they end, the executor kept full.

    `unwanted` are numbers of tasks that are no longer of interest, asked for after each record:
    they are cancelled and have none.
    """
    upcoming = enumerate(tasks)
    ahead = next(upcoming, None)  # taken while others run: to make it may take a while
    running: dict[int, Task] = {}
    try:
        while running or ahead is not None:
            while ahead is not None and executor.room > 0:
                number, task = ahead
                if number not in unwanted():
                    running[number] = task
                    executor.submit(number, task)
                ahead = next(upcoming, None)
            if not running:
                continue
            yield from _told(executor.wait(), running)
            if losers := running.keys() & set(unwanted()):
                executor.cancel(losers)
                for number in losers:
                    del running[number]
    finally:
        if running:
            executor.cancel(running.keys())


def _told(ended: list[Finished], running: dict[int, Task]) -> Iterator[Record]:
    for one in ended:
        yield record_of(one.number, running.pop(one.number), one.outcome, one.seconds)


def record_of(number: int, task: Task, outcome: Outcome, seconds: float) -> Record:
    """What became of a task, with what it was."""
    result, fault = (None, outcome) if isinstance(outcome, Fault) else (outcome, None)
    return Record(
        number,
        task.key or task.problem.name,
        task.problem.name,
        task.configuration,
        result,
        fault,
        seconds,
    )
