"""Costs of facts where nothing becomes false, against the plain fixed point of their definition."""

from math import inf, isinf

from hypothesis import given
from hypothesis import strategies as st

from crow.search.relaxed.costs import SIDE_EFFECT, costs, relaxed_plan
from crow.search.relaxed.facts import Made, Operator, Task

FACTS = 6


def task_of(operators: list[tuple[int, tuple[int, ...], list[int], list[int]]]) -> Task:
    task = Task({})
    for number in range(FACTS):
        task.fact(Made(number))
    for cost, needs, claims, adds in operators:
        task.operator(Operator(cost, needs, claims, adds))
    return task


numbers = st.integers(0, FACTS - 1)
tasks = st.lists(
    st.tuples(
        st.integers(0, 3),
        st.lists(numbers, max_size=3, unique=True).map(tuple),
        st.lists(numbers, max_size=2, unique=True),
        st.lists(numbers, max_size=2, unique=True),
    ),
    max_size=8,
).map(task_of)
some = st.frozensets(numbers, max_size=2)


def fixed_point(task: Task, true: frozenset[int], without: frozenset[int]) -> list[float]:
    known = [0.0 if number in true else inf for number in range(FACTS)]
    for _ in range(len(task.operators) * FACTS + 1):
        for index, operator in enumerate(task.operators):
            if index in without:
                continue
            total = operator.cost + sum(known[need] for need in operator.needs)
            for number in operator.claims:
                known[number] = min(known[number], total)
            for number in operator.adds:
                known[number] = min(known[number], total + SIDE_EFFECT)
    return known


@given(tasks, some, some)
def test_costs_are_the_fixed_point(
    task: Task, true: frozenset[int], without: frozenset[int]
) -> None:
    without = frozenset(index for index in without if index < len(task.operators))
    found = costs(task, true, without).facts
    for own, other in zip(found, fixed_point(task, true, without), strict=True):
        assert own == other or abs(own - other) < 1e-9


@given(tasks, some, some)
def test_a_relaxed_plan_runs_where_nothing_becomes_false(
    task: Task, true: frozenset[int], wanted: frozenset[int]
) -> None:
    found = costs(task, true, frozenset())
    if any(isinf(found.facts[number]) for number in wanted):
        return
    plan: set[int] = set()
    relaxed_plan(task, found, wanted, plan)
    reached, left = set(true), set(plan)
    while ready := {i for i in left if reached.issuperset(task.operators[i].needs)}:
        left -= ready
        reached.update(n for i in ready for n in task.operators[i].made)
    assert not left
    assert reached >= wanted


def test_of_two_equally_near_the_one_applied_for_a_fact_supports_it() -> None:
    task = task_of([(1, (), [], [0]), (1, (), [0], [])])
    found = costs(task, [], frozenset())
    assert found.facts[0] == 1
    assert found.supporters[0] == 1
