"""Unordered groups: what is true already costs no orders."""

import pytest
from programs import problem_of

import crow

MANY = """
typedef Light
feature on(x: Light)
feature broken(x: Light)
feature done()
controller press(x: Light)
behavior switch(x: Light):
  goal: on(x)
  body:
    assert not broken(x)
    do press(x)
  eff:
    on[x] = True
behavior all_on():
  goal: done()
  body:
    foreach x: Light:
      achieve on(x)
  eff:
    done[...] = True
"""


def lights(count: int, off: str, broken: str = "") -> str:
    names = ", ".join(f"l{n}" for n in range(count))
    lines = [f"  on[l{n}] = True" for n in range(count) if f"l{n}" not in off.split()]
    lines += [f"  broken[{name}] = True" for name in broken.split()]
    init = "\n".join(lines)
    return f'problem "p"\nobjects:\n  {names}: Light\ninit:\n{init}\ngoal: done()\n'


@pytest.mark.parametrize("engine", ["iddfs", "auto"])
def test_one_that_cannot_be_achieved_among_many_that_are_true(engine: str) -> None:
    found = crow.plan(problem_of(MANY, lights(14, "l3", "l3")), engine, node_limit=2_000)
    assert isinstance(found, crow.Unsolvable)


def test_those_that_are_false_are_achieved_among_many_that_are_true() -> None:
    found = crow.plan(problem_of(MANY, lights(14, "l3 l9")), "iddfs", node_limit=2_000)
    assert isinstance(found, crow.Plan)
    assert [step.arguments for step in found.steps if step.controller] == [("l3",), ("l9",)]


def test_what_others_undo_is_achieved_again_or_left() -> None:
    """Toggling one light puts out the next, which was on: a method holds nothing that was true."""
    domain = """
    typedef Light
    feature on(x: Light)
    feature next(x: Light, y: Light)
    feature done()
    controller press(x: Light)
    behavior switch(x: Light):
      goal: on(x)
      body:
        do press(x)
      eff:
        on[x] = True
        foreach y: Light:
          if next(x, y):
            on[y] = False
    behavior all_once():
      goal: done()
      body:
        foreach x: Light:
          achieve on(x)
        finish()
    behavior finish():
      eff: done[...] = True
    """
    text = lights(2, "l0").replace("init:", "init:\n  next[l0, l1] = True\n  next[l1, l0] = True")
    problem = problem_of(domain, text)
    plans = {
        tuple(s.arguments[0] for s in p.steps if s.controller)
        for p in crow.plans(problem, "iddfs", depth_limit=3)
    }
    # Left as it was: l1 was on when its turn came. Or achieved after l0, which it puts out.
    assert plans == {("l0",), ("l0", "l1")}
