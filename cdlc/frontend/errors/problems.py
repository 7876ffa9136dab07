"""Messages about problem files."""

from dataclasses import dataclass

from cdlc.diagnostics import Diagnostic, Help, Label
from crow.program import Location


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class MissingPart(Diagnostic):
    """A problem file without one of its parts: its domain or its goal.

        problem "sussman"
        domain "blocks.cdl"
        objects: …
        init: …
        goal: on(A, B)

    `objects:` and `init:` may be left out, and `minimize:` may be added.
    """

    part: str
    example: str

    def message(self) -> str:
        return f"the problem has no {self.part}"

    def help(self) -> tuple[Help, ...]:
        return (Help(f"add `{self.example}`"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class MisplacedPart(Diagnostic):
    """A part of a problem in a domain file.

        objects:
          A, B: block

    Objects, initial values and the goal belong into a file that starts with `problem "name"` and
    names the domain.
    """

    part: str

    def message(self) -> str:
        return f"`{self.part}` belongs in a problem file"

    def help(self) -> tuple[Help, ...]:
        return (Help('start the file with `problem "name"` and `domain "file.cdl"`'),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class OutOfBounds(Diagnostic):
    """An initial value outside the bounds of its feature.

        feature [[min=0, max=20]] level(x: tank) -> int32
        init:
          level[A] = 21

    Correct the value or the bounds.
    """

    feature: str
    value: int
    low: int | None
    high: int | None
    declared: Location | None

    def message(self) -> str:
        return f"{self.value} is outside the bounds of `{self.feature}`"

    def label(self) -> str:
        low, high = self.low, self.high
        if low is None:
            return f"at most {high}"
        return f"at least {low}" if high is None else f"{low} to {high}"

    def labels(self) -> tuple[Label, ...]:
        return () if self.declared is None else (Label(self.declared, "declared here"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class WrongFileKind(Diagnostic):
    """A problem where a domain is wanted, or a domain where a problem is.

        cdlc plan sussman.cdl blocks.cdl

    `cdlc plan DOMAIN PROBLEM`: a problem file starts with `problem "name"`.
    """

    is_a: str
    wanted: str

    def message(self) -> str:
        return f"this is a {self.is_a} file; a {self.wanted} file is wanted"
