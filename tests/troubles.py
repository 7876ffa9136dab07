"""Problems whose Python does what the name of their object says: raise, hang, die, and so on."""

import os
import signal
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

from programs import problem_of
from towers_in_python import with_python

from crow.problem import Problem

DOMAIN = """
typedef thing
feature done(x: thing)
def trouble(x: thing) -> int32
controller act(x: thing)
behavior work(x: thing):
  goal: done(x)
  body:
    assert trouble(x) >= 0
    do act(x)
  eff:
    done[x] = True
"""

PROBLEM = """
problem "{name}"
objects:
  {name}: thing
goal: done({name})
"""

MARK = "CDLC_TEST_MARK"
"""Where in the environment the folder is in which `marks` leaves the ids of its processes."""

_hoard: list[bytearray] = []


def trouble(x: str) -> int:
    """0, after what the first word of a name says."""
    name = x.split("_")[0]
    return 0 if name == "none" else int(TROUBLES[name]() or 0)


def _never() -> int:
    return -1


def _raises() -> None:
    raise KeyError("nothing of this name")


def _spins() -> None:
    while True:
        with suppress(BaseException):  # that is the trouble
            time.sleep(0.01)


def _sleeps() -> None:
    time.sleep(1_000)


def _insists() -> None:
    sum(range(10**15))  # no signal is looked at until it ends


def _dies() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def _orphans() -> None:
    os.kill(os.getppid(), signal.SIGKILL)
    time.sleep(1_000)


def _exits() -> None:
    sys.exit(7)


def _aborts() -> None:
    os.abort()


def _hoards() -> None:
    while True:
        _hoard.append(bytearray(b"x" * (8 << 20)))


def _allocates() -> None:
    import numpy as np

    np.ones((1 << 17, 1 << 12))


def _keeps() -> None:
    _hoard.append(bytearray(b"x" * (300 << 20)))


def _prints() -> None:
    print("said by a function")  # noqa: T201


def _naps() -> None:
    time.sleep(0.15)


def _marks() -> None:
    (Path(os.environ[MARK]) / str(os.getpid())).touch()
    time.sleep(1_000)


TROUBLES = {
    name.removeprefix("_"): python
    for name, python in list(globals().items())
    if name.startswith("_") and callable(python)
}

PYTHON = {"trouble": trouble}


def troubled(name: str, python: Any = None) -> Problem:
    """A problem with a trouble, or with the Python that is given."""
    problem = problem_of(DOMAIN, PROBLEM.format(name=name))
    return with_python(problem, PYTHON if python is None else python)
