"""Messages about PDDL that is read in."""

from collections.abc import Sequence
from dataclasses import dataclass

from cdlc.diagnostics import Diagnostic, Help, suggest


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class PddlSyntax(Diagnostic):
    """PDDL that is not formed as the standard says.

        (:action move :parameters (?x) :effect)

    Every keyword of an action is followed by its list; formulas are `(and …)`, `(not …)` and so on.
    """

    problem: str

    def message(self) -> str:
        return self.problem


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class PddlName(Diagnostic):
    """A name in PDDL that nothing declares, or that is used with another number of arguments.

        (:predicates (on ?x ?y))
        … (on ?x)

    Correct the spelling, or declare it under `:types`, `:predicates`, `:functions` or `:objects`.
    """

    kind: str
    name: str
    known: Sequence[str] = ()
    reason: str = "is not declared"

    def message(self) -> str:
        return f"{self.kind} `{self.name}` {self.reason}"

    def help(self) -> tuple[Help, ...]:
        return suggest(self.name, list(self.known), self.location)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class PddlUnsupported(Diagnostic):
    """PDDL that has no equivalent in CDL.

        (:durative-action …)

    Time, preferences, constraints on the trajectory, object fluents, recursive `:derived`
    predicates, parameters of type `either`, and costs that depend on a condition are refused.
    """

    construct: str
    reason: str

    def message(self) -> str:
        return f"{self.construct} cannot be imported"

    def notes(self) -> tuple[str, ...]:
        return (self.reason,)
