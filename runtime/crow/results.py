"""What `crow.plan` returns: a plan, or one of the ways in which there is none."""

from dataclasses import dataclass, field

from crow.plan import Result, took


@dataclass(frozen=True, slots=True)
class Plan(Result):
    """A plan: steps whose trace was replayed from the initial state to the goal."""

    status: str = field(default="plan", init=False)


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
        told = {
            "depth": "the depth limit was reached",
            "nodes": "the node limit was reached",
            "commit": "a `commit` kept choices from being tried",
            "recursion": "the reference engine ran out of Python's stack",
        }
        reasons = ", ".join(told[limit] for limit in self.limits)
        return f"no plan found: {reasons} ({self.engine}{took(self.statistics)})"


@dataclass(frozen=True, slots=True)
class TimedOut(Result):
    """No plan was found within the time limit."""

    status: str = field(default="timeout", init=False)


@dataclass(frozen=True, slots=True)
class OutOfMemory(Result):
    """No plan was found within the memory limit."""

    status: str = field(default="memory", init=False)
