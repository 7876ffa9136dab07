"""Runs to records, in whatever order they end."""

from collections import deque
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from cdlc.bench.loading import Loader
from cdlc.bench.suite import Run
from crow.many.executors import Executor
from crow.many.records import Fault, Record
from crow.many.solving import solve_many
from crow.many.tasks import Task


def documents(runs: Iterable[Run], executor: Executor) -> Iterator[dict[str, Any]]:
    """The record of each run, as a results file has it, as soon as it is there.

    Raises crow.WorkersError when processes do not start.
    """
    lost: deque[dict[str, Any]] = deque()
    files: dict[str, str] = {}

    def tasks() -> Iterator[Task]:
        loader = Loader()
        for run in runs:
            task = loader.task(run)
            if isinstance(task, Fault):
                lost.append(_document(_not_loaded(run, task), run.file))
            else:
                files[task.key] = run.file
                yield task

    for record in solve_many(tasks(), executor=executor):
        while lost:
            yield lost.popleft()
        yield _document(record, files.pop(record.key))
    yield from lost


def _not_loaded(run: Run, fault: Fault) -> Record:
    return Record(-1, run.key, Path(run.file).stem, run.configuration, None, fault, 0.0)


def _document(record: Record, file: str) -> dict[str, Any]:
    told = record.json()
    return {"key": told.pop("key"), "file": file, **told}
