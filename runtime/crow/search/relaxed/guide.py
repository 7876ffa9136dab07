"""The heuristic of the search: how much is left to do, and by which behaviors."""

from dataclasses import dataclass, field
from math import inf, isinf

from crow.search.code import Code
from crow.search.expressions import Environment
from crow.search.frames import Context
from crow.search.machine import Machine
from crow.search.points import Point
from crow.search.relaxed.costs import Costs, costs, relaxed_plan
from crow.search.relaxed.facts import CellFact, Task
from crow.search.relaxed.operators import Operators
from crow.search.relaxed.remaining import Left, Remaining, agrees
from crow.search.states import Snapshot
from crow.values import Value

BROKEN = 1_000
"""Added where something that has to stay true would have to be made true again."""

EARLY = 4
"""Added for each goal that was begun before others that cannot follow it."""


@dataclass(slots=True, eq=False)
class Guide:
    """How much is left at a point, and what a relaxed plan applies on the way.

    `begun` counts the behaviors that have begun, `helpful` those of the plan that may run now.
    """

    state: Snapshot
    cost: float
    begun: int = 0
    helpful: int = 0
    uses: dict[tuple[Code, tuple[Value, ...]], list[Environment]] = field(default_factory=dict)

    def uses_behavior(self, code: Code, arguments: tuple[Value, ...], _above: object) -> bool:
        """Whether the relaxed plan applies a behavior."""
        return (code, arguments) in self.uses

    def prefers(self, context: Context) -> bool:
        """Whether a behavior is applied as the relaxed plan applies it."""
        application = context.application
        if application.code is None:
            return True
        uses = self.uses.get((application.code, application.arguments), ())
        return any(agrees(planned, context.values) for planned in uses)


class Guiding:
    """Evaluates points of one machine; `heuristic` is `ff` or `add`."""

    def __init__(self, machine: Machine, heuristic: str) -> None:
        self.machine = machine
        self.heuristic = heuristic
        self.task = Task(machine.store.defaults)
        self.operators = Operators(machine.programs, self.task, machine.store.initial)
        self.remaining = Remaining(self.operators, self.task, machine.store.initial)
        self.evaluations = 0
        self._costs: dict[tuple[Snapshot, frozenset[int]], Costs] = {}
        self._early: dict[tuple[Snapshot, int, int, frozenset[int]], bool] = {}
        self._destroyers: dict[tuple[int, int, int], frozenset[int]] = {}
        self._size = 0

    def guide(self, point: Point) -> Guide:
        """What is left at a point."""
        self.evaluations += 1
        left = self.remaining.left(point.context, point.frame)
        self.operators.close()
        if not left.is_possible:
            return Guide(point.state, inf)
        task, state = self.task, point.state
        made = {number for index in left.begun for number in task.operators[index].made}
        kept = [number for number in left.kept if number not in made]
        lost = [(n, above) for n, above in left.held if not task.is_true(n, state)]
        lost += [(n, frozenset()) for n in kept if not task.is_true(n, state)]
        without = frozenset(
            index for n in kept if task.is_true(n, state) for index in self.destroyers(n)
        )
        cost, plan, broken = self._planned(state, left, made, lost, without)
        true = self._found(state, without).facts
        if isinf(cost) and without:
            cost, plan, broken = self._planned(state, left, made, lost, frozenset())
            broken += 1
        broken += left.broken + sum(left.consumed.values()) - len(left.consumed)
        broken += sum(n in kept for index in left.begun for n in task.destroyed(index))
        if not isinf(cost) and left.begun:
            cost += EARLY * self._count_early(state, left, without)
        guide = Guide(state, cost + broken * BROKEN, sum(left.begun.values()))
        for index in plan:
            operator = task.operators[index]
            if operator.code is not None:
                guide.helpful += not any(true[need] for need in operator.needs)
                key = (operator.code, operator.arguments)
                guide.uses.setdefault(key, []).append(operator.values)
        return guide

    def _planned(
        self,
        state: Snapshot,
        left: Left,
        made: set[int],
        lost: list[tuple[int, frozenset[int]]],
        without: frozenset[int],
    ) -> tuple[float, set[int], int]:
        """The cost, a relaxed plan, and how much that is lost it does not bring back by itself."""
        found = self._found(state, without)
        wanted = [number for number in left.wanted if number not in made]
        total = sum(found.facts[number] for number in wanted)
        operators = self.task.operators
        if isinf(total):
            return inf, set(), 0
        plan = set(left.begun)
        relaxed_plan(self.task, found, wanted, plan)
        if lost:
            lost = [
                (number, above)
                for number, above in lost
                if not any(number in operators[index].made for index in plan - above)
            ]
            numbers = [number for number, _ in lost]
            relaxed_plan(self.task, found, numbers, plan)
            total += sum(found.facts[number] for number in numbers)
            if isinf(total):
                return inf, set(), 0
        if self.heuristic == "add":
            total += sum(operators[index].cost for index in left.begun) + left.cost
            return total, plan, len(lost)
        return sum(operators[index].cost for index in plan) + left.cost, plan, len(lost)

    def _found(self, state: Snapshot, without: frozenset[int]) -> Costs:
        size = len(self.task.facts) + len(self.task.operators)
        if size != self._size:
            self._costs.clear()
            self._size = size
            self._early.clear()
        found = self._costs.get((state, without))
        if found is None:
            true = self.task.true_facts(state)
            found = self._costs[state, without] = costs(self.task, true, without)
        return found

    def _count_early(self, state: Snapshot, left: Left, without: frozenset[int]) -> int:
        """Goals that were begun before others that cannot follow them."""
        task, count = self.task, 0
        for index in left.begun:
            goals = [n for n in task.operators[index].claims if n in left.goals]
            for goal in goals:
                key = (state, index, goal, without)
                if key not in self._early:
                    self._early[key] = self._is_early(state, index, goal, left, without)
                count += self._early[key]
        return count

    def _is_early(
        self, state: Snapshot, index: int, goal: int, left: Left, without: frozenset[int]
    ) -> bool:
        """Whether other goals are out of reach once a behavior has made one true.

        That is tried in what a relaxed plan for it leaves true (after Koehler and Hoffmann's
        reasonable orders).
        """
        task = self.task
        plan = {index}
        relaxed_plan(task, self._found(state, without), task.operators[index].needs, plan)
        gone = {n for i in plan for n in task.destroyed(i)}
        gone -= {n for i in plan for n in task.operators[i].made}
        gone.update(task.destroyed(index))
        true = {n for i in plan for n in task.operators[i].made}.union(
            task.true_facts(state)
        ) - gone
        kept = without | self.destroyers(goal)
        found = costs(task, true, frozenset(kept))
        return any(isinf(found.facts[number]) for number in left.goals)

    def destroyers(self, number: int) -> frozenset[int]:
        """The operators that make a fact false for certain."""
        task = self.task
        fact = task.facts[number]
        if not isinstance(fact, CellFact):
            return frozenset()
        key = number, len(task.facts), len(task.operators)
        found = self._destroyers.get(key)
        if found is None:
            writers = task.writers.get(fact.cell, ())
            found = frozenset(index for index in writers if number in task.destroyed(index))
            self._destroyers[key] = found
        return found
