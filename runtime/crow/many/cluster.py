"""A Ray cluster as an executor. Only this file imports Ray.

Ray decides where a task runs. There, a process beside Ray's carries it out, as on one machine: so
limits, deaths and hangs end in the same records, and none of them is Ray's.
"""

import atexit
import logging
from collections.abc import Collection, Mapping
from time import monotonic
from typing import Any, Final

from crow.many.attempt import Outcome
from crow.many.executors import Closing, Finished
from crow.many.packing import NotSent, Packed, Packer, Recent
from crow.many.processes import GRACE, Processes, WorkersError
from crow.many.records import Fault
from crow.many.tasks import Configuration, Task

_SECONDS_A_LOOK: Final = 0.05
"""How soon a task hears that Ray cancels it, which does not wake it up."""

_TASKS_A_CORE: Final = 2
"""So many are submitted, so that no core waits for the driver."""


_SECONDS_A_COUNT: Final = 1.0
"""How long the number of cores is taken to be what it was: asking takes a millisecond."""


class RayMissing(ImportError):  # noqa: N818 - about an installation
    """Ray is not installed."""

    def __init__(self) -> None:
        super().__init__('Ray is not installed; `pip install "cdlc[ray]"` does it')


class Ray(Closing):
    """The cores of a Ray cluster.

    `address` is that of a cluster, as `ray.init` takes it; `auto` is the one this machine belongs
    to, and None one of this machine alone, which ends with this. Where Ray is initialised already,
    that is used, and left as it is. `runtime_env` tells Ray what nodes need, such as modules.

    Raises RayMissing, and ConnectionError where there is no cluster.
    """

    def __init__(
        self,
        address: str | None = None,
        *,
        grace: float = GRACE,
        runtime_env: Mapping[str, Any] | None = None,
    ) -> None:
        try:
            import ray
        except ImportError:
            raise RayMissing from None
        self._ray = ray
        self._is_ours = not ray.is_initialized()
        if self._is_ours:
            ray.init(
                address=address,
                log_to_driver=False,
                logging_level=logging.ERROR,
                runtime_env=dict(runtime_env or {}),
            )
        self._carry_out = ray.remote(num_cpus=1, max_retries=0)(carry_out)
        self._grace = grace
        self._packer = Packer()
        self._parts: Recent[Any] = Recent()
        self._running: dict[Any, int] = {}
        self._ended: list[Finished] = []
        self._cores = 0
        self._counted_until = 0.0

    @property
    def room(self) -> int:
        """As many tasks as keep the cluster's cores busy, as many as there are by now."""
        if monotonic() >= self._counted_until:
            self._cores = int(self._ray.cluster_resources().get("CPU", 0))
            self._counted_until = monotonic() + _SECONDS_A_COUNT
        return max(1, _TASKS_A_CORE * self._cores) - len(self._running)

    def submit(self, number: int, task: Task) -> None:
        """Give a task to Ray."""
        try:
            packed = self._packer.pack(task)
        except NotSent as error:
            self._ended.append(Finished(number, Fault("not-sent", str(error)), 0.0))
            return
        parts = [self._part(key, data) for key, data in packed.parts.items()]
        about = (tuple(packed.parts), packed.body, packed.configuration, self._grace)
        self._running[self._carry_out.remote(about, *parts)] = number

    def wait(self) -> list[Finished]:
        """Wait until Ray has the outcome of some task, or knows that it never will."""
        if not self._ended:
            ready, _ = self._ray.wait(list(self._running), num_returns=1)
            more, _ = self._ray.wait(list(self._running), num_returns=len(self._running), timeout=0)
            for reference in dict.fromkeys((*ready, *more)):
                number = self._running.pop(reference)
                self._ended.append(Finished(number, *self._outcome(reference)))
        ended, self._ended = self._ended, []
        return ended

    def cancel(self, numbers: Collection[int]) -> None:
        """Have Ray interrupt these tasks."""
        for reference in [r for r, number in self._running.items() if number in numbers]:
            del self._running[reference]
            self._ray.cancel(reference)
        self._ended = [one for one in self._ended if one.number not in numbers]

    def close(self) -> None:
        """End what runs, and leave the cluster."""
        self.cancel(list(self._running.values()))
        if self._is_ours:
            self._ray.shutdown()

    def _part(self, key: str, data: bytes) -> Any:
        """Where a program lies in the cluster, put there once."""
        found = self._parts.get(key)
        return self._parts.put(key, self._ray.put(data)) if found is None else found

    def _outcome(self, reference: Any) -> tuple[Outcome, float]:
        from ray.exceptions import RayError, RayTaskError

        try:
            outcome, seconds = self._ray.get(reference)
        except RayTaskError as error:
            return Fault("not-loaded", f"on a node of the cluster: {_last_line(error)}"), 0.0
        except RayError as error:
            return Fault("killed", f"{type(error).__name__}: {_last_line(error)}"), 0.0
        return outcome, seconds


def _last_line(error: Exception) -> str:
    lines = str(error).strip().splitlines()
    return lines[-1] if lines else type(error).__name__


# -------------------------------------------------------------------------------------- on a node

_beside: dict[float, Processes] = {}
"""The one process beside this process of Ray's, by its grace."""


def carry_out(
    about: tuple[tuple[str, ...], bytes, Configuration, float], *parts: bytes
) -> tuple[Outcome, float]:
    """Carry a task out in the process beside this one."""
    keys, body, configuration, grace = about
    if grace not in _beside:
        _beside[grace] = Processes(1, grace=grace)
        atexit.register(_beside[grace].close)
    processes = _beside[grace]
    try:
        processes.submit_packed(0, Packed(dict(zip(keys, parts, strict=True)), body, configuration))
        while not (ended := processes.wait(_SECONDS_A_LOOK)):
            pass
    except WorkersError as error:
        return Fault("killed", str(error)), 0.0
    except BaseException:
        processes.cancel([0])
        raise
    return ended[0].outcome, ended[0].seconds
