"""One behavior applied: preconditions here and at the next step, binds, blocks, calls."""

from collections.abc import Mapping
from textwrap import dedent, indent

import pytest
from programs import start

from crow.problem import State, World
from crow.trace import AssertItem, DoItem, EffItem
from crow.transition import Ambiguous, Transition, Unmet, apply
from crow.values import Value

DECLARATIONS = """
typedef T
typedef U: T
feature p(x: T)
feature q(x: T)
feature on(x: T, y: T)
feature f(x: T) -> int64
feature place(x: T) -> T
controller go(x: T)
controller put(x: T, y: T)
controller spoil(x: T):
  eff:
    p[x] = False
controller make(x: T):
  eff:
    p[x] = True
"""
OBJECTS = "a, b: T; c: U"


def world_of(behaviors: str, init: str = "pass") -> tuple[World, State]:
    return start(DECLARATIONS + dedent(behaviors), OBJECTS, init)


def applied(
    body: str,
    init: str = "pass",
    bindings: Mapping[str, Value] | None = None,
    eff: str | None = "q[x] = True",
    *arguments: str,
) -> Transition:
    """`act(x: T)` applied to `a`, its body and effect given as text."""
    text = "behavior act(x: T):\n  body:\n" + indent(dedent(body), "    ") + "\n"
    if eff is not None:
        text += "  eff:\n" + indent(dedent(eff), "    ") + "\n"
    world, state = world_of(text, init)
    return apply(world, state, world.behaviors["act"], arguments or ("a",), bindings)


def calls(transition: Transition) -> list[str]:
    return [f"{c.controller}({', '.join(c.arguments)})" for c in transition.calls]


def unmet(transition: Transition) -> tuple[str, str]:
    assert isinstance(transition.problem, Unmet), transition.problem
    assert transition.problem.location is not None
    return transition.problem.condition, transition.problem.reason


WHERE = "it is false where it stands"
LATER = "it no longer holds at the next step of the behavior"


# -------------------------------------------------------------------------------- preconditions


@pytest.mark.parametrize("word", ["assert", "achieve"])
def test_a_condition_is_tested_where_it_stands(word: str) -> None:
    assert unmet(applied(f"{word} p(x)")) == ("p(x)", WHERE)
    assert applied(f"{word} p(x)", "p[a] = True").problem is None
    # after the controller that makes it true, and before the one that makes it false
    assert applied(f"do make(x)\n{word} p(x)").problem is None
    assert applied(f"{word} p(x)\ndo spoil(x)", "p[a] = True").problem is None
    assert unmet(applied(f"do spoil(x)\n{word} p(x)", "p[a] = True")) == ("p(x)", WHERE)


def test_a_failed_condition_stops_before_what_follows() -> None:
    stopped = applied("do go(x)\nassert p(x)\ndo go(x)")
    assert calls(stopped) == ["go(a)"]
    assert not any(isinstance(item, EffItem) for item in stopped.trace)


def test_what_held_before_a_do_need_not_hold_after_it() -> None:
    """semantics.md §2: until the next `do` is reached, or the effect when none follows."""
    assert applied("assert p(x)\ndo spoil(x)", "p[a] = True").problem is None
    assert applied("assert p(x)\ndo spoil(x)\ndo go(x)", "p[a] = True").problem is None


CALLED = """
behavior spoiling(x: T):
  eff:
    p[x] = False
behavior act(x: T):
  body:
    {condition}
    spoiling(x)
    {step}
  eff:
    q[x] = True
"""


@pytest.mark.parametrize("step", ["do go(x)", "pass"])
@pytest.mark.parametrize("condition", ["assert p(x)", "achieve p(x)", "bind y: T where: p(y)"])
def test_a_condition_must_still_hold_at_the_next_step(condition: str, step: str) -> None:
    world, state = world_of(CALLED.format(condition=condition, step=step), "p[a] = True")
    condition, reason = unmet(apply(world, state, world.behaviors["act"], ("a",)))
    assert reason == LATER


def test_achieve_once_is_no_precondition() -> None:
    assert applied("achieve_once p(x)\ndo go(x)").problem is None
    text = CALLED.format(condition="achieve_once p(x)", step="do go(x)")
    world, state = world_of(text, "p[a] = True")
    assert apply(world, state, world.behaviors["act"], ("a",)).problem is None


def test_a_method_holds_nothing() -> None:
    text = CALLED.format(condition="assert p(x)", step="do go(x)").rsplit("  eff:", 1)[0]
    world, state = world_of(text, "p[a] = True")
    done = apply(world, state, world.behaviors["act"], ("a",))
    assert done.problem is None
    assert calls(done) == ["go(a)"]


