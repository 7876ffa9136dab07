"""One question to z3: is there a way to make all of these true?

z3 runs in a thread, so that Ctrl-C and a signal to end reach this process while it thinks; deep
formulas need the large stack.
"""

import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import z3

_STACK = 512 << 20
# How long after its time limit z3 is told to stop.
_GRACE = 0.5
TIMED_OUT = "not decided within the time limit"


_local = threading.local()


def context() -> Any:
    """This thread's context of z3; making one takes longer than most questions."""
    if getattr(_local, "context", None) is None:
        _local.context = z3.Context()
    return _local.context


class Answer(StrEnum):
    """Satisfiable, unsatisfiable, or z3 gave up."""

    SAT = "sat"
    UNSAT = "unsat"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True)
class Solved:
    """An answer: with a model, with the positions of facts that contradict each other, or with the
    reason for giving up.
    """

    answer: Answer
    model: Any = None
    core: tuple[int, ...] = ()
    reason: str = ""


def solve(
    ctx: Any, assertions: Sequence[Any], deadline: float, facts: Sequence[Any] = ()
) -> Solved:
    """Ask z3 whether assertions and facts can be true together, until a `time.monotonic()`.

    Raises KeyboardInterrupt, after z3 has stopped.
    """
    seconds = deadline - time.monotonic()
    if seconds <= 0:
        return Solved(Answer.UNKNOWN, reason=TIMED_OUT)
    solver = z3.Solver(ctx=ctx)
    # Its handler would swallow the interrupt of this process.
    solver.set(ctrl_c=False, timeout=max(1, int(seconds * 1000)))
    if facts:
        solver.set(**{"core.minimize": True})
    solver.add(*assertions)
    names = [z3.Bool(f"fact:{i}", ctx) for i in range(len(facts))]
    for name, fact in zip(names, facts, strict=True):
        solver.add(z3.Implies(name, fact))
    outcome = _run(ctx, lambda: solver.check(*names), deadline + _GRACE)
    if outcome == z3.sat:
        return Solved(Answer.SAT, model=solver.model())
    if outcome == z3.unsat:
        core = {str(name) for name in solver.unsat_core()}
        return Solved(
            Answer.UNSAT, core=tuple(i for i, name in enumerate(names) if str(name) in core)
        )
    return Solved(Answer.UNKNOWN, reason=_reason(outcome, solver))


def _run(ctx: Any, check: Any, deadline: float) -> Any:
    """What `check` returns or raises, from a thread of its own; z3 is stopped at the deadline."""
    outcome: list[Any] = []

    def body() -> None:
        try:
            outcome.append(check())
        except z3.Z3Exception as error:
            outcome.append(error)

    thread = _started(body)
    try:
        while thread.is_alive() and time.monotonic() < deadline:
            thread.join(0.05 if time.monotonic() + 0.05 < deadline else 0.01)
    finally:
        # An interrupt that comes before z3 has started has no effect, so it is repeated.
        while thread.is_alive():
            _local.context = None  # the interrupt may outlast the question
            ctx.interrupt()
            thread.join(0.02)
    return outcome[0]


def _started(body: Any) -> threading.Thread:
    usual = threading.stack_size(_STACK)
    try:
        return _thread(body)
    except RuntimeError:  # no room for such a stack; most formulas need none
        threading.stack_size(usual)
        return _thread(body)
    finally:
        threading.stack_size(usual)


def _thread(body: Any) -> threading.Thread:
    thread = threading.Thread(target=body, daemon=True)
    thread.start()
    return thread


def _reason(outcome: Any, solver: Any) -> str:
    said = str(outcome) if isinstance(outcome, z3.Z3Exception) else solver.reason_unknown()
    if any(word in said for word in ("timeout", "canceled", "interrupted")):
        return TIMED_OUT
    return f"z3 gave up: {said}"
