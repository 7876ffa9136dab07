"""Every message about steps and plans. The docstring of a kind is its page."""

from dataclasses import dataclass

from cdlc.diagnostics import Diagnostic, Help, Label
from crow.program import Location


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class BadStep(Diagnostic):
    """A step of a plan, or of `simulate`, that is no call of the program.

        cdlc simulate blocks.cdl sussman.cdl --step "r_clear(b, y=c)"

    A step is a behavior with its arguments in order, then its binds by name.
    """

    reason: str
    hints: tuple[Help, ...] = ()

    def message(self) -> str:
        return self.reason

    def help(self) -> tuple[Help, ...]:
        return self.hints


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class StepFailed(Diagnostic):
    """A step whose behavior cannot be applied in the state it is reached in.

        error[step-failed]: step 1, `stack(A, B)`, cannot be applied: `holding(A)` is false

    The label shows the condition in the program. Conditions are those of `assert`, `achieve` and
    `bind`; each must be true where it stands and at the next `do` or effect of the behavior.
    """

    step: str
    number: int
    condition: str
    reason: str
    where: Location | None

    def message(self) -> str:
        return f"step {self.number} cannot be applied: `{self.condition}`: {self.reason}"

    def label(self) -> str:
        return "this step"

    def labels(self) -> tuple[Label, ...]:
        return () if self.where is None else (Label(self.where, "the condition"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class OpenChoice(Diagnostic):
    """A step whose `bind` the state does not determine.

        cdlc simulate … --step "r_clear(B)"

    Name the object after the arguments: `r_clear(B, y=C)`.
    """

    variable: str
    choices: tuple[str, ...]
    where: Location | None

    def message(self) -> str:
        return f"`{self.variable}` can be {' or '.join(f'`{c}`' for c in self.choices)}"

    def labels(self) -> tuple[Label, ...]:
        return () if self.where is None else (Label(self.where, "bound here"),)

    def help(self) -> tuple[Help, ...]:
        return (Help(f"name one: `{self.variable}={self.choices[0]}`"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class BadPlan(Diagnostic):
    """A plan file that cannot be read.

        cdlc validate blocks.cdl sussman.cdl notes.txt

    A plan is what `cdlc plan` prints, as text or JSON, or a PDDL plan: `(stack a b)` a line.
    """

    reason: str

    def message(self) -> str:
        return self.reason


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class OtherCalls(Diagnostic):
    """A plan whose controller calls are not those that its behaviors make.

        1. place_table(C)   by r_holding_from_table(C)

    Each step names a controller call and the behavior that runs it. Correct one of the two.
    """

    behavior: str
    expected: str
    found: str

    def message(self) -> str:
        return f"`{self.behavior}` runs {self.expected}, the plan has {self.found}"


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class GoalNotReached(Diagnostic):
    """A plan after whose last step the goal of the problem does not hold.

        1. pickup_table(A)   by r_holding_from_table(A)

    The label shows the goal, and the message which part of it fails. Complete the plan, or let
    `cdlc plan` make one.
    """

    goal: str
    goal_location: Location | None
    reason: str

    def message(self) -> str:
        return f"the goal is not reached: `{self.goal}`: {self.reason}"

    def label(self) -> str:
        return "after the last step"

    def labels(self) -> tuple[Label, ...]:
        return () if self.goal_location is None else (Label(self.goal_location, "the goal"),)