def test_the_conditions_checked_again_are_in_the_trace() -> None:
    text = CALLED.format(condition="assert not q(x)", step="do go(x)")
    world, state = world_of(text, "p[a] = True")
    done = apply(world, state, world.behaviors["act"], ("a",))
    shown = [i.text if isinstance(i, AssertItem) else type(i).__name__ for i in done.trace]
    assert shown == ["not q(x)", "EffItem", "not q(x)", "DoItem", "EffItem"]


def test_conditions_on_value_binds_are_not_held() -> None:
    body = "bind k: int64 where: f(x) == k\nassert k > 1\nspoiling(x)\ndo go(x)"
    text = f"""
behavior spoiling(x: T):
  eff:
    f[x] = 0
behavior act(x: T):
  body:
{indent(body, "    ")}
  eff:
    q[x] = True
"""
    world, state = world_of(text, "f[a] = 5")
    act = world.behaviors["act"]
    assert apply(world, state, act, ("a",), {"k": 5}).problem is None
    assert unmet(apply(world, state, act, ("a",), {"k": 4})) == ("f(x) == k", WHERE)
    assert unmet(apply(world, state, act, ("a",)))[1] == "a value of type `int64` has to be given"


# ----------------------------------------------------------------------------------------- binds


def test_a_bind_that_the_state_determines() -> None:
    done = applied("bind y: T where: on(x, y)\ndo put(x, y)", "on[a, c] = True")
    assert calls(done) == ["put(a, c)"]
    assert done.bindings == {"y": "c"}


def test_a_bind_ranges_over_its_type() -> None:
    done = applied("bind y: U\ndo put(x, y)")
    assert done.bindings == {"y": "c"}


def test_an_ambiguous_bind_lists_its_choices() -> None:
    body = "bind y: T where: on(x, y)\ndo put(x, y)"
    init = "on[a, b] = True; on[a, c] = True"
    open_ = applied(body, init).problem
    assert isinstance(open_, Ambiguous)
    assert (open_.variable, open_.choices) == ("y", ("b", "c"))
    assert calls(applied(body, init, {"y": "c"})) == ["put(a, c)"]
    assert unmet(applied(body, init, {"y": "a"})) == ("on(x, y)", WHERE)


def test_an_impossible_bind() -> None:
    assert unmet(applied("bind y: T where: on(x, y)"))[1] == "no object can be `y`"


def test_several_variables_are_bound_together() -> None:
    body = "bind y: T, z: T where: on(x, y) and on(y, z)\ndo put(y, z)"
    init = "on[a, b] = True; on[b, c] = True; on[a, a] = False"
    assert calls(applied(body, init)) == ["put(b, c)"]
    more = init + "; on[a, c] = True; on[c, a] = True"
    open_ = applied(body, more).problem
    assert isinstance(open_, Ambiguous)
    assert (open_.variable, open_.choices) == ("y", ("b", "c"))
    assert calls(applied(body, more, {"z": "a"})) == ["put(c, a)"]
    reason = unmet(applied(body, "pass"))[1]
    assert reason == "no object can be `y` and `z`"


def test_a_bind_may_shadow_a_parameter_and_is_chosen_by_a_name_of_its_own() -> None:
    body = "do go(x)\nbind x: T where: on(x, x)\ndo go(x)"
    init = "on[b, b] = True"
    done = applied(body, init)
    assert calls(done) == ["go(a)", "go(b)"]
    assert done.bindings == {"x_2": "b"}
    assert calls(applied(body, init + "; on[c, c] = True", {"x_2": "c"})) == ["go(a)", "go(c)"]


def test_two_binds_of_one_name_are_two_choices() -> None:
    body = "bind y: T\ndo go(y)\nbind y: T where: not p(y)\ndo go(y)"
    done = applied(body, "pass", {"y": "a", "y_2": "b"})
    assert calls(done) == ["go(a)", "go(b)"]
    assert done.bindings == {"y": "a", "y_2": "b"}


def test_the_effect_sees_what_the_body_bound() -> None:
    done = applied("bind y: T where: on(x, y)\nlet z = y", "on[a, c] = True", eff="q[z] = True")
    assert done.state.cells == {("on", ("a", "c")): True, ("q", ("c",)): True}


