"""Watches over one run: `python -m cdlc.backends.engines.worker CALLER_PID DIRECTORY`.

Standard input is a lifeline: when it ends, because the caller has closed it or is dead, every
process of the run is killed, the directory removed, and the worker exits. The engine runs in a
forked child, so that no engine can keep the worker from watching; when the child ends, the worker
writes its exit status to standard output and goes on waiting for the lifeline.
"""

import importlib
import json
import os
import select
import shutil
import signal
import sys
import threading
from contextlib import suppress
from pathlib import Path
from types import ModuleType
from typing import Final

from cdlc.backends.engines.processes import kill_run

WITHOUT_CONFIG_SPACE: Final = ("fast-downward", "fast-downward-opt")


def main() -> None:
    """Run the solver on `DIRECTORY` and stay until the caller lets go."""
    caller, directory = int(sys.argv[1]), Path(sys.argv[2])
    # A caller that ignores its children would have all of these processes lose exit statuses.
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    child = os.fork()
    if child == 0:
        _solve(directory)
    threading.Thread(target=_report, args=(child,), daemon=True).start()
    # Before `kill_run` needs it: everything must be gone soon after the end of the lifeline.
    importlib.import_module("psutil")
    _wait_for_end_of(caller)
    kill_run(str(directory))
    shutil.rmtree(directory, ignore_errors=True)
    # Not `sys.exit`: the reporting thread may still be at work.
    os._exit(0)


def _solve(directory: Path) -> None:
    status = 1
    try:
        _send_output_to(directory / "log.txt")
        _answer(directory)
        status = 0
    except BaseException:  # noqa: BLE001 - nothing may return into the worker's half of the fork
        sys.excepthook(*sys.exc_info())
    finally:
        sys.stdout.flush()
        os._exit(status)


def _answer(directory: Path) -> None:
    request = json.loads((directory / "request.json").read_text("utf-8"))
    if request.get("engine") in WITHOUT_CONFIG_SPACE:
        sys.modules["ConfigSpace"] = _StandIn("ConfigSpace")
    from cdlc.backends.engines import solver  # imports unified-planning

    unfinished = directory / "answer.part"
    unfinished.write_text(json.dumps(solver.answer(request)), "utf-8")
    unfinished.rename(directory / "answer.json")


class _StandIn(ModuleType):
    """A ConfigSpace that has only what unified-planning names in an annotation.

    The real one is there for tuning engines' parameters, and with scipy.stats makes up more than
    half of the time and of the memory that importing unified-planning takes.
    """

    ConfigurationSpace = object

    def __getattr__(self, name: str) -> object:
        if name.startswith("__"):  # what the import system asks
            raise AttributeError(name)
        # The error that unified-planning expects of an engine which cannot be loaded.
        raise ImportError(name)


def _send_output_to(log: Path) -> None:
    """Let go of the lifeline and of the report pipe, which the engine would hold open."""
    for path, flags, descriptors in (
        (os.devnull, os.O_RDONLY, (0,)),
        (log, os.O_WRONLY | os.O_APPEND | os.O_CREAT, (1, 2)),
    ):
        opened = os.open(path, flags, 0o600)
        for descriptor in descriptors:
            os.dup2(opened, descriptor)
        os.close(opened)


def _report(child: int) -> None:
    _, status = os.waitpid(child, 0)
    with suppress(BrokenPipeError):  # the caller has gone; so will this process
        os.write(1, str(os.waitstatus_to_exitcode(status)).encode())


def _wait_for_end_of(caller: int) -> None:
    # A fork of the caller may hold the lifeline open after its death, hence the look at the parent.
    while os.getppid() == caller:
        if select.select([0], [], [], 0.2)[0]:
            return


if __name__ == "__main__":
    main()
