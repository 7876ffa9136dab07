"""How a goal was refined: which behavior for which subgoal (§2.3), and what failed on the way.

It is made from what an engine noted, when it is asked for, and holds no part of the engine.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from math import inf
from typing import Any

from crow.program import Expression, Location, Variable
from crow.program.rewrite import substitute
from crow.program.types import BOOL
from crow.text import expression_text
from crow.trace import Trace
from crow.values import Value


class Kind(StrEnum):
    """What a node of the tree is."""

    GOAL = "goal"
    ACHIEVE = "achieve"
    """A subgoal: `by` is the behavior that refined it, empty where it was true already."""
    CALL = "call"
    """A behavior that is called."""
    STEP = "step"
    """A behavior on the way to a comparison, which no goal matches."""
    BIND = "bind"
    ASSERT = "assert"
    HELD = "held"
    """A condition that is asserted again, before a `do` or an effect."""
    DO = "do"
    EFFECT = "effect"
    FAILED = "failed"
    """What failed where the search came farthest, in a tree without a plan."""


@dataclass(frozen=True, slots=True)
class Node:
    """A node of the tree: `above` is the index of the one it is under, -1 for the goal.

    `item` is its place in the trace, for what has one; `step` that of the step it makes. What has
    not ended, in a tree without a plan, is not done.
    """

    kind: Kind
    text: str
    location: Location | None
    above: int
    level: int
    by: str = ""
    by_location: Location | None = None
    item: int | None = None
    step: int | None = None
    is_done: bool = True

    def json(self) -> dict[str, Any]:
        """The node as JSON."""
        return {
            "kind": str(self.kind),
            "text": self.text,
            "location": _place(self.location),
            "above": self.above,
            "level": self.level,
            "by": self.by,
            "by_location": _place(self.by_location),
            "item": self.item,
            "step": self.step,
            "is_done": self.is_done,
        }


@dataclass(frozen=True, slots=True)
class Failure:
    """A condition that kept branches from going on: how often, and where that was farthest.

    `behavior` is where it stands, empty for the goal; `steps` are those made before the farthest.
    """

    text: str
    reason: str
    location: Location | None
    behavior: str
    count: int
    steps: int
    variables: Mapping[str, Value]
    facts: tuple[str, ...]

    def json(self) -> dict[str, Any]:
        """The failure as JSON."""
        return {
            "condition": self.text,
            "reason": self.reason,
            "location": _place(self.location),
            "behavior": self.behavior,
            "count": self.count,
            "steps": self.steps,
            "variables": dict(self.variables),
            "facts": list(self.facts),
        }


@dataclass(frozen=True, slots=True)
class Refinement:
    """The tree of a plan, parents before children, or of the branch that came farthest.

    `trace` is what its nodes' items are places in; `failures` are what failed anywhere.
    """

    nodes: tuple[Node, ...] = ()
    trace: Trace = ()
    failures: tuple[Failure, ...] = ()

    def json(self) -> dict[str, Any]:
        """Tree and failures as JSON."""
        return {
            "nodes": [node.json() for node in self.nodes],
            "failures": [failure.json() for failure in self.failures],
        }


def _place(location: Location | None) -> str | None:
    return None if location is None else str(location)


def instance_text(condition: Expression, values: Mapping[str, Value]) -> str:
    """A condition with the values of its variables in their place."""
    shown = {name: Variable(_shown(value), BOOL) for name, value in values.items()}
    return expression_text(substitute(condition, shown))


def _shown(value: Value) -> str:
    return f"[{', '.join(map(_shown, value))}]" if isinstance(value, tuple) else str(value)


@dataclass(slots=True)
class Draft:
    """A node that others are still put under."""

    kind: Kind
    text: str
    location: Location | None
    by: str = ""
    by_location: Location | None = None
    item: int | None = None
    step: int | None = None
    is_done: bool = True
    below: "list[Draft]" = field(default_factory=list)
    end: float = inf


def finished(root: Draft) -> tuple[Node, ...]:
    """The nodes of a tree, parents first, what completes earlier before what completes later.

    Without recursion: behaviors may be nested deeper than Python's stack.
    """
    drafts = [root]
    for draft in drafts:
        drafts.extend(draft.below)
    for draft in reversed(drafts):
        if draft.item is not None:
            draft.end = draft.item
        elif draft.below and draft.is_done:
            draft.end = max(below.end for below in draft.below)
        draft.below.sort(key=lambda below: below.end)
    nodes: list[Node] = []
    pending = [(root, -1, 0)]
    while pending:
        draft, above, level = pending.pop()
        pending.extend((below, len(nodes), level + 1) for below in reversed(draft.below))
        nodes.append(
            Node(
                draft.kind, draft.text, draft.location, above, level, draft.by, draft.by_location,
                draft.item, draft.step, draft.is_done,
            )
        )  # fmt: skip
    return tuple(nodes)
