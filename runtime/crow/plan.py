"""Plans and their JSON (interface.md): one step is one controller call."""

from dataclasses import dataclass, field, replace
from typing import Any

from crow.trace import Trace, item_json
from crow.values import Value, given_out, json_value


@dataclass(frozen=True, slots=True)
class Step:
    """A controller call and the behavior that made it; several calls of one behavior follow on.

    `controller` is None for a behavior that changes features without running any. `also` names
    other behaviors that are the same transition.
    """

    behavior: str
    behavior_arguments: tuple[Value, ...]
    bindings: dict[str, Value]
    controller: str | None
    arguments: tuple[Value, ...] = ()
    also: tuple[str, ...] = ()

    def given_out(self) -> "Step":
        """The step with values as the user's Python has them."""
        return replace(
            self,
            behavior_arguments=tuple(map(given_out, self.behavior_arguments)),
            bindings={name: given_out(value) for name, value in self.bindings.items()},
            arguments=tuple(map(given_out, self.arguments)),
        )

    def json(self) -> dict[str, Any]:
        """The step as it stands in a plan's JSON."""
        step: dict[str, Any] = {
            "behavior": self.behavior,
            "behavior_arguments": list(map(json_value, self.behavior_arguments)),
            "bindings": {name: json_value(value) for name, value in self.bindings.items()},
            "controller": self.controller,
            "arguments": list(map(json_value, self.arguments)),
        }
        return {**step, "also": list(self.also)} if self.also else step


@dataclass(frozen=True, slots=True)
class Result:
    """What a planner found: `status` is plan, unsolvable, limit, timeout or memory."""

    status: str
    engine: str
    steps: tuple[Step, ...] = ()
    trace: Trace = ()
    cost: float | None = None
    seed: int = 0
    statistics: dict[str, Any] = field(default_factory=dict)
    explanation: str | None = None

    def summary(self) -> str:
        """One line for people: what was found, or what kept a plan from being found."""
        count = f"{len(self.steps)} step{'' if len(self.steps) == 1 else 's'}"
        told = {
            "plan": f"plan of {count}, replayed to the goal",
            "unsolvable": "no plan exists",
            "limit": "no plan found: the search stopped at a limit of its own",
            "timeout": "no plan found within the time limit",
            "memory": "no plan found within the memory limit",
        }[self.status]
        return f"{told} ({self.engine}{took(self.statistics)})"

    def json(self) -> dict[str, Any]:
        """The `plan --format json` document (schemas/plan.json)."""
        document: dict[str, Any] = {
            "version": 1,
            "status": self.status,
            "engine": self.engine,
            "seed": self.seed,
            "steps": [step.json() for step in self.steps],
            "trace": [item_json(item) for item in self.trace],
            "cost": self.cost,
            "statistics": dict(self.statistics),
        }
        return (
            document if self.explanation is None else {**document, "explanation": self.explanation}
        )


def took(statistics: dict[str, Any]) -> str:
    """How long a search ran, for a summary."""
    seconds = statistics.get("seconds")
    return "" if seconds is None else f" in {seconds:.2f} s"


def call_text(name: str, arguments: tuple[Value, ...], bindings: dict[str, Value]) -> str:
    """A call as `simulate --step` takes it: `r_clear(b, y=c)`."""
    parts = [_written(a) for a in arguments] + [f"{k}={_written(v)}" for k, v in bindings.items()]
    return f"{name}({', '.join(parts)})"


def _written(value: Value) -> str:
    match value:
        case (tuple() as first, _, _, *_, last):  # a way, say: its points would fill the line
            return f"[{_written(first)}, …, {_written(last)}]"
        case tuple():
            return f"[{', '.join(map(_written, value))}]"
        case bool() | int() | float() | str():
            return str(value)
        case _:
            return " ".join(repr(value).split())


def plan_text(steps: tuple[Step, ...]) -> str:
    """A plan, a step a line: the controller call, then the behavior that made it."""
    calls = [call_text(s.controller, s.arguments, {}) if s.controller else "-" for s in steps]
    width = max((len(call) for call in calls), default=0)
    lines = []
    for number, (step, call) in enumerate(zip(steps, calls, strict=True), 1):
        behavior = call_text(step.behavior, step.behavior_arguments, step.bindings)
        lines.append(f"{number:>{len(str(len(steps)))}}. {call:<{width}}  by {behavior}\n")
    return "".join(lines)
