"""Runs an engine in a worker and takes care that nothing of the run outlives the call."""

import json
import os
import selectors
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cdlc.backends.engines.catalogue import installed, require
from cdlc.backends.engines.processes import MARK, kill_run
from cdlc.backends.engines.result import (
    LOG_LIMIT,
    Description,
    EngineFailed,
    EngineMissing,
    EngineResult,
    EngineStatus,
    EngineUnsupported,
    PddlStep,
    Verdict,
)
from cdlc.backends.engines.spelling import Spelling

_OUT_OF_MEMORY = (
    "MemoryError",
    "bad_alloc",
    "Cannot allocate memory",
    "failed to map segment",
    "SystemError: error return without exception set",
)


@dataclass(frozen=True, slots=True)
class _Ended:
    """What a worker left: an answer as `solver` describes it, and the end of the log."""

    answer: dict[str, Any]
    log: str


def solve(
    domain: str,
    problem: str,
    *,
    engine: str = "fast-downward",
    time_limit: float | None = None,
    memory_limit_mb: int | None = None,
) -> EngineResult:
    """Solve a PDDL task with an engine that unified-planning knows.

    `domain` and `problem` are PDDL texts. `time_limit` is in seconds of wall time over reading,
    translating and search. `memory_limit_mb` is the address space in MiB that each process of the
    run may take, on Linux only; reading the task needs some 60, for other engines than Fast
    Downward's some 300. Returns a validated plan or why there is none. However the call ends, its
    processes and files are gone; it needs no main thread. Raises `EngineMissing`,
    `EngineUnsupported` and `EngineFailed`.
    """
    require(engine)
    start = time.monotonic()
    request = {
        "engine": engine,
        "domain": domain,
        "problem": problem,
        "memory_limit_mb": memory_limit_mb,
    }
    ended = _asked(request, None if time_limit is None else start + time_limit)
    steps = _steps(ended.answer, Spelling.of(domain, problem))
    status = _status(engine, ended, steps)
    return EngineResult(status, steps, time.monotonic() - start, engine, ended.log)


def validate(
    domain: str, problem: str, steps: Sequence[PddlStep], *, time_limit: float | None = None
) -> Verdict | None:
    """Whether a plan is one of a PDDL task, by a validator that shares no code with the emitter.

    It is unified-planning's where that can read the task, else Kairos'. None after `time_limit`
    seconds. Raises `EngineMissing` without unified-planning, `EngineUnsupported` for a task that no
    installed validator takes, and `EngineFailed` for one that cannot be read.
    """
    require(_VALIDATOR)
    request = {
        "domain": domain,
        "problem": problem,
        "validate": [[step.action, *step.arguments] for step in steps],
    }
    ended = _asked(request, None if time_limit is None else time.monotonic() + time_limit)
    answer = ended.answer
    match answer["outcome"]:
        case "timeout":
            return None
        case "valid" | "invalid" as outcome:
            return Verdict(answer["by"], outcome == "valid", answer.get("reason", ""))
        case "unsupported":
            raise EngineUnsupported(_VALIDATOR, tuple(answer["features"]))
        case _:
            raise EngineFailed(_VALIDATOR, answer["reason"], ended.log)


_VALIDATOR = "validator"


def describe(domain: str | None = None, problem: str | None = None) -> tuple[Description, ...]:
    """What each installed engine takes, and what of a task, given as PDDL texts, it does not.

    Raises `EngineFailed` for a task that cannot be read.
    """
    names = installed()
    if not names:
        return ()
    ended = _asked({"engines": names, "domain": domain, "problem": problem}, None)
    if ended.answer["outcome"] != "described":
        raise EngineFailed("unified-planning", ended.answer["reason"], ended.log)
    return tuple(
        Description(d["name"], tuple(d["accepts"]), tuple(d["lacks"]))
        for d in ended.answer["engines"]
    )


def _asked(request: dict[str, Any], deadline: float | None) -> _Ended:
    """What a worker makes of a request."""
    with tempfile.TemporaryDirectory(prefix="cdlc-engine-", ignore_cleanup_errors=True) as name:
        directory = Path(name).resolve()
        (directory / "request.json").write_text(json.dumps(request), "utf-8")
        return _run_worker(directory, deadline)


