"""Refinement trees: of plans, of branches that failed, and of what failed how often."""

import pytest
from programs import problem_of
from refinements import check_tree
from support import EXAMPLES

from cdlc.driver import problem_compilation
from crow.planning import Planning
from crow.problem import Problem
from crow.refinement import Kind, Refinement
from crow.results import Plan


def example(name: str) -> Problem:
    return problem_compilation([str(EXAMPLES / f"{name}.cdl")]).plannable


def shown(tree: Refinement) -> str:
    """A tree, a line a node that is no assertion."""
    return "\n".join(
        f"{'  ' * node.level}{node.kind} {node.text}" + (f" by {node.by}" if node.by else "")
        for node in tree.nodes
        if node.kind not in (Kind.ASSERT, Kind.HELD, Kind.EFFECT)
    )


EXAMPLE_PROBLEMS = [
    "blocks/sussman", "blocks/towers12", "kitchen/tidy", "logistics/parcel", "gripper/four",
    "cupboard/dishes", "jugs/four", "tutorial/swap",
]  # fmt: skip


@pytest.mark.parametrize("engine", ["auto", "best"])
@pytest.mark.parametrize("name", EXAMPLE_PROBLEMS)
def test_examples(name: str, engine: str) -> None:
    problem = example(name)
    planning = Planning(problem, engine, node_limit=60_000)
    plan = planning.first()
    assert isinstance(plan, Plan)
    check_tree(problem, plan, planning.refinement())


def test_sussman() -> None:
    planning = Planning(example("blocks/sussman"), "iddfs")
    planning.first()
    assert (
        shown(planning.refinement())
        == """\
goal on(A, B) and on(B, C)
  achieve on(B, C) by r_on(B, C)
    achieve clear(C)
    achieve holding(B) by r_holding_from_table(B)
      achieve on_table(B)
      achieve clear(B)
      achieve handempty() by r_handempty(x=C)
        bind x = C where holding(C)
        do place_table(C)
      do pickup_table(B)
    do stack(B, C)
  achieve on(A, B) by r_on(A, B)
    achieve clear(B)
    achieve holding(A) by r_holding_from_table(A)
      achieve on_table(A)
      achieve clear(A) by r_clear(A, y=C)
        bind y = C where on(C, A)
        achieve on(C, A)
        achieve clear(C)
        achieve handempty()
        do unstack(C, A)
      achieve handempty()
      do pickup_table(A)
    do stack(A, B)"""
    )


CALLS = """
typedef T
feature p(x: T)
feature q(x: T)
controller c(x: T)

behavior first(x: T):
  body:
    do c(x)
  eff:
    q[x] = True

behavior both(x: T):
  goal: p(x)
  body:
    first(x)
    first(x)
    assert q(x)
  eff:
    p[x] = True
"""
OBJECTS = 'problem "p"\nobjects:\n  a, b: T\ninit:\n  pass\n'


def test_calls_of_equal_behaviors_stay_apart() -> None:
    problem = problem_of(CALLS, OBJECTS + "goal: p(a)\n")
    planning = Planning(problem)
    plan = planning.first()
    assert isinstance(plan, Plan)
    tree = planning.refinement()
    check_tree(problem, plan, tree)
    assert (
        shown(tree)
        == """\
goal p(a)
  achieve p(a) by both(a)
    call first(a) by first(a)
      do c(a)
    call first(a) by first(a)
      do c(a)"""
    )


FAILING = CALLS.replace("    assert q(x)\n", "    assert not q(x)\n")


@pytest.mark.parametrize("engine", ["auto", "best", "iddfs"])
def test_without_a_plan_the_farthest_branch_and_what_failed(engine: str) -> None:
    planning = Planning(problem_of(FAILING, OBJECTS + "goal: p(a) and p(b)\n"), engine)
    assert planning.first().status == "unsolvable"
    tree = planning.refinement()
    failed = [node for node in tree.nodes if node.kind is Kind.FAILED]
    assert [node.text for node in failed] == ["not q(a): it is false here"]
    assert tree.nodes[failed[0].above].by == "both(a)"
    assert not tree.nodes[failed[0].above].is_done
    assert not tree.nodes[0].is_done
    assert sum(node.kind is Kind.DO for node in tree.nodes) == 2
    failure = tree.failures[0]
    assert (failure.text, failure.behavior, failure.steps) == ("not q(x)", "both", 2)
    assert failure.count >= 1
    assert failure.facts == ("q(a) is True",)
    assert failure.location is not None
    assert tree.json()["failures"][0]["condition"] == "not q(x)"


def test_failures_are_bounded_by_the_program() -> None:
    problem = example("blocks/towers12")
    kinds = []
    for limit in (2_000, 10_000):
        planning = Planning(problem, "iddfs", node_limit=limit)
        planning.first()
        failures = planning.refinement().failures
        kinds.append(len(failures))
        assert sum(failure.count for failure in failures) > limit / 20
    assert kinds[1] < 40


def test_before_anything_failed_there_is_the_goal() -> None:
    planning = Planning(example("blocks/sussman"), node_limit=1)
    assert planning.first().status == "limit"
    tree = planning.refinement()
    assert [failure.reason for failure in tree.failures] == ["it has not become true so far"]
    assert [node.kind for node in tree.nodes] == [Kind.GOAL, Kind.FAILED]


BOUNDED = """
typedef tank
feature [[max=2]] level(t: tank) -> int64
feature full(t: tank)
controller pour(t: tank)
behavior fill(t: tank):
  goal: full(t)
  body:
    do pour(t)
  eff:
    level[t] = level(t) + 3
    full[t] = True
"""


@pytest.mark.parametrize("engine", ["auto", "best", "iddfs", "iw"])
def test_an_effect_that_leaves_its_bounds_is_told(engine: str) -> None:
    text = 'problem "p"\nobjects:\n  a, b: tank\ninit: pass\ngoal: full(b)\n'
    planning = Planning(problem_of(BOUNDED, text), engine)
    result = planning.first()
    assert result.status == "unsolvable"
    assert result.explanation is not None
    assert "with t = b: `level(b)` would be 3, and may be at most 2" in result.explanation
    (failure,) = planning.refinement().failures
    assert failure.reason == "`level(b)` would be 3, and may be at most 2"
    assert failure.behavior == "fill"
