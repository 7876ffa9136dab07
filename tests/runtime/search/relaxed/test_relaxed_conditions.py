"""Conditions as facts: where a condition is true, so are the facts that it needs."""

from itertools import product
from math import isinf

import pytest
from programs import problem_of

from crow.evaluate import evaluate
from crow.problem import State
from crow.search.machine import Machine
from crow.search.relaxed.costs import costs
from crow.search.relaxed.guide import Guiding

DOMAIN = """
typedef T
feature p(x: T)
feature q(x: T)
feature fixed(x: T)
feature at() -> T
feature n() -> int64
def both(x: T) -> bool:
  return p(x) and q(x)
controller c(x: T)
behavior act(x: T):
  goal: p(x)
  body:
    do c(x)
  eff:
    p[x] = True
    q[x] = not q(x)
    at[...] = x
    n[...] += 1
"""
PROBLEM = """
problem "p"
objects:
  a, b: T
init:
  fixed[a] = True
  at[...] = b
"""
CELLS = [("p", ("a",)), ("p", ("b",)), ("q", ("a",)), ("q", ("b",))]
CONDITIONS = [
    "p(a)", "not p(a)", "p(a) and not q(b)", "p(a) or q(b)", "forall x: T: p(x) or q(x)",
    "exists x: T: p(x) and q(x)", "not (p(a) and q(b))", "at() == a", "at() != a", "n() > 1",
    "n() == 0 or p(a)", "both(a)", "exists x: T: both(x)", "fixed(a)", "not fixed(a)",
    "fixed(a) and p(a)", "fixed(b) or p(b)", "p(a) ^ q(a)", "p(a) if q(a) else p(b)",
    "forall x: T: (not fixed(x)) or p(x)",
]  # fmt: skip


@pytest.mark.parametrize("condition", CONDITIONS)
def test_true_conditions_need_only_what_is_true(condition: str) -> None:
    task = problem_of(DOMAIN, f"{PROBLEM}goal: {condition}\n")
    machine = Machine(task)
    guiding = Guiding(machine, "ff")
    needs = guiding.operators.conditions.needs(task.goal, {})
    truths = set()
    for values in product([False, True], repeat=len(CELLS)):
        for at, n in product("ab", (0, 2)):
            changes = {**dict(zip(CELLS, values, strict=True)), ("at", ()): at, ("n", ()): n}
            state = task.world.updated(task.initial, changes)
            is_true = evaluate(task.world, State(state.cells), task.goal, {})
            truths.add(is_true)
            if is_true:
                assert needs is not None
                snapshot = machine.store.after(machine.store.initial, changes.items())
                found = costs(guiding.task, guiding.task.true_facts(snapshot), frozenset())
                assert not any(isinf(found.facts[number]) for number in needs)
                assert not any(found.facts[number] for number in needs)
    if needs is None:
        assert truths == {False}
    if needs == ():
        assert truths == {True}
