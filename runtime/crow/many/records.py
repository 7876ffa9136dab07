"""What became of a task."""

from dataclasses import dataclass
from typing import Any, Final, Literal

from crow.many.tasks import Configuration
from crow.plan import Result

FaultKind = Literal[
    "function", "hung", "killed", "not-loaded", "not-plannable", "not-sent", "error"
]

FAULTS: Final[dict[FaultKind, str]] = {
    "function": "Python of the user's raised, or gave what is no value of its type",
    "hung": "the search did not end within its time limit and the grace beyond it",
    "killed": "the process that searched has died",
    "not-loaded": "the problem, or a module that it needs, cannot be loaded where it is solved",
    "not-plannable": "the program has what no engine covers",
    "not-sent": "the problem, or its result, cannot travel to another process",
    "error": "a fault of the planner",
}
"""What the kinds of faults mean."""


@dataclass(frozen=True, slots=True)
class Fault:
    """Why a task has no result; `traceback` is that of the code that raised, or empty."""

    kind: FaultKind
    message: str
    traceback: str = ""

    def json(self) -> dict[str, Any]:
        """The fault as it stands in a record."""
        told = {"kind": self.kind, "message": self.message}
        return {**told, "traceback": self.traceback} if self.traceback else told


@dataclass(frozen=True, slots=True)
class Record:
    """What became of one task: a result, which is a plan or a typed no-plan, or a fault.

    `index` is the place of the task among those that were given, `problem` the problem's name, and
    `seconds` what the task took where it was carried out.
    """

    index: int
    key: str
    problem: str
    configuration: Configuration
    result: Result | None
    fault: Fault | None
    seconds: float

    @property
    def status(self) -> str:
        """`plan`, `unsolvable`, `limit`, `timeout`, `memory` or `fault`."""
        return "fault" if self.result is None else self.result.status

    @property
    def is_repeatable(self) -> bool:
        """Whether another run gives the same: not if time, memory or a fault has ended this one."""
        return self.status in ("plan", "unsolvable", "limit")

    def json(self) -> dict[str, Any]:
        """The record as a line of a results file has it; the trace of a plan is left out."""
        document: dict[str, Any] = {
            "key": self.key,
            "problem": self.problem,
            "configuration": self.configuration.json(),
            "status": self.status,
            "seconds": round(self.seconds, 6),
        }
        if self.fault is not None:
            document["fault"] = self.fault.json()
        if self.result is not None:
            told = self.result.json()
            for part in ("version", "status", "engine", "seed", "trace"):
                del told[part]
            document |= told
        return document


def comparable(document: dict[str, Any]) -> dict[str, Any]:
    """The document of a record without what differs from run to run: times."""
    told = {name: value for name, value in document.items() if name != "seconds"}
    if "statistics" in told:
        figures = told["statistics"].items()
        told["statistics"] = {name: value for name, value in figures if name != "seconds"}
    return told
