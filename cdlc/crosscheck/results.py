"""What comparing one problem came to, and its JSON."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any

from cdlc.backends.engines import PddlStep
from cdlc.diagnostics import Diagnostic
from cdlc.render import as_json
from cdlc.source import SourceFile
from crow.plan import Result, Step


class Outcome(StrEnum):
    """What two answers say together."""

    AGREE_PLAN = "agree-plan"
    AGREE_NONE = "agree-none"
    OUTSIDE = "outside"
    INCONCLUSIVE = "inconclusive"
    NOT_COMPARABLE = "not-comparable"
    MISMATCH = "mismatch"
    ERROR = "error"


@dataclass(frozen=True, slots=True)
class Side:
    """The answer of one side.

    `pddl` is its plan in PDDL. `fault` is why the plan is none for the other side, `unchecked` why
    that could not be found out. `stop` is the limit at which a search stopped, in words.
    """

    result: Result
    pddl: tuple[PddlStep, ...] = ()
    fault: str = ""
    unchecked: str = ""
    stop: str = ""

    @property
    def status(self) -> str:
        """The status of the result: plan, unsolvable, limit, timeout or memory."""
        return self.result.status

    def json(self) -> dict[str, Any]:
        """The side as it stands in the JSON of a comparison."""
        result = self.result
        entry: dict[str, Any] = {
            "engine": result.engine,
            "status": result.status,
            "steps": [step.json() for step in result.steps],
            "pddl": [f"({' '.join((step.action, *step.arguments))})" for step in self.pddl],
            "cost": result.cost,
            "seconds": result.statistics.get("seconds"),
        }
        told = {"fault": self.fault, "unchecked": self.unchecked, "stop": self.stop}
        return entry | {name: text for name, text in told.items() if text}


@dataclass(frozen=True, slots=True)
class Excluded:
    """A step of a planner's plan outside the program's plan space, and what is to be said of it."""

    step: Step
    remark: str = ""


@dataclass(frozen=True, slots=True)
class Comparison:
    """One problem: an outcome, why, and the answers, as far as it came to them.

    `excluded` is the planner's plan where it is outside the plan space. `reproducer` is where a
    mismatch can be repeated from. `diagnostics` are those of the input, warnings too. `second` is
    the plan of the reference engine where the runtime's other engine claims that there is none.
    """

    file: str
    outcome: Outcome
    reason: str = ""
    planner: Side | None = None
    program: Side | None = None
    excluded: tuple[Excluded, ...] = ()
    diagnostics: tuple[Diagnostic, ...] = ()
    sources: Mapping[str, SourceFile] | None = None
    reproducer: Path | None = None
    second: Result | None = None

    def json(self) -> dict[str, Any]:
        """The problem as it stands in the document."""
        entry: dict[str, Any] = {"problem": self.file, "outcome": str(self.outcome)}
        if self.reason:
            entry["reason"] = self.reason
        for name, side in (("planner", self.planner), ("program", self.program)):
            if side is not None:
                entry[name] = side.json()
        if self.excluded:
            entry["remarks"] = [
                {"step": number, "remark": excluded.remark}
                for number, excluded in enumerate(self.excluded, 1)
                if excluded.remark
            ]
        if self.reproducer is not None:
            entry["reproducer"] = str(self.reproducer)
        if self.diagnostics:
            entry["diagnostics"] = as_json(self.diagnostics)["diagnostics"]
        return entry


# What weighs more comes first: something wrong, then something left out, then something open.
_WEIGHTS = (
    Outcome.MISMATCH,
    Outcome.ERROR,
    Outcome.OUTSIDE,
    Outcome.INCONCLUSIVE,
    Outcome.NOT_COMPARABLE,
)


def outcome_of_all(compared: Iterable[Comparison]) -> Outcome:
    """The outcome that weighs most; AGREE_PLAN if everything agrees."""
    found = {comparison.outcome for comparison in compared}
    return next((outcome for outcome in _WEIGHTS if outcome in found), Outcome.AGREE_PLAN)


def document(compared: Sequence[Comparison], *, is_complete: bool) -> dict[str, Any]:
    """The `crosscheck --format json` document (schemas/crosscheck.json)."""
    return {
        "version": 1,
        "complete": is_complete,
        "problems": [comparison.json() for comparison in compared],
    }
