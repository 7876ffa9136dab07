"""A worker: a process that is sent one task after another, and answers each."""

import gc
import os
import pickle
import signal
import threading
from multiprocessing.connection import Connection, wait
from multiprocessing.process import parent_process
from time import monotonic
from typing import Any, Final

from crow.budget import resident_mb
from crow.many.attempt import Outcome, attempt
from crow.many.packing import Unpacker
from crow.many.records import Fault

READY: Final = b"ready"
BEGUN: Final = b"begun"

_MOST_KEPT_MB: Final = 256
"""A worker that holds so much more than it did at first is replaced by a new one."""


class _Cancelled(BaseException):  # so that nothing else catches it
    """The driver wants no more of a task."""


def work(pipe: Connection) -> None:
    """Carry out what comes through a pipe, until its other end is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the driver's, which ends its workers
    signal.signal(signal.SIGTERM, _cancel)
    os.dup2(2, 1)  # standard output is for results: what functions print is none
    threading.Thread(target=_end_with_parent, daemon=True).start()
    gc.set_threshold(100_000, 50, 50)
    unpacker = Unpacker()
    at_first = resident_mb()
    pipe.send_bytes(READY)
    while True:
        try:
            message = pickle.loads(pipe.recv_bytes())  # noqa: S301 - from our own driver
        except (EOFError, OSError):
            return
        began = monotonic()
        outcome = _carried_out(message, unpacker, pipe)
        limit = message[2].memory_limit_mb
        is_spent = _holds_more(at_first, limit)
        _answer(pipe, outcome, monotonic() - began, is_spent=is_spent)
        if is_spent:
            return


def _carried_out(message: Any, unpacker: Unpacker, pipe: Connection) -> Outcome:
    parts, body, configuration = message
    try:
        _at_it[0] = True
        try:
            return attempt(
                lambda: unpacker.problem(parts, body),
                configuration,
                is_alone=True,
                begun=lambda: pipe.send_bytes(BEGUN),
            )
        finally:
            _at_it[0] = False
    except KeyboardInterrupt:  # no signal makes it here
        return Fault("function", "it raised KeyboardInterrupt")
    except _Cancelled:  # so nobody wants to know
        return Fault("error", "it was cancelled")


_at_it: Final = [False]
"""Whether there is something to cancel; no lock, which the handler might find taken."""


def _cancel(_number: int, _frame: object) -> None:
    """End the search, whose driver wants no more of it, and be there for the next task."""
    if _at_it[0]:
        _at_it[0] = False
        raise _Cancelled


def _answer(pipe: Connection, outcome: Outcome, seconds: float, *, is_spent: bool) -> None:
    try:
        data = pickle.dumps((outcome, seconds, is_spent))
    except Exception as error:  # noqa: BLE001 - values of the user's may raise anything
        fault = Fault("not-sent", f"the result: {type(error).__name__}: {error}")
        data = pickle.dumps((fault, seconds, is_spent))
    pipe.send_bytes(data)


def _holds_more(at_first: float, limit_mb: int | None) -> bool:
    """Whether what tasks have left behind might tell on those that follow."""
    most = _MOST_KEPT_MB if limit_mb is None else min(_MOST_KEPT_MB, max(16, limit_mb // 8))
    if resident_mb() - at_first <= most:
        return False
    gc.collect()
    return resident_mb() - at_first > most


def _end_with_parent() -> None:
    """End when the driver has died, whatever this process is at."""
    parent = parent_process()
    assert parent is not None
    wait([parent.sentinel])
    os._exit(1)
