"""Processes of the standard library as an executor.

Each worker has a pipe of its own and one task at a time, so whatever happens to it, it is known
which task that concerns (docs/decisions/0026-workers-of-our-own.md).
"""

import multiprocessing
import os
import pickle
import signal
from collections import deque
from collections.abc import Collection, Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from math import inf
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from time import monotonic
from typing import Any, Final

from crow.many.executors import Closing, Finished
from crow.many.packing import NotSent, Packed, Packer, Recent
from crow.many.records import Fault
from crow.many.tasks import Task
from crow.many.worker import BEGUN, READY, work

GRACE: Final = 5.0
"""Seconds beyond a time limit after which a search that goes on is ended from outside."""

_SECONDS_TO_LOAD: Final = 60.0
"""So much more a task with a time limit may take until its search begins."""

_PATIENCE: Final = 0.25
"""Seconds in which a worker may stop what is cancelled, and stay for what is next."""

_MOST_FAILURES: Final = 5
"""So often a worker may die on its way up, one after another, before that is an error."""


class WorkersError(RuntimeError):
    """Worker processes do not start; the message says what may be the matter."""


@dataclass(slots=True)
class _Worker:
    """A process, what it is at, and which parts of problems it has."""

    process: SpawnProcess
    pipe: Connection
    is_ready: bool = False
    number: int | None = None
    packed: Packed | None = None
    sent: float = 0.0
    deadline: float = inf
    parts: Recent[bool] = field(default_factory=Recent)


