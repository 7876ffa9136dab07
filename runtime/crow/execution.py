"""A policy in a world: observe, act, and plan again where things went otherwise (§2)."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final, Literal, Protocol

from crow.policy import ControllerCall, Decision, Done, Policy, Stuck
from crow.problem import Cell, Problem, State
from crow.values import Value, json_value

DONE: Final = "done"
"""What `act` returns for a call that was carried out; what it has led to is observed then."""
FAILED: Final = "failed"
"""What `act` returns for a call that was not."""

Observation = State | Mapping[Cell, object]
Status = Literal["done", "no-plan", "failed", "step-limit", "environment"]


class Environment(Protocol):
    """A robot, a simulator, or a test."""

    def observe(self) -> Observation:
        """The values of the features: a State, or a mapping from `("on", ("a", "b"))` to values."""

    def act(self, controller: str, arguments: tuple[Value, ...]) -> str | Observation:
        """Run a controller: `done`, `failed`, or the state that it has led to."""


@dataclass(frozen=True, slots=True)
class Acted:
    """A controller call, and what became of it: `done` or `failed`, with a message if it raised."""

    call: ControllerCall
    outcome: Literal["done", "failed"]
    message: str | None = None

    def json(self) -> dict[str, Any]:
        """The event in a record's JSON."""
        told: dict[str, Any] = {
            "do": self.call.controller,
            "arguments": list(map(json_value, self.call.arguments)),
            "outcome": self.outcome,
        }
        return told if self.message is None else {**told, "message": self.message}

    def __str__(self) -> str:
        failed = "" if self.outcome == "done" else ": failed"
        return f"{self.call}{failed}{f' ({self.message})' if self.message else ''}"


@dataclass(frozen=True, slots=True)
class Planned:
    """A plan that was made, by the calls of it, and why the one before was given up."""

    calls: tuple[ControllerCall, ...]
    reason: str | None

    def json(self) -> dict[str, Any]:
        """The event in a record's JSON."""
        calls = [
            {"do": c.controller, "arguments": list(map(json_value, c.arguments))}
            for c in self.calls
        ]
        return {"plan": calls, "reason": self.reason}

    def __str__(self) -> str:
        count = f"{len(self.calls)} call{'' if len(self.calls) == 1 else 's'}"
        return f"plan of {count}" + (f", as {self.reason}" if self.reason else "")


@dataclass(frozen=True, slots=True)
class Execution:
    """How an execution ended, and everything that was planned and done, in order.

    `status` is `done` (the goal holds), `no-plan`, `failed` (one call, too often), `step-limit`, or
    `environment` (what it observed or returned was no state or outcome, or it raised an exception);
    `explanation` says more.
    """

    status: Status
    events: tuple[Acted | Planned, ...] = ()
    explanation: str | None = None

    @property
    def calls(self) -> tuple[ControllerCall, ...]:
        """The calls that were carried out."""
        acted = (event for event in self.events if isinstance(event, Acted))
        return tuple(event.call for event in acted if event.outcome == "done")

    def json(self) -> dict[str, Any]:
        """The record as a document (schemas/execution.json)."""
        document = {
            "version": 1,
            "status": self.status,
            "events": [event.json() for event in self.events],
        }
        told = self.explanation
        return document if told is None else {**document, "explanation": told}

    def text(self) -> str:
        """The record for people, an event a line."""
        lines = []
        number = 0
        for event in self.events:
            if isinstance(event, Acted):
                number += 1
                lines.append(f"{number:>3}. {event}\n")
            else:
                lines.append(f"     {event}\n")
        ended = {
            "done": "done: the goal holds",
            "no-plan": "no plan from here",
            "failed": "given up: a call failed too often",
            "step-limit": "stopped at the limit of steps",
            "environment": "the environment did not answer",
        }[self.status]
        about = f": {self.explanation}" if self.explanation else ""
        return "".join(lines) + f"{ended}{about}\n"


class _EnvironmentError(Exception):
    """The environment did what it may not; the message says what."""


