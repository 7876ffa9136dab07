"""Every message about what a program means. The docstring of a kind is its page."""

from dataclasses import dataclass

from crow.program import Location

from cdlc.diagnostics import Diagnostic, Help, Label, Lint


@dataclass(frozen=True, kw_only=True)
class GoalNotEstablished(Lint):
    """A behavior whose effect does not make its goal true.

        behavior r_holding(x: block, y: block):
          goal: holding(x)
          eff:
            holding[y] = True

    A planner would apply the behavior and find its goal still open. Correct the goal or the effect;
    a behavior that reaches its goal through others has no `eff:` of its own.
    """

    behavior: str
    goal: str
    effect: Location | None
    suggestion: str | None

    def message(self) -> str:
        return f"the effects of `{self.behavior}` do not establish its goal `{self.goal}`"

    def label(self) -> str:
        return "not made true"

    def labels(self) -> tuple[Label, ...]:
        return (
            () if self.effect is None else (Label(self.effect, "this effect writes another cell"),)
        )

    def help(self) -> tuple[Help, ...]:
        return () if self.suggestion is None else (Help(f"did you mean `{self.suggestion}`?"),)


@dataclass(frozen=True, kw_only=True)
class NoHoareModel(Diagnostic):
    """A behavior that this version cannot turn into precondition and effect.

        behavior drain(x: tank):
          eff:
            foreach p: pipe: open[p] = False

    Straight-line effects with Boolean features have a model; `check` and `simulate` take every
    effect.
    """

    construct: str
    behavior: str

    def message(self) -> str:
        return f"{self.construct} has no Hoare model in this version"

    def label(self) -> str:
        return f"in `{self.behavior}`"