class Processes(Closing):
    """Processes on this machine, as many as there are cores unless `jobs` says otherwise.

    They start when they are needed and stay until `close`. `grace` is how many seconds beyond its
    time limit a search may go on before its process is killed. Like everything that starts
    processes afresh, in a script it belongs under `if __name__ == "__main__":`.
    """

    def __init__(self, jobs: int | None = None, *, grace: float = GRACE) -> None:
        self.jobs = cores() if jobs is None else jobs
        if self.jobs < 1:
            raise ValueError(f"there has to be at least one job, not {jobs}")
        self._grace = grace
        self._packer = Packer()
        self._workers: list[_Worker] = []
        self._ended: deque[Finished] = deque()
        self._has_started = False
        self._failures = 0

    @property
    def room(self) -> int:
        """How many workers have nothing to do, those not started yet included."""
        return self.jobs - sum(worker.number is not None for worker in self._workers)

    def submit(self, number: int, task: Task) -> None:
        """Send a task to a worker."""
        try:
            packed = self._packer.pack(task)
        except NotSent as error:
            self._ended.append(Finished(number, Fault("not-sent", str(error)), 0.0))
            return
        self.submit_packed(number, packed)

    def submit_packed(self, number: int, packed: Packed) -> None:
        """Send a task that was packed elsewhere."""
        idle = [worker for worker in self._workers if worker.number is None]
        dead = [worker for worker in idle if not worker.process.is_alive()]
        self._end(dead)  # of nothing that a task has done
        idle = [worker for worker in idle if worker not in dead]
        worker = idle[0] if idle else self._started()
        self._send(worker, number, packed)

    def wait(self, most: float = inf) -> list[Finished]:
        """Wait until some task has ended, was given up, or its worker has died.

        After `most` seconds that may be none.
        """
        end = monotonic() + most
        while not self._ended and (most == inf or monotonic() < end):
            busy = [worker for worker in self._workers if worker.number is not None]
            nearest = min(end, *(worker.deadline for worker in busy))
            timeout = None if nearest == inf else max(0.0, nearest - monotonic())
            handles: list[Any] = [w.pipe for w in busy] + [w.process.sentinel for w in busy]
            told = set(wait(handles, timeout))
            for worker in busy:
                if worker.pipe in told or worker.process.sentinel in told:
                    self._hear(worker)
                elif monotonic() >= worker.deadline:
                    self._give_up(worker)
        ended = list(self._ended)
        self._ended.clear()
        return ended

    def cancel(self, numbers: Collection[int]) -> None:
        """Stop the workers that are at these tasks; those that do not hear are killed."""
        concerned = [w for w in self._workers if w.number is not None and w.number in numbers]
        starting = [worker for worker in concerned if not worker.is_ready]
        self._end(starting)
        stopping = [worker for worker in concerned if worker not in starting]
        for worker in stopping:
            worker.process.terminate()
        deadline = monotonic() + _PATIENCE
        self._end([worker for worker in stopping if not self._has_stopped(worker, deadline)])
        self._ended = deque(one for one in self._ended if one.number not in numbers)

    def _has_stopped(self, worker: _Worker, deadline: float) -> bool:
        """Whether a worker has answered in time, and has nothing to do any more."""
        while worker.number is not None and worker in self._workers:
            if not wait([worker.pipe], max(0.0, deadline - monotonic())):
                return False
            try:
                self._take(worker, worker.pipe.recv_bytes())
            except (EOFError, OSError):
                return False
        return True

    def close(self) -> None:
        """Kill all workers."""
        self._end(self._workers)
        self._ended.clear()

    # -------------------------------------------------------------------------------- one worker

    def _started(self) -> _Worker:
        context = multiprocessing.get_context("spawn")
        own, other = context.Pipe()
        process = context.Process(target=work, args=(other,), name="crow worker", daemon=True)
        process.start()
        other.close()  # the worker's end: its death is to close the last one
        worker = _Worker(process, own)
        self._workers.append(worker)
        return worker

    def _send(self, worker: _Worker, number: int, packed: Packed) -> None:
        new = {}
        for key, data in packed.parts.items():  # in the order in which the worker looks for them
            if worker.parts.get(key) is None:
                worker.parts.put(key, value=True)
                new[key] = data
        limit = packed.configuration.time_limit
        worker.number, worker.packed, worker.sent = number, packed, monotonic()
        worker.deadline = (
            inf if limit is None else worker.sent + limit + max(self._grace, _SECONDS_TO_LOAD)
        )
        with suppress(OSError):  # it has died, which is noticed where its answer is waited for
            worker.pipe.send_bytes(pickle.dumps((new, packed.body, packed.configuration)))

    def _hear(self, worker: _Worker) -> None:
        """Take what a worker says, or note that it will say no more."""
        try:
            if not worker.pipe.poll():
                raise EOFError
            message = worker.pipe.recv_bytes()
        except (EOFError, OSError):
            self._lost(worker)
            return
        self._take(worker, message)

    def _take(self, worker: _Worker, message: bytes) -> None:
        """What a worker says: that it is there, that its search begins, or how that ended."""
        assert worker.number is not None
        if message == READY:
            worker.is_ready = self._has_started = True
            self._failures = 0
        elif message == BEGUN:
            assert worker.packed is not None
            limit = worker.packed.configuration.time_limit
            if limit is not None:
                worker.deadline = monotonic() + limit + self._grace
        else:
            outcome, seconds, is_spent = pickle.loads(message)  # noqa: S301 - from our own worker
            self._ended.append(Finished(worker.number, outcome, seconds))
            worker.number = worker.packed = None
            if is_spent:
                self._end([worker])

    def _lost(self, worker: _Worker) -> None:
        """A worker has died: its task has a fault, unless the worker never was there for it."""
        number, packed, seconds = worker.number, worker.packed, monotonic() - worker.sent
        worker.process.join()
        died = _death(worker.process.exitcode)
        self._end([worker])
        assert number is not None
        assert packed is not None
        if worker.is_ready:
            self._ended.append(Finished(number, Fault("killed", f"its process {died}"), seconds))
            return
        self._failures += 1
        if not self._has_started or self._failures > _MOST_FAILURES:
            raise WorkersError(
                f"worker processes do not start: the last {died}; in a script, what starts them"
                ' has to stand under `if __name__ == "__main__":`'
            )
        self.submit_packed(number, packed)

    def _give_up(self, worker: _Worker) -> None:
        """A task goes on beyond its limit and the grace: its worker is killed."""
        assert worker.number is not None
        assert worker.packed is not None
        limit, seconds = worker.packed.configuration.time_limit, monotonic() - worker.sent
        told = f"it went on for {seconds:.1f} s with a time limit of {limit:g} s, and was killed"
        self._ended.append(Finished(worker.number, Fault("hung", told), seconds))
        self._end([worker])

    def _end(self, workers: Iterable[_Worker]) -> None:
        """Kill workers, and wait until they are gone."""
        ended = list(workers)
        self._workers = [worker for worker in self._workers if worker not in ended]
        for worker in ended:
            worker.process.kill()
        for worker in ended:
            worker.process.join()
            worker.process.close()
            worker.pipe.close()


def cores() -> int:
    """How many cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _death(code: int | None) -> str:
    """How a process ended: `was killed by SIGKILL`, `ended with status 3`."""
    if code is None or code >= 0:
        return f"ended with status {code}"
    try:
        name = signal.Signals(-code).name
    except ValueError:
        name = f"signal {-code}"
    return f"was killed by {name}"
