"""What `crow.plan` returns: a plan, or one of the ways in which there is none."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

from crow.plan import Result, took

if TYPE_CHECKING:
    from crow.problem import Problem, State

LIMITS: Final = {
    "depth": "the depth limit was reached",
    "nodes": "the node limit was reached",
    "time": "the time limit was reached",
    "memory": "the memory limit was reached",
    "draws": "generators may yield more values than were drawn",
    "generator": "a generator ended that is not said to yield every value",
    "solver": "some value has no generator that can be asked for it, and no equation to compute it",
    "commit": "a `commit` kept choices from being tried",
    "recursion": "the reference engine ran out of Python's stack",
}
"""What ends a search, for people."""


@dataclass(frozen=True, slots=True)
class Plan(Result):
    """A plan: steps whose trace was replayed from the initial state to the goal.

    `unproved` is for plans that had to be the cheapest: None if that was not asked for, else the
    limits that kept it from being proved, which are none if it is.
    """

    status: str = field(default="plan", init=False)
    unproved: tuple[str, ...] | None = None

    @property
    def is_proved_optimal(self) -> bool:
        """Whether no plan of the program costs less, by proof."""
        return self.unproved == ()

    def states(self, problem: "Problem") -> "tuple[State, ...]":
        """The projected states: the initial one of its problem, and one after each trace item."""
        from crow.replay import replay

        return replay(problem.world, problem.initial, self.trace).states

    def summary(self) -> str:
        """One line for people: the plan, and what is known of its cost."""
        told = Result.summary(self)
        if self.unproved is None:
            return told
        if self.is_proved_optimal:
            return f"{told}; cost {self.cost:g}, and no plan costs less"
        reasons = ", ".join(LIMITS[limit] for limit in self.unproved)
        return f"{told}; cost {self.cost:g}, not proved to be the least: {reasons}"

    def json(self) -> dict[str, Any]:
        """The `plan --format json` document (schemas/plan.json)."""
        document = Result.json(self)
        if self.unproved is not None:
            limits = list(self.unproved)
            document["optimality"] = {"proved": self.is_proved_optimal, "limits": limits}
        return document


@dataclass(frozen=True, slots=True)
class Unsolvable(Result):
    """Proved: every refinement of the goal was tried, and none is sound.

    There may be plans all the same that no refinement by this program is.
    """

    status: str = field(default="unsolvable", init=False)

    def summary(self) -> str:
        """One line for people."""
        return f"no plan exists by the program ({self.engine}{took(self.statistics)})"


@dataclass(frozen=True, slots=True)
class LimitReached(Result):
    """No plan was found before the search ended without having tried everything.

    `limits` are `depth`, `nodes`, `commit` (another choice of its section might have done) or
    `recursion` (the reference engine alone).
    """

    status: str = field(default="limit", init=False)
    limits: tuple[str, ...] = ()

    def summary(self) -> str:
        """One line for people, with the limits."""
        reasons = ", ".join(LIMITS[limit] for limit in self.limits)
        return f"no plan found: {reasons} ({self.engine}{took(self.statistics)})"


@dataclass(frozen=True, slots=True)
class TimedOut(Result):
    """No plan was found within the time limit."""

    status: str = field(default="timeout", init=False)


@dataclass(frozen=True, slots=True)
class OutOfMemory(Result):
    """No plan was found within the memory limit."""

    status: str = field(default="memory", init=False)
