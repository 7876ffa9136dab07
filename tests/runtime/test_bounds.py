"""Bounds of features: no state of a problem leaves them (language.md §2)."""

import pytest
from programs import problem_of, start

from crow.evaluate import EvaluationError
from crow.problem import World
from crow.transition import Unmet, apply

DOMAIN = """
typedef tank
feature [[min=1, max=5]] level(t: tank) -> int64
feature [[max=2]] height(t: tank) -> int32
behavior add(t: tank, n: tank):
  eff:
    level[t] = 9
    level[t] = level(n) + 1
behavior raise_all():
  eff:
    foreach t: tank:
      height[t] = height(t) + 2
"""


@pytest.mark.parametrize(
    ("init", "message"),
    [
        ("level[a] = 1", "`level(b)` would be 0, and may be 1 to 5"),
        ("level[a] = 2 * 3", "`level(a)` would be 6, and may be 1 to 5"),
        ("foreach t: tank: level[t] = 1\nheight[b] = 1 + 2", "would be 3, and may be at most 2"),
    ],
)
def test_an_initial_value_outside_is_an_error(init: str, message: str) -> None:
    with pytest.raises(EvaluationError) as raised:
        start(DOMAIN, "a, b: tank", init)
    assert message in str(raised.value)
    assert raised.value.location is not None


def test_a_transition_that_ends_outside_cannot_be_applied() -> None:
    world, state = start(DOMAIN, "a, b: tank", "level[a] = 4\nlevel[b] = 5")
    add, raise_all = world.behaviors["add"], world.behaviors["raise_all"]
    added = apply(world, state, add, ("b", "a"))
    assert added.problem is None  # what it held in between does not count
    assert added.state.cells["level", ("b",)] == 5
    assert isinstance(apply(world, state, add, ("a", "b")).problem, Unmet)
    once = apply(world, state, raise_all, ())
    assert once.problem is None
    assert isinstance(apply(world, once.state, raise_all, ()).problem, Unmet)


def test_pairs_that_init_does_not_set_are_not_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    """There may be a hundred million of them."""

    def cells(*_: object) -> None:
        raise AssertionError("every pair is looked at")

    monkeypatch.setattr(World, "cells", cells)
    domain = "typedef T\nfeature [[min=0, max=9]] far(x: T, y: T) -> int64\nfeature g()\n"
    problem = 'problem "p"\nobjects:\n  a, b: T\ninit:\n  far[a, b] = 3\ngoal: g()\n'
    assert problem_of(domain, problem).initial.cells == {("far", ("a", "b")): 3}
