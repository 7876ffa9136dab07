"""Plan traces: `do`, `assert` and `eff` items (§2.2), and their JSON."""

from dataclasses import dataclass, field
from typing import Any

from crow.program import Expression, Location, Parameter, Statement
from crow.values import Value, json_value


@dataclass(frozen=True, slots=True)
class DoItem:
    """A controller call of the plan, its arguments known."""

    controller: str
    arguments: tuple[Value, ...]
    location: Location | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class AssertItem:
    """A condition that must be true where it stands, with the values of its variables."""

    condition: Expression
    variables: dict[str, Value]
    text: str
    location: Location | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class EffItem:
    """An effect that updates the projected state, with the values of its variables.

    `owner` is the behavior or controller it is the effect of.
    """

    owner: str
    statements: tuple[Statement, ...]
    parameters: tuple[Parameter, ...]
    variables: dict[str, Value]
    location: Location | None = field(default=None, compare=False)


TraceItem = DoItem | AssertItem | EffItem
Trace = tuple[TraceItem, ...]


def item_json(item: TraceItem) -> dict[str, Any]:
    """A trace item as it stands in a plan's JSON."""
    match item:
        case DoItem():
            return {"do": item.controller, "arguments": list(map(json_value, item.arguments))}
        case AssertItem():
            return {"assert": item.text, "variables": _variables(item)}
        case EffItem():
            return {"eff": item.owner, "variables": _variables(item)}


def _variables(item: AssertItem | EffItem) -> dict[str, object]:
    return {name: json_value(value) for name, value in item.variables.items()}