def execute(
    problem: Problem,
    environment: Environment,
    engine: str = "auto",
    *,
    step_limit: int = 1_000,
    attempts: int = 3,
    **options: Any,
) -> Execution:
    """Carry a problem out: act by its policy, and plan again where the world does otherwise (§2).

    A call that fails is planned for again, but not more than `attempts` times in a row for the same
    call; `step_limit` is the most calls. `options` are those of `crow.plan`, a time limit one for
    each time of planning. What the world does is in the result, exceptions of the environment too;
    KeyboardInterrupt passes through. Raises what `crow.plan` raises.
    """
    policy = Policy(problem, engine, **options)
    return _Executing(policy, environment, attempts).run(step_limit)


@dataclass(slots=True)
class _Executing:
    """One execution, while it lasts."""

    policy: Policy
    environment: Environment
    attempts: int
    events: list[Acted | Planned] = field(default_factory=list)
    failed: dict[ControllerCall, int] = field(default_factory=dict)
    why: str | None = None

    def run(self, step_limit: int) -> Execution:
        """Go on until the goal holds, or there is a reason to stop."""
        try:
            state = self._observed()
            for _ in range(step_limit):
                decision = self._decision(state)
                if not isinstance(decision, ControllerCall):
                    return self._ended(decision)
                state = self._acted(decision)
                if self.failed.get(decision, 0) >= self.attempts:
                    return Execution("failed", tuple(self.events), str(decision))
            decision = self._decision(state)
        except _EnvironmentError as error:
            return Execution("environment", tuple(self.events), str(error))
        if isinstance(decision, Done):
            return self._ended(decision)
        return Execution("step-limit", tuple(self.events), f"{step_limit} calls")

    def _ended(self, decision: Done | Stuck) -> Execution:
        if isinstance(decision, Done):
            return Execution("done", tuple(self.events))
        result = decision.result
        about = f"; the search came as far as {result.explanation}" if result.explanation else ""
        return Execution("no-plan", tuple(self.events), result.summary() + about)

    def _decision(self, state: State) -> Decision:
        """What the policy says, with its new plan noted."""
        before, policy = self.policy.plan, self.policy
        decision = policy.step(state)
        if policy.plan is not None and policy.plan is not before:
            called = [s for s in policy.plan.steps if s.controller is not None]
            calls = tuple(ControllerCall(str(s.controller), s.arguments) for s in called)
            if policy.reason is not None:
                self.why = f"`{policy.reason.condition}` does not hold any more"
            self.events.append(Planned(calls, self.why))
        return decision

    def _acted(self, call: ControllerCall) -> State:
        """The state after a call; a failure is noted, and has the policy plan again."""
        message = None
        try:
            outcome = self.environment.act(call.controller, call.arguments)
        except Exception as error:  # noqa: BLE001 - a robot's fault must not end the program
            outcome, message = FAILED, f"{type(error).__name__}: {error}"
        if isinstance(outcome, str) and outcome == FAILED:
            self.events.append(Acted(call, "failed", message))
            self.failed[call] = self.failed.get(call, 0) + 1
            self.why = f"`{call}` failed"
            self.policy.failed()
            return self._observed()
        self.events.append(Acted(call, "done"))
        self.failed.pop(call, None)
        self.why = None
        if isinstance(outcome, str):
            if outcome != DONE:
                raise _EnvironmentError(f"`{call}` ended with {outcome!r}, which is no outcome")
            return self._observed()
        return self._checked(outcome)

    def _observed(self) -> State:
        try:
            seen = self.environment.observe()
        except Exception as error:  # noqa: BLE001 - as above
            raise _EnvironmentError(f"`observe` raised {type(error).__name__}: {error}") from None
        return self._checked(seen)

    def _checked(self, seen: Observation) -> State:
        if not isinstance(seen, State | Mapping):
            raise _EnvironmentError(f"{seen!r} is no state")
        try:
            return self.policy.observing.state(seen)
        except (ValueError, TypeError) as error:
            raise _EnvironmentError(str(error)) from None
