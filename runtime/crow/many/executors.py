"""Where tasks are carried out: the interface of executors, and this process as one."""

from collections import deque
from collections.abc import Collection
from dataclasses import dataclass
from time import monotonic
from types import TracebackType
from typing import Protocol, Self

from crow.many.attempt import Outcome, attempt
from crow.many.tasks import Task


@dataclass(frozen=True, slots=True)
class Finished:
    """How the task of some number ended, and how long it took."""

    number: int
    outcome: Outcome
    seconds: float


class Executor(Protocol):
    """Carries tasks out, one run of `solve_many` or `race` at a time.

    Each task that is submitted and not cancelled is in what `wait` returns exactly once.
    """

    @property
    def room(self) -> int:
        """How many more tasks to submit now; at least 1 if there are none."""

    def submit(self, number: int, task: Task) -> None:
        """Take a task, under a number of its own."""

    def wait(self) -> list[Finished]:
        """Wait until some task has ended."""

    def cancel(self, numbers: Collection[int]) -> None:
        """End these tasks at once, and forget them."""

    def close(self) -> None:
        """End what runs, and all processes that were started."""


class Closing:
    """An executor as a context manager, which is closed at the end."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """End what runs."""
        raise NotImplementedError


class InProcess(Closing):
    """This process: one task after another.

    What ends the process ends them all: Python of the user's that hangs or dies is a fault of one
    task only with executors that have processes. `is_alone` lets it use the timer of the process,
    which has to be in its main thread, and bound its memory.
    """

    def __init__(self, *, is_alone: bool = False) -> None:
        self._is_alone = is_alone
        self._waiting: deque[tuple[int, Task]] = deque()

    @property
    def room(self) -> int:
        """One task."""
        return 1 - len(self._waiting)

    def submit(self, number: int, task: Task) -> None:
        """Keep a task until somebody waits for it."""
        self._waiting.append((number, task))

    def wait(self) -> list[Finished]:
        """Carry a task out."""
        number, task = self._waiting.popleft()
        began = monotonic()
        outcome = attempt(task.problem, task.configuration, is_alone=self._is_alone)
        return [Finished(number, outcome, monotonic() - began)]

    def cancel(self, numbers: Collection[int]) -> None:
        """Forget tasks that have not begun."""
        self._waiting = deque(item for item in self._waiting if item[0] not in numbers)

    def close(self) -> None:
        """Forget all tasks."""
        self._waiting.clear()
