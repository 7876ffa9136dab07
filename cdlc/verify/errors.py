"""What `cdlc verify` refutes. The docstring of a kind is its page."""

from dataclasses import dataclass
from typing import ClassVar

from cdlc.diagnostics import Diagnostic, Help, Label
from crow.program import Location


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class GoalRefuted(Diagnostic):
    """A behavior that can be applied, runs to its end, and leaves its goal false.

        behavior raise_by_two(x: tank):
          goal: level(x) >= 4
          body:
            assert level(x) >= 1
          eff:
            level[x] += 2

    A planner would apply the behavior and find its goal still open. Below the message stands a
    state where that happens; it has been run. Correct the effect or the goal, or demand in the body
    what the effect relies on.
    """

    behavior: str
    goal: str
    writes: tuple[Label, ...] = ()
    unwritten: tuple[str, ...] = ()
    aliased: tuple[str, ...] = ()
    suggestion: str | None = None

    def message(self) -> str:
        return f"`{self.behavior}` can end with its goal `{self.goal}` false"

    def label(self) -> str:
        return "false after the effect, in the state below"

    def labels(self) -> tuple[Label, ...]:
        return self.writes

    def notes(self) -> tuple[str, ...]:
        written = tuple(f"the effect never sets `{name}`" for name in self.unwritten)
        if not self.aliased:
            return written
        names = " and ".join(f"`{name}`" for name in self.aliased)
        same = f"found only where {names} are one object; `assert` that they differ if they must"
        return (*written, same)

    def help(self) -> tuple[Help, ...]:
        return () if self.suggestion is None else (Help(f"did you mean `{self.suggestion}`?"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class NeverApplicable(Diagnostic):
    """A behavior whose conditions no state satisfies, so that it can never be applied.

        behavior pour(x: tank):
          goal: empty(x)
          body:
            assert level(x) > 3
            achieve level(x) < 2
          eff:
            empty[x] = True

    The conditions named contradict each other. One of them says something else than is meant.
    """

    behavior: str
    conditions: tuple[str, ...]
    places: tuple[Location, ...] = ()

    def message(self) -> str:
        return f"`{self.behavior}` can never be applied"

    def label(self) -> str:
        return "no state satisfies its conditions"

    def labels(self) -> tuple[Label, ...]:
        return tuple(Label(place, "wanted here") for place in self.places)

    def notes(self) -> tuple[str, ...]:
        if not self.conditions:
            return ("in no state does its effect come to an end without an error",)
        *others, last = self.conditions
        if not others:
            return (f"`{last}` is never true",)
        listed = ", ".join(f"`{c}`" for c in others)
        return (f"{listed} and `{last}` are never true together",)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class DeadWrite(Diagnostic):
    """An assignment under a condition that is false wherever its behavior can be applied.

        behavior release(x: block):
          goal: not holding(x)
          body:
            assert holding(x)
          eff:
            holding[x] = False
            if not holding(x):        # it is False by now: always true
              free[...] = True
            else:
              free[...] = False       # so this is never done

    Remove the branch, or correct its condition.
    """

    behavior: str

    def message(self) -> str:
        return f"this assignment of `{self.behavior}` is never carried out"

    def label(self) -> str:
        return "its condition is false wherever the behavior can be applied"


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class WritesCollide(Diagnostic):
    """A `foreach` of which two iterations can write different values to one cell.

        eff:
          foreach x: block:
            if red(x): chosen[...] = x

    Iterations are parallel, so such a cell would have two values, and the behavior fails. Below the
    message stands a state where that happens; it has been run. Demand in the body that one
    iteration at most writes the cell, or let all of them write the same value.
    """

    behavior: str
    feature: str
    other: Location | None

    def message(self) -> str:
        return f"two iterations of a `foreach` can write different values to one `{self.feature}`"

    def label(self) -> str:
        return "written by both, in the state below" if self.other is None else "by one iteration"

    def labels(self) -> tuple[Label, ...]:
        return () if self.other is None else (Label(self.other, "by another"),)


class SolverMissing(Exception):  # noqa: N818 - as EngineMissing
    """z3 is not installed; the message names the cure."""

    code: ClassVar[str] = "solver-missing"

    def __str__(self) -> str:
        return 'z3 is not installed: pip install "cdlc[verify]"'