# ---------------------------------------------------------------------------------------- blocks


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("let y = x\ndo go(y)", ["go(a)"]),
        ("let k = 1\nk = k + 1\nif k == 2: do go(x)", ["go(a)"]),
        ("let k = 0\nfor i in range(3): k = k + i\nif k == 3: do go(x)", ["go(a)"]),
        ("if p(x): do go(x)\nelse: do put(x, x)", ["put(a, a)"]),
        ("let k = 1\nif True:\n  k = 2\nif k == 2: do go(x)", ["go(a)"]),
        ("for i in range(2): do go(x)", ["go(a)", "go(a)"]),
        ("foreach y: T: do put(x, y)", ["put(a, a)", "put(a, b)", "put(a, c)"]),
        ("foreach y: U, z: U: do put(y, z)", ["put(c, c)"]),
        ("sequential:\n  do go(x)\n  do put(x, x)", ["go(a)", "put(a, a)"]),
        ("unordered:\n  achieve not p(x)\n  achieve not q(x)\ndo go(x)", ["go(a)"]),
        ("promotable:\n  achieve not p(x)\n  do go(x)", ["go(a)"]),
        ("do go(x)\ncommit\ndo go(x)", ["go(a)", "go(a)"]),
        # what a block declares ends with it
        ("let y = x\nif True:\n  let y = place(x)\n  do go(y)\ndo go(y)", ["go(c)", "go(a)"]),
        ("sequential:\n  bind x: U\n  do go(x)\ndo go(x)", ["go(c)", "go(a)"]),
        ("foreach x: U: do go(x)\ndo go(x)", ["go(c)", "go(a)"]),
        ("let i = x\nfor i in range(1): pass\ndo go(i)", ["go(a)"]),
    ],
)
def test_bodies(body: str, expected: list[str]) -> None:
    done = applied(body, "place[a] = c")
    assert done.problem is None
    assert calls(done) == expected


def test_an_alternative_is_left_to_search() -> None:
    condition, reason = unmet(applied("alternative:\n  do go(x)\n  do spoil(x)"))
    assert (condition, reason) == ("alternative", "its choice is made by search")


@pytest.mark.parametrize(
    ("body", "condition"),
    [
        ("assert p(place(x))", "p(place(x))"),
        ("let y = place(x)", "place(x)"),
        ("do go(place(x))", "place(x)"),
        ("if 1 // f(x) == 1: do go(x)", "1 // f(x) == 1"),
        ("bind y: T where: p(place(y))", "p(place(y))"),
        ("pass", "eff of act"),
    ],
)
def test_a_computation_without_a_value_is_unmet_with_its_place(body: str, condition: str) -> None:
    stopped = applied(body, eff="p[place(x)] = True")
    assert unmet(stopped)[0] == condition
    assert unmet(stopped)[1] in ("division by zero", "`place(a)` has no value")


# --------------------------------------------------------------------------- controllers and calls


def test_a_controllers_effect_follows_its_do() -> None:
    done = applied("do make(x)\ndo go(x)", eff="q[x] = p(x)")
    kinds = [type(item).__name__ for item in done.trace]
    assert kinds == ["DoItem", "EffItem", "DoItem", "EffItem"]
    first = done.trace[1]
    assert isinstance(first, EffItem)
    assert (first.owner, first.variables) == ("make", {"x": "a"})
    assert done.state.cells == {("p", ("a",)): True, ("q", ("a",)): True}


def test_arguments_are_values_of_the_moment_of_the_call() -> None:
    text = """
    controller move(x: T):
      eff:
        place[x] = x
    behavior act(x: T):
      body:
        do go(place(x))
        do move(x)
        do go(place(x))
    """
    world, state = world_of(text, "place[a] = c")
    assert calls(apply(world, state, world.behaviors["act"], ("a",))) == [
        "go(c)",
        "move(a)",
        "go(a)",
    ]


NESTED = """
behavior inner(z: T):
  body:
    bind y: T where: on(z, y)
    do put(z, y)
  eff:
    on[z, y] = False
behavior act(x: T):
  body:
    bind w: T where: on(w, x)
    inner(w)
    do go(x)
  eff:
    q[x] = True
"""


def test_a_called_behavior_runs_where_the_call_stands() -> None:
    world, state = world_of(NESTED, "on[b, a] = True")
    done = apply(world, state, world.behaviors["act"], ("a",))
    # `on(w, x)` was required before the call and is gone at the next `do`
    assert unmet(done) == ("on(w, x)", LATER)
    assert done.bindings == {"w": "b", "y": "a"}
    assert done.state.cells == {}


def test_binds_of_a_called_behavior_can_be_chosen() -> None:
    text = NESTED.replace("bind w: T where: on(w, x)", "let w = x")
    world, state = world_of(text, "on[a, b] = True; on[a, c] = True")
    act = world.behaviors["act"]
    open_ = apply(world, state, act, ("a",)).problem
    assert isinstance(open_, Ambiguous)
    assert open_.choices == ("b", "c")
    done = apply(world, state, act, ("a",), {"y": "c"})
    assert done.problem is None
    assert calls(done) == ["put(a, c)", "go(a)"]
    assert [i.controller for i in done.trace if isinstance(i, DoItem)] == ["put", "go"]


def test_the_state_before_is_left_alone() -> None:
    world, state = world_of("behavior act(x: T):\n  eff:\n    p[x] = True\n")
    apply(world, state, world.behaviors["act"], ("a",))
    assert state == State()
