"""Facts and operators: what links them, in whichever order they are found."""

from itertools import permutations

import pytest

from crow.problem import State, World
from crow.program import Program
from crow.search.relaxed.facts import CellFact, Fact, Made, OpaqueFact, Operator, Task, Write
from crow.search.states import Snapshot, Store

ON_A, ON_B = ("on", ("a",)), ("on", ("b",))
TRUE_A = CellFact(ON_A, value=True, is_equal=True)
FALSE_A = CellFact(ON_A, value=False, is_equal=True)
NOT_TWO = CellFact(("n", ()), 2, is_equal=False)
IS_LIT = OpaqueFact(lambda state, _: bool(state.delta.get(ON_B)), (), frozenset({"on"}))
FACTS: list[Fact] = [TRUE_A, FALSE_A, NOT_TWO, IS_LIT]

CERTAIN = Write("on", ("a",), value=True, is_certain=True)
OPEN = Write("on", (None,), value=True, is_certain=True)
UNKNOWN = Write("on", ("a",), value=None, is_certain=True)
TWO = Write("n", (), 2, is_certain=True)
THREE = Write("n", (), 3, is_certain=True)


@pytest.mark.parametrize(
    ("write", "made"),
    [
        (CERTAIN, {TRUE_A, IS_LIT}),
        (OPEN, {TRUE_A, IS_LIT}),
        (UNKNOWN, {TRUE_A, FALSE_A, IS_LIT}),
        (TWO, set()),
        (THREE, {NOT_TWO}),
    ],
)
def test_a_write_makes_true_what_it_may_make_so(write: Write, made: set[Fact]) -> None:
    for order in permutations([*FACTS, write]):
        task = Task({"on": False, "n": 0})
        for one in order:
            if isinstance(one, Write):
                task.operator(Operator(1, (), writes=(one,)))
            else:
                task.fact(one)
        assert {task.facts[number] for number in task.operators[0].adds} == made


@pytest.mark.parametrize(
    ("write", "gone"),
    [
        (CERTAIN, {FALSE_A}),
        (CERTAIN._replace(is_certain=False), set()),
        (OPEN, set()),
        (UNKNOWN, set()),
        (TWO, {NOT_TWO}),
    ],
)
def test_only_certain_writes_of_known_values_destroy(write: Write, gone: set[Fact]) -> None:
    task = Task({"on": False, "n": 0})
    for fact in FACTS:
        task.fact(fact)
    index = task.operator(Operator(1, (), writes=(write,)))
    assert {task.facts[number] for number in task.destroyed(index)} == gone


@pytest.mark.parametrize("delta", [{}, {ON_A: True}, {ON_B: True}, {("n", ()): 2}])
def test_the_true_facts_are_those_that_are_true(
    delta: dict[tuple[str, tuple[str, ...]], int],
) -> None:
    task = Task({"on": False, "n": 0})
    known = [task.fact(fact) for fact in [*FACTS, Made("never")]]
    state = Snapshot(Store(World(Program("empty"), {}), State()), dict(delta))
    assert set(task.true_facts(state)) == {n for n in known if task.is_true(n, state)}
    assert task.is_true(0, state) is (ON_A in delta)
    assert task.is_true(2, state) is (("n", ()) not in delta)
    assert task.is_true(3, state) is (ON_B in delta)
