"""What verifying came to: a verdict for each check of each behavior, and its JSON."""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from cdlc.diagnostics import Diagnostic
from cdlc.render import as_json
from cdlc.verify.explain import Counterexample


class Verdict(StrEnum):
    """Proved for worlds of any size, refuted with something to show, or neither."""

    PROVED = "proved"
    REFUTED = "refuted"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True)
class Check:
    """One claim about a behavior.

    An unknown one has a `reason`, and `size`: with up to so many objects beside the constants it
    has been checked in full. `problem` and `example` show what refutes it. `notes` are what the
    verdict takes for granted.
    """

    name: str
    verdict: Verdict
    reason: str = ""
    size: int | None = None
    notes: tuple[str, ...] = ()
    problem: Diagnostic | None = None
    example: Counterexample | None = None

    def json(self) -> dict[str, Any]:
        """The check as it stands in the report's JSON."""
        document: dict[str, Any] = {"check": self.name, "verdict": str(self.verdict)}
        if self.notes:
            document["notes"] = list(self.notes)
        if self.verdict is Verdict.UNKNOWN:
            document |= {"reason": self.reason, "objects_checked": self.size}
        if self.problem is not None:
            document["diagnostic"] = as_json([self.problem])["diagnostics"][0]
        if self.example is not None:
            document["counterexample"] = self.example.json()
        return document


@dataclass(frozen=True, slots=True)
class Verified:
    """A behavior with its checks; none for a method, which has no effect of its own."""

    behavior: str
    checks: tuple[Check, ...]

    @property
    def verdict(self) -> Verdict:
        """The worst of the checks."""
        return worst(check.verdict for check in self.checks)

    def json(self) -> dict[str, Any]:
        """The behavior as it stands in the report's JSON."""
        return {
            "behavior": self.behavior,
            "verdict": str(self.verdict),
            "checks": [check.json() for check in self.checks],
        }


@dataclass(frozen=True, slots=True)
class Report:
    """The behaviors of one file, and which of them are the same transition."""

    file: str
    behaviors: tuple[Verified, ...]
    same: tuple[tuple[str, ...], ...] = ()

    @property
    def verdict(self) -> Verdict:
        """The worst of the behaviors."""
        return worst(verified.verdict for verified in self.behaviors)

    def json(self) -> dict[str, Any]:
        """The file as it stands in the report's JSON."""
        return {
            "file": self.file,
            "verdict": str(self.verdict),
            "behaviors": [verified.json() for verified in self.behaviors],
            "same_transition": [list(names) for names in self.same],
        }


def worst(verdicts: Iterator[Verdict]) -> Verdict:
    """Refuted before unknown before proved."""
    found = set(verdicts)
    for verdict in (Verdict.REFUTED, Verdict.UNKNOWN):
        if verdict in found:
            return verdict
    return Verdict.PROVED


def document(reports: tuple[Report, ...]) -> dict[str, Any]:
    """The `verify --format json` document (schemas/verify.json)."""
    return {"version": 1, "files": [report.json() for report in reports]}
