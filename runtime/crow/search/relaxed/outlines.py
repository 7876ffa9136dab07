"""Outlines: plans for what is wanted at first, searched among states alone.

What is left to do is no part of a state here, so that there are few of them. Whether the program
can go along an outline is for `crow.search.follow` to find out.
"""

from collections.abc import Callable, Iterator, Sequence
from heapq import heappop, heappush
from math import inf, isinf
from typing import Final, NamedTuple

from crow.search.machine import Machine
from crow.search.points import Choice, Point
from crow.search.relaxed.costs import Costs, costs, relaxed_plan
from crow.search.relaxed.facts import CellFact, Operator
from crow.search.relaxed.guide import EARLY, Guiding
from crow.search.relaxed.links import Links, Outline, applied
from crow.search.relaxed.remaining import agrees
from crow.search.states import Snapshot

PUT_OFF: Final = 5
"""What it costs to go by an operator that the relaxed plan does not use."""


class _Seen(NamedTuple):
    """How far a state is from what is wanted, and the operators that may run there."""

    cost: float
    helpful: list[int]
    others: list[int]


class _Item(NamedTuple):
    """A state in the queue with operators that were not tried; the last of equal ones is first."""

    total: float
    number: int
    state: Snapshot
    operators: list[int]
    times: int


class Outlines:
    """The search for outlines from the start. `check` is called again and again and may raise."""

    def __init__(self, machine: Machine, guiding: Guiding, check: Callable[[], None]) -> None:
        self.machine = machine
        self.guiding = guiding
        self.task = guiding.task
        self.check = check
        start = machine.start()
        left = guiding.remaining.left(start.context, start.frame)
        guiding.operators.close()
        self.initial = start.state
        self.is_possible = left.is_possible
        self.wanted = frozenset(left.wanted)
        self._queue: list[_Item] = []
        self._pushed = 0
        self._before: dict[Snapshot, Snapshot] = {}
        self._seen: dict[Snapshot, _Seen] = {}

    def links(self, outline: Outline) -> Links:
        """What the steps of an outline are for."""
        return Links(self.task, self.wanted, outline)

    def search(self, states: int) -> Iterator[Outline | None]:
        """An outline, after None for each state searched; none within so many states: nothing."""
        if not self.is_possible or self._is_done(self.initial):
            return
        self._push(self.initial, self._see(self.initial).helpful, 0)
        while self._queue and len(self._seen) < states:
            yield None
            item = heappop(self._queue)
            if isinf(item.total):
                return
            last = self._go_on(item)
            if last is not None:
                yield self.outline(self._path(last))
                return

    def _push(self, state: Snapshot, operators: list[int], times: int) -> None:
        total = self._seen[state].cost + PUT_OFF * times
        self._pushed += 1
        heappush(self._queue, _Item(total, -self._pushed, state, operators, times))

    def _go_on(self, item: _Item) -> Snapshot | None:
        """Try operators up to one that leads no farther away; the state where all is done, if so.

        The others are tried when nothing better is left.
        """
        state, seen = item.state, self._seen[item.state]
        for place, index in enumerate(item.operators):
            self.check()
            states = self.run(state, index)
            if states is None or states[-1] in self._seen:
                continue
            after = states[-1]
            self._before[after] = state
            found = self._see(after)
            if self._is_done(after):
                return after
            self._push(after, found.helpful, item.times)
            if found.cost <= seen.cost:
                self._push(state, item.operators[place + 1 :], item.times)
                return None
        if item.operators is not seen.others and seen.others:
            self._push(state, seen.others, item.times + 1)
        return None

    def _is_done(self, state: Snapshot) -> bool:
        task = self.task
        return all(
            task.is_true(number, state)
            for number in self.wanted
            if isinstance(task.facts[number], CellFact)
        )

    # ---------------------------------------------------------------------------------- evaluation

    def _see(self, state: Snapshot) -> _Seen:
        """Evaluate a state. Operators that make true what is wanted at last come first."""
        self.guiding.evaluations += 1
        task = self.task
        cost, found = self._found(list(task.true_facts(state)))
        plan: set[int] = set()
        if not isinf(cost):
            relaxed_plan(task, found, self.wanted, plan)
            cost += sum(task.operators[index].cost for index in plan)
        facts = found.facts
        helpful: list[int] = []
        others: list[int] = []
        for index, operator in enumerate(task.operators):
            if operator.code is not None and not any(facts[need] for need in operator.needs):
                (helpful if index in plan else others).append(index)
        helpful.sort(key=lambda index: self.wanted.isdisjoint(task.operators[index].claims))
        seen = self._seen[state] = _Seen(cost, helpful, others)
        return seen

    def _found(self, true: list[int]) -> tuple[float, Costs]:
        """What facts cost if no goal is lost that may stay; and a price for goals that may not.

        Those came too early: others are out of reach while they are true (after Koehler and
        Hoffmann's reasonable orders).
        """
        task, now = self.task, set(true)
        goals = [number for number in self.wanted if number in now]
        found = costs(task, true, self._destroying(goals))
        if not self._is_far(found):
            return 0, found
        early = [n for n in goals if self._is_far(costs(task, true, self._destroying([n])))]
        found = costs(task, true, self._destroying([n for n in goals if n not in early]))
        if self._is_far(found):
            found = costs(task, true, frozenset())
        return (inf if self._is_far(found) else EARLY * max(len(early), 1)), found

    def _is_far(self, found: Costs) -> bool:
        return any(isinf(found.facts[number]) for number in self.wanted)

    def _destroying(self, facts: Sequence[int]) -> frozenset[int]:
        """The operators that make any of some facts false for certain."""
        return frozenset().union(*map(self.guiding.destroyers, facts))

    # ------------------------------------------------------------------------------------- running

    def run(self, state: Snapshot, index: int) -> list[Snapshot] | None:
        """The states through which an operator goes, if it runs with no other behavior's help."""
        operator, machine = self.task.operators[index], self.machine
        code = operator.code
        assert code is not None
        if None in operator.arguments:
            return None
        application = machine.shared.application(code, operator.arguments, 0, ())
        context = machine.shared.context(application, operator.values, ())
        point: Point | None = Point(state, context, machine.right(code, None), None, None)
        states: list[Snapshot] = []
        while point is not None:
            step = machine.run(point)
            if isinstance(step, Point):
                return [*states, step.state] if step.state is not state else None
            if step is None:
                return None
            states.append(step.point.state)
            point = next((p for p in step.options if _is_own(p, step, operator)), None)
        return None

    def _path(self, last: Snapshot) -> list[Snapshot]:
        path = [last]
        while path[-1] is not self.initial:
            path.append(self._before[path[-1]])
        return path[::-1]

    def outline(self, path: list[Snapshot]) -> Outline:
        """The outline that goes through some states, without steps that it can do without."""
        found = self._through(path)
        useless = self.links(found).useless()
        return self._through(self._shortened(found, useless)) if useless else found

    def _through(self, path: list[Snapshot]) -> Outline:
        steps: dict[Snapshot, int] = {}
        operators = []
        for number, state in enumerate(path[:-1]):
            seen = self._seen.get(state) or self._see(state)
            found = []
            for index in (*seen.helpful, *seen.others):
                states = self.run(state, index)
                if states is not None and states[-1] is path[number + 1]:
                    found.append(index)
                    for between in (state, *states[:-1]):
                        steps.setdefault(between, number)
            operators.append(tuple(found))
        steps.setdefault(path[-1], len(operators))
        return Outline(tuple(operators), tuple(path), steps)

    def _shortened(self, outline: Outline, useless: list[int]) -> list[Snapshot]:
        """The states without each useless step, and what then does not run, if all is still done.

        After Nakhost and Müller's action elimination.
        """
        plan = [operators[0] for operators in outline.operators]
        path = list(outline.states)
        for number in reversed(useless):
            kept, states = plan[:number], path[: number + 1]
            for index in plan[number + 1 :]:
                after = self.run(states[-1], index)
                if after is not None:
                    kept.append(index)
                    states.append(after[-1])
            if self._is_done(states[-1]):
                plan, path = kept, states
        return path


def _is_own(point: Point, choice: Choice, operator: Operator) -> bool:
    """Whether an option only chooses objects, and as the operator does."""
    before, after = choice.point.context, point.context
    if before is None or after is None or before.application is not after.application:
        return False
    own = after.application
    if (own.code, own.arguments) != applied(operator):  # of a behavior that this one calls
        return False
    return agrees(operator.values, after.values)
