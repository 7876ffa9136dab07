"""Costs of facts where nothing becomes false (h_add), and a relaxed plan from them (h_ff)."""

from collections.abc import Iterable
from heapq import heappop, heappush
from math import inf
from typing import NamedTuple

from crow.search.relaxed.facts import Operator, Task

SIDE_EFFECT = 0.01
"""So that of two behaviors equally near, the one applied for a fact makes it true."""


class Costs(NamedTuple):
    """What each fact costs, and the operator that makes it true; -1 where none has to."""

    facts: list[float]
    supporters: list[int]


def costs(task: Task, true: Iterable[int], without: frozenset[int]) -> Costs:
    """The cost of every fact, by adding up; the operators in `without` are left out."""
    operators, consumers = task.operators, task.consumers
    known = [inf] * len(task.facts)
    supporters = [-1] * len(task.facts)
    missing = [len(o.needs) for o in operators]
    totals: list[float] = [o.cost for o in operators]
    queue: list[tuple[float, int]] = []
    for index in without:
        missing[index] = -1
    for number in true:
        known[number] = 0
        queue.append((0, number))
    for index, operator in enumerate(operators):
        if not missing[index]:
            _made(operator, totals[index], index, known, supporters, queue)
    queue.sort()
    while queue:
        cost, number = heappop(queue)
        if cost > known[number]:
            continue
        for index in consumers[number]:
            missing[index] -= 1
            totals[index] += cost
            if not missing[index]:
                _made(operators[index], totals[index], index, known, supporters, queue)
    return Costs(known, supporters)


def _made(
    operator: Operator, total: float, index: int, known: list[float], supporters: list[int],
    queue: list[tuple[float, int]],
) -> None:  # fmt: skip
    for number in operator.claims:
        if total < known[number]:
            known[number] = total
            supporters[number] = index
            heappush(queue, (total, number))
    total += SIDE_EFFECT
    for number in operator.adds:
        if total < known[number]:
            known[number] = total
            supporters[number] = index
            heappush(queue, (total, number))


def relaxed_plan(task: Task, found: Costs, wanted: Iterable[int], plan: set[int]) -> None:
    """Add to a plan the operators that make some facts true, each once.

    What the operators that are in it need is not asked for.
    """
    pending = list(wanted)
    seen = set(pending)
    supporters, operators = found.supporters, task.operators
    while pending:
        index = supporters[pending.pop()]
        if index >= 0 and index not in plan:
            plan.add(index)
            for need in operators[index].needs:
                if need not in seen:
                    seen.add(need)
                    pending.append(need)
