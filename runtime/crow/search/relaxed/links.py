"""What the steps of an outline are for: later steps, by facts that stay true until those."""

from collections.abc import Iterable
from dataclasses import dataclass

from crow.search.code import Code
from crow.search.frames import Application
from crow.search.relaxed.facts import CellFact, Operator, Task
from crow.search.states import Snapshot
from crow.values import Value

Applied = tuple[Code, tuple[Value, ...]]
"""A behavior with its arguments."""

End = tuple[Applied | None, int]
"""A behavior and the step in which it ends; None for the goal, after the last step."""


@dataclass(frozen=True, slots=True)
class Outline:
    """A plan: each step with the operators that make it, and the state before each, and the last.

    `steps` has those states and the ones in between, with the number of the step.
    """

    operators: tuple[tuple[int, ...], ...]
    states: tuple[Snapshot, ...]
    steps: dict[Snapshot, int]


class Links:
    """The links of one outline for some facts that are wanted at last."""

    def __init__(self, task: Task, wanted: frozenset[int], outline: Outline) -> None:
        self.task = task
        self.wanted = wanted
        self.outline = outline
        self.last = len(outline.operators)
        self._operators: list[list[Operator]] = [
            [task.operators[index] for index in operators] for operators in outline.operators
        ]
        self._ends: dict[Applied, list[int]] = {}
        for number, operators in enumerate(self._operators):
            for operator in operators:
                self._ends.setdefault(applied(operator), []).append(number)
        self._beginning: dict[int, dict[Applied, int]] = {}
        self._for: dict[tuple[Applied | None, int], frozenset[End]] = {}

    def at(self, step: int) -> list[Operator]:
        """The operators of a step; each alone makes it."""
        return self._operators[step]

    def end(self, application: Application, step: int) -> End | None:
        """Where an application ends, from a step on; None if nowhere."""
        if application.code is None:
            return None, self.last
        key = application.code, application.arguments
        number = next((n for n in self._ends.get(key, ()) if n >= step), None)
        return None if number is None else (key, number)

    def beginning(self, step: int) -> dict[Applied, int]:
        """The behaviors that may begin at a step, by the step in which they end.

        Those of the step, those that what they make true is for, and so on.
        """
        known = self._beginning.get(step)
        if known is None:
            known = self._beginning[step] = {}
            facts: set[int] = set()
            for number in range(step, self.last):
                facts = self._lasting(facts, number)
                for operator in self._operators[number]:
                    if number == step or not facts.isdisjoint(operator.asked):
                        known.setdefault(applied(operator), number)
                        facts |= self._decided(operator.claims)
        return known

    def is_for(self, behavior: Applied, step: int, end: End) -> bool:
        """Whether a behavior that ends in a step may be applied for one that ends later."""
        return end in self._purposes(behavior, step)

    def purposes(self, step: int) -> frozenset[End]:
        """All that a step may be for."""
        return self._purposes(None, step)

    def _purposes(self, behavior: Applied | None, step: int) -> frozenset[End]:
        known = self._for.get((behavior, step))
        if known is None:
            claims = [
                number
                for operator in self._operators[step]
                if behavior is None or applied(operator) == behavior
                for number in operator.claims
            ]
            known = self._for[behavior, step] = frozenset(self._asking(claims, step))
        return known

    def _asking(self, claims: list[int], step: int) -> Iterable[End]:
        """What asks for facts that a step makes true, while they stay so."""
        facts = self._decided(claims)
        for number in range(step + 1, self.last):
            facts = self._lasting(facts, number)
            for operator in self._operators[number]:
                if not facts.isdisjoint(operator.asked):
                    yield applied(operator), number
        if not self._lasting(facts, self.last).isdisjoint(self.wanted):
            yield None, self.last

    def _lasting(self, facts: set[int], step: int) -> set[int]:
        """Those of some facts that are true before a step, as far as states say."""
        task, state = self.task, self.outline.states[step]
        return {
            number
            for number in facts
            if not isinstance(task.facts[number], CellFact) or task.is_true(number, state)
        }

    def _decided(self, facts: Iterable[int]) -> set[int]:
        """Facts, and the choices of conditions that they decide."""
        task, pending = self.task, list(facts)
        found: set[int] = set()
        while pending:
            number = pending.pop()
            if number not in found:
                found.add(number)
                for index in task.consumers[number]:
                    if task.operators[index].code is None:
                        pending.extend(task.operators[index].claims)
        return found

    def useless(self) -> list[int]:
        """The steps that are for nothing that is wanted at last."""
        useful = {self.last}
        for step in reversed(range(self.last)):
            if any(number in useful for _, number in self.purposes(step)):
                useful.add(step)
        return [step for step in range(self.last) if step not in useful]


def applied(operator: Operator) -> Applied:
    """The behavior of an operator, with its arguments."""
    assert operator.code is not None
    return operator.code, operator.arguments