def _run_worker(directory: Path, deadline: float | None) -> _Ended:
    worker = _start_worker(directory)
    try:
        exit_status = _wait_for_report(worker, deadline)
        return _Ended(_answer(directory, exit_status), _log_tail(directory))
    finally:
        _end_worker(worker, directory)


def _start_worker(directory: Path) -> subprocess.Popen[bytes]:
    """Start a worker in a session of its own, where no Ctrl-C reaches it."""
    command = [sys.executable, "-P", "-m", "cdlc.backends.engines.worker"]
    with (directory / "log.txt").open("ab") as log:
        return subprocess.Popen(  # noqa: S603 - this package's own module
            [*command, str(os.getpid()), str(directory)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=log,
            cwd=directory,
            env=_environment(directory),
            start_new_session=True,
        )


def _environment(directory: Path) -> dict[str, str]:
    return {
        **os.environ,
        # The worker runs elsewhere and must still find what this process finds.
        "PYTHONPATH": os.pathsep.join(str(Path(entry).absolute()) for entry in sys.path),
        "TMPDIR": str(directory),
        # unified-planning writes constants in the order of their hashes; the plan depends on it.
        "PYTHONHASHSEED": "0",
        # One thread: each further one reserves address space, which counts as memory.
        "OPENBLAS_NUM_THREADS": "1",
        MARK: str(directory),
    }


def _wait_for_report(worker: subprocess.Popen[bytes], deadline: float | None) -> int | None:
    """Give the solver's exit status, or None once the deadline has passed."""
    assert worker.stdout is not None
    with selectors.DefaultSelector() as selector:
        selector.register(worker.stdout, selectors.EVENT_READ)
        left = None if deadline is None else max(0.0, deadline - time.monotonic())
        if not selector.select(left):
            return None
    report = os.read(worker.stdout.fileno(), 16)
    return int(report) if report else 1


def _end_worker(worker: subprocess.Popen[bytes], directory: Path) -> None:
    assert worker.stdin is not None
    assert worker.stdout is not None
    try:
        # First, because the worker ends the run from here on even if this process is interrupted.
        worker.stdin.close()
        with suppress(subprocess.TimeoutExpired):
            worker.wait(timeout=1)
    finally:
        kill_run(str(directory))
        worker.stdout.close()
        worker.wait()


def _answer(directory: Path, exit_status: int | None) -> dict[str, Any]:
    if exit_status is None:
        return {"outcome": "timeout"}
    try:
        answer: dict[str, Any] = json.loads((directory / "answer.json").read_text("utf-8"))
    except OSError:
        return {"outcome": "failed", "reason": f"its process ended with status {exit_status}"}
    return answer


def _log_tail(directory: Path) -> str:
    with (directory / "log.txt").open("rb") as log:
        log.seek(max(0, log.seek(0, os.SEEK_END) - LOG_LIMIT))
        return log.read(LOG_LIMIT).decode("utf-8", "replace")


def _status(engine: str, ended: _Ended, steps: tuple[PddlStep, ...]) -> EngineStatus:
    match ended.answer["outcome"]:
        case "missing":
            known = ", ".join(ended.answer["engines"])
            raise EngineMissing(engine, f"unified-planning finds {known}")
        case "unsupported":
            raise EngineUnsupported(engine, tuple(ended.answer["features"]))
        case "failed" if any(sign in ended.log for sign in _OUT_OF_MEMORY):
            return EngineStatus.MEMORY
        case "failed":
            raise EngineFailed(engine, ended.answer["reason"], ended.log, steps)
        case outcome:
            return EngineStatus(outcome)


def _steps(answer: dict[str, Any], spelling: Spelling) -> tuple[PddlStep, ...]:
    return tuple(spelling.step(*_split(step)) for step in answer.get("steps", ()))


def _split(step: list[str]) -> tuple[str, list[str]]:
    return step[0], step[1:]
