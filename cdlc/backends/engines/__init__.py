"""Runs a PDDL task on a planner that unified-planning knows, in processes of its own.

Here is the calling side, which never imports unified-planning:

    catalogue   which engines there are and whether they are installed
    run         starts a worker, waits for it, ends it
    spelling    a plan's names as the task spells them
    processes   ends every process of a run

and the other side of the process boundary:

    worker      watches over one run: when the caller goes, everything of the run goes
    solver      reads, solves and validates with unified-planning
"""

from cdlc.backends.engines.catalogue import installed
from cdlc.backends.engines.result import (
    Description,
    EngineError,
    EngineFailed,
    EngineMissing,
    EngineResult,
    EngineStatus,
    EngineUnsupported,
    PddlStep,
    Verdict,
)
from cdlc.backends.engines.run import describe, solve, validate

__all__ = [
    "solve",
    "describe",
    "validate",
    "Verdict",
    "Description",
    "installed",
    "EngineResult",
    "EngineStatus",
    "PddlStep",
    "EngineError",
    "EngineMissing",
    "EngineUnsupported",
    "EngineFailed",
]
