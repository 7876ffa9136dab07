"""`crow.Policy`: the next call from an observed state, and what it costs to keep a plan."""

import pytest
from programs import problem_of
from small_worlds import blocks, table

import crow
from crow import policy as policies
from crow.problem import Cell, Problem


def test_each_step_is_the_next_call() -> None:
    policy, world, called = crow.Policy(blocks()), table(), []
    while isinstance(decision := policy.step(world.observe()), crow.ControllerCall):
        called.append(str(decision))
        world.act(decision.controller, decision.arguments)
    assert decision == crow.Done()
    assert called[:2] == ["unstack(C, A)", "place_table(C)"]
    assert len(called) == 6


def test_without_a_plan_it_says_so() -> None:
    decision = crow.Policy(blocks(), node_limit=300).step(crow.State())
    assert isinstance(decision, crow.Stuck)
    assert isinstance(decision.result, crow.LimitReached)


def test_after_a_failure_there_is_another_plan() -> None:
    policy, world = crow.Policy(blocks()), table()
    first = policy.step(world.observe())
    plan = policy.plan
    policy.failed()
    assert policy.step(world.observe()) == first
    assert policy.plan is not plan


def test_a_state_of_another_program_is_an_error() -> None:
    with pytest.raises(ValueError, match="which is no feature"):
        crow.Policy(blocks()).step({("near", ("A",)): True})


# ------------------------------------------------------------------------------- effects and traces

COUNTING = """
feature n() -> int64
feature told()
controller up()
controller twice()
behavior r_n(k: int64):
  goal: n() == k
  body:
    do up()
    do up()
    achieve told()
    do twice()
  eff:
    n += 4
behavior r_told():
  goal: told()
  body:
    pass
  eff:
    told[...] = True
"""


def test_an_effect_that_has_happened_does_not_happen_again() -> None:
    """`n += 4` would not lead to 4 if it were replayed from what is observed after it."""
    problem = problem_of(COUNTING, 'problem "p"\ngoal: n() == 4\n')
    policy, n, called = crow.Policy(problem), 0, []
    while isinstance(decision := policy.step({("n", ()): n}), crow.ControllerCall):
        called.append(decision.controller)
        if decision.controller == "twice":
            n = 4
    assert called == ["up", "up", "twice"]
    assert isinstance(decision, crow.Done)


def test_what_no_controller_brings_about_is_kept_until_the_next_call() -> None:
    problem = problem_of(COUNTING, 'problem "p"\ngoal: told()\n')
    assert crow.Policy(problem).step(crow.State()) == crow.Done()


MOVING = """
typedef [[tolerance=0.1]] Metres: float64
typedef thing
feature place(x: thing) -> Metres
feature exact(x: thing) -> float64
controller push(x: thing)
behavior r_place(x: thing, p: Metres):
  goal: place(x) == p
  body:
    assert place(x) == 0.0 and exact(x) == 0.0
    do push(x)
  eff:
    place[x] = p
behavior r_both(x: thing, y: thing):
  goal: exact(y) == 1.0
  body:
    achieve place(x) == 1.0
    assert x != y
    do push(y)
  eff:
    exact[y] = 1.0
"""


def moving(goal: str) -> Problem:
    return problem_of(MOVING, f'problem "p"\nobjects:\n  a, b: thing\ngoal: {goal}\n')


@pytest.mark.parametrize(
    ("seen", "is_kept"), [(1.0, True), (1.05, True), (0.9, True), (1.2, False), (0.0, False)]
)
def test_what_is_within_the_tolerance_is_as_projected(seen: float, is_kept: bool) -> None:
    policy = crow.Policy(moving("place(a) == 1.0"))
    assert policy.step({}) == crow.ControllerCall("push", ("a",))
    again = policy.step({("place", ("a",)): seen})
    assert isinstance(again, crow.Done) == is_kept
    # From 0 it can be pushed again, from elsewhere not.
    assert isinstance(again, crow.ControllerCall) == (seen == 0.0)


def test_without_a_tolerance_values_are_exact() -> None:
    policy = crow.Policy(moving("exact(b) == 1.0"))
    calls = [policy.step({}), policy.step({("place", ("a",)): 1.0})]
    assert [str(c) for c in calls] == ["push(a)", "push(b)"]
    almost: dict[Cell, object] = {("place", ("a",)): 1.0, ("exact", ("b",)): 1.0 + 1e-9}
    assert policy.step(almost) != crow.Done()


# -------------------------------------------------------------------------------------------- costs

IMPERATIVE = """
typedef T
feature p(x: T)
feature done()
controller c(x: T)
behavior all():
  goal: done()
  body:
    foreach x: T:
      achieve p(x)
  eff:
    done[...] = True
behavior one(x: T):
  goal: p(x)
  body:
    do c(x)
  eff:
    p[x] = True
"""


def effort(size: int, monkeypatch: pytest.MonkeyPatch) -> tuple[int, int, int]:
    """Calls, nodes of planning, and traces that were replayed again along the way."""
    names = ", ".join(f"o{i}" for i in range(size))
    problem = problem_of(IMPERATIVE, f'problem "p"\nobjects:\n  {names}: T\ngoal: done()\n')
    replays = 0
    original = policies.replay_to_goal

    def counted(*arguments: object) -> object:
        nonlocal replays
        replays += 1
        return original(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(policies, "replay_to_goal", counted)
    policy, seen, calls = crow.Policy(problem, engine="iddfs"), dict[Cell, object](), 0
    nodes = 0
    while isinstance(decision := policy.step(seen), crow.ControllerCall):
        seen["p", decision.arguments] = True
        calls += 1
        assert policy.plan is not None
        nodes = policy.plan.statistics["nodes"]
        if calls == size:
            seen["done", ()] = True
    assert isinstance(decision, crow.Done)
    return calls, nodes, replays


def test_an_imperative_program_costs_time_linear_in_its_plan(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    small, large = effort(50, monkeypatch), effort(200, monkeypatch)
    assert (small[0], large[0]) == (50, 200)
    assert large[1] <= 4.2 * small[1]
    assert (small[2], large[2]) == (0, 0)
