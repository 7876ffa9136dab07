"""`crow.plan`: typed results, limits, explanations, and what each construct means for plans."""

import pickle
import sys

import pytest
from programs import problem_of
from small_domains import COMMITTED
from support import BLOCKS

import crow
from cdlc.driver import problem_compilation
from crow.plan import call_text
from crow.planning import Planning
from crow.replay import replay_to_goal
from crow.search.engine import CrowEngine

SUSSMAN = 'problem "p"\nobjects:\n  A, B, C: block\ninit:\n  on_table[A] = True\n  on_table[B] = True\n  on[C, A] = True\n  clear[B] = True\n  clear[C] = True\n  handempty[...] = True\ngoal: {}\n'  # noqa: E501
ENGINES = ["auto", "iw", "reference"]

T = """
typedef T
feature p(x: T)
feature q(x: T)
feature r()
feature n() -> int64
feature at(x: T) -> T
controller c(x: T)
controller d()
"""


def problem(domain: str, goal: str, init: str = "pass", objects: str = "a, b") -> crow.Problem:
    text = f'problem "p"\nobjects:\n  {objects}: T\ninit:\n  {init}\ngoal: {goal}\n'
    return problem_of(T + domain, text)


def calls(result: crow.Result) -> list[str]:
    assert isinstance(result, crow.Plan), result
    return [call_text(s.controller, s.arguments, {}) if s.controller else "-" for s in result.steps]


def all_calls(task: crow.Problem, engine: str) -> set[tuple[str, ...]]:
    return {tuple(calls(plan)) for plan in crow.plans(task, engine)}


# ------------------------------------------------------------------------------- results and limits


@pytest.mark.parametrize("goal", ["on(A, B) and on(B, C)", "on(B, C) and on(A, B)"])
@pytest.mark.parametrize(
    ("program", "most"), [("blocks", 450), ("blocks_as_printed", 650), ("blocks_strips", 1_100)]
)
def test_the_sussman_anomaly_takes_few_nodes(program: str, most: int, goal: str) -> None:
    text = (BLOCKS / f"{program}.cdl").read_text()
    text = text.replace(
        "    holding[y] = True\n    clear[y] = True\n",
        "    holding[x] = True\n    clear[y] = True\n",
    )
    result = crow.plan(problem_of(text, SUSSMAN.format(goal)))
    assert len(calls(result)) == 6
    assert result.statistics["nodes"] <= most
    assert pickle.loads(pickle.dumps(result)) == result


def test_the_result_is_the_same_each_time() -> None:
    task = problem_compilation([str(BLOCKS / "sussman.cdl")]).problem
    first, second = crow.plan(task), crow.plan(task)
    assert (first.steps, first.trace) == (second.steps, second.trace)
    assert first.statistics["nodes"] == second.statistics["nodes"]


NEST = "".join(
    f"behavior b{i}():\n  goal: n() == {i}\n  body:\n    achieve n() == {i - 1}\n    do d()\n"
    f"  eff: n = {i}\n"
    for i in range(1, 8)
)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_plan_is_found_at_the_depth_that_it_needs(engine: str) -> None:
    task = problem(NEST, "n() == 7")
    assert calls(crow.plan(task, engine)) == ["d()"] * 7
    assert crow.plan(task, engine).statistics["depth"] == 7
    limited = crow.plan(task, engine, depth_limit=6)
    assert isinstance(limited, crow.LimitReached)
    assert limited.limits == ("depth",)
    assert isinstance(crow.plan(task, engine, depth_limit=7), crow.Plan)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_space_that_was_searched_through_is_unsolvable(engine: str) -> None:
    domain = NEST + "behavior go():\n  goal: r()\n  body:\n    achieve n() == 3\n    assert p(x)\n"
    task = problem(domain.replace("p(x)", "exists x: T: p(x)"), "r()")
    result = crow.plan(task, engine)
    assert isinstance(result, crow.Unsolvable)
    assert result.statistics["depth"] == 4


def test_deep_programs_meet_no_recursion_limit() -> None:
    depth = sys.getrecursionlimit() + 200
    domain = "behavior go(k: int64):\n  goal: n() >= k\n  body:\n    achieve n() >= k - 1\n"
    domain += "    do d()\n  eff: n = k\n"
    task = problem(domain, f"n() >= {depth}")
    (steps, trace), *_ = CrowEngine(task, lambda _: None).round(depth + 1)
    assert [step.controller for step in steps] == ["d"] * depth
    assert replay_to_goal(task, trace).is_sound


def test_node_and_time_limits() -> None:
    task = problem_compilation([str(BLOCKS / "towers12.cdl")]).problem
    nodes = crow.plan(task, node_limit=600)
    assert isinstance(nodes, crow.LimitReached)
    assert nodes.limits == ("nodes",)
    assert nodes.statistics["nodes"] >= 600
    assert nodes.explanation is not None
    assert "the node limit" in nodes.summary()
    assert isinstance(crow.plan(task, time_limit=0.02), crow.TimedOut)
    assert isinstance(crow.plan(task, memory_limit_mb=1), crow.OutOfMemory)


def test_progress_is_told_and_ends_the_search() -> None:
    class EnoughError(Exception):
        pass

    def tell(statistics: dict[str, object]) -> None:
        assert statistics["nodes"]
        raise EnoughError

    task = problem_compilation([str(BLOCKS / "towers12.cdl")]).problem
    with pytest.raises(EnoughError):
        crow.plan(task, on_progress=tell)


def test_no_plan_says_what_failed_and_where() -> None:
    domain = "behavior go(x: T):\n  goal: p(x)\n  body:\n    do c(x)\n    assert q(x)\n  eff:\n"
    result = crow.plan(problem(domain + "    p[x] = True\n", "p(a)"))
    assert isinstance(result, crow.Unsolvable)
    assert result.explanation is not None
    assert result.explanation.startswith("`q(x)` at domain.cdl:")
    assert result.explanation.endswith("with x = a: it is false here; there, q(a) is False")
    unmatched = crow.plan(problem(domain + "    p[x] = True\n", "r()"))
    assert unmatched.explanation is not None
    assert "no behavior achieves it" in unmatched.explanation


def test_an_unknown_engine_and_a_program_with_values_are_refused() -> None:
    with pytest.raises(ValueError, match="no engine `fast`"):
        crow.plan(problem(NEST, "r()"), "fast")
    values = (
        "behavior go():\n  goal: r()\n  body:\n    bind v: int64 where: v > 1\n  eff: r = True\n"
    )
    with pytest.raises(crow.NotPlannable, match="bind v") as raised:
        crow.plan(problem(values, "r()"), "reference")
    assert raised.value.location is not None
    external = "def f(x: T) -> bool\nbehavior go():\n  goal: r()\n  body:\n    assert f(home)\n"
    with pytest.raises(crow.NotPlannable, match="`f`"):
        crow.plan(problem("object_constant home: T\n" + external, "r()"))


def test_what_is_minimized_is_the_cost() -> None:
    task = problem_of(T + NEST, 'problem "p"\ngoal: n() == 2\nminimize: 10 * n()\n')
    result = crow.plan(task)
    assert (len(result.steps), result.cost) == (2, 20)


def test_planning_goes_on_after_a_plan() -> None:
    domain = "behavior go(x: T):\n  goal: r()\n  body:\n    do c(x)\n  eff:\n    r[...] = True\n"
    planning = Planning(problem(domain, "r()"))
    found = [calls(plan) for plan in planning.plans()]
    assert found == [["c(a)"], ["c(b)"]]
    assert isinstance(planning.end, crow.Unsolvable)


# -------------------------------------------------------------------------------------- constructs

SET = "behavior set_{f}(x: T):\n  goal: {f}(x)\n  body:\n    do c(x)\n  eff:\n    {f}[x] = True\n"
METHOD = SET.format(f="p") + "behavior m():\n  body:\n    {body}\n"


def method(*lines: str) -> str:
    body = "\n    ".join(lines)
    goal = "behavior m():\n  goal: r()\n  body:\n    {}\n    do d()\n  eff:\n    r[...] = True\n"
    return SET.format(f="p") + SET.format(f="q") + goal.format(body)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(
    ("body", "expected"),
    [
        (("achieve p(a)",), {("c(a)",)}),
        (("unordered:", "  achieve p(a)", "  achieve p(b)"), {("c(a)", "c(b)"), ("c(b)", "c(a)")}),
        (("foreach x: T: do c(x)",), {("c(a)", "c(b)"), ("c(b)", "c(a)")}),
        (
            ("unordered:", "  sequential:", "    do c(a)", "    do c(a)", "  do c(b)"),
            {("c(a)", "c(a)", "c(b)"), ("c(a)", "c(b)", "c(a)"), ("c(b)", "c(a)", "c(a)")},
        ),
        (("alternative:", "  do c(a)", "  do c(b)"), {("c(a)",), ("c(b)",)}),
        (("achieve p(a) or q(b)",), {("c(a)",), ("c(b)",)}),
        (("achieve exists x: T: p(x)",), {("c(a)",), ("c(b)",)}),
        (("achieve not (not p(a) or not q(b))",), {("c(a)", "c(b)"), ("c(b)", "c(a)")}),
        (("bind x: T where: at(x) == b", "do c(x)"), {("c(b)",)}),
        (("let x = at(a)", "do c(x)"), {("c(a)",)}),
        (("if at(b) == b:", "  do c(b)", "else:", "  do c(a)"), {("c(b)",)}),
        (("set_p(a)", "set_p(a)"), {("c(a)", "c(a)")}),
        (("achieve p(a)", "achieve p(a)"), {("c(a)",)}),
        (("assert not r()", "achieve_once p(b)"), {("c(b)",)}),
        (("achieve p(a) ^ q(a)",), set()),
        (("for i in range(3): do c(a)",), {("c(a)",) * 3}),
    ],
)
def test_statements(body: tuple[str, ...], expected: set[tuple[str, ...]], engine: str) -> None:
    domain = "object_constant a: T\nobject_constant b: T\n" + method(*body)
    text = 'problem "p"\ninit:\n  at[a] = a\n  at[b] = b\ngoal: r()\n'
    task = problem_of(T + domain, text)
    assert all_calls(task, engine) == {(*plan, "d()") for plan in expected}


@pytest.mark.parametrize("engine", ENGINES)
def test_members_of_m_interleave_and_what_they_need_is_held(engine: str) -> None:
    domain = """
behavior both():
  goal: r()
  body:
    promotable:
      achieve p(a)
      achieve q(b)
    do d()
  eff:
    r[...] = True
behavior make_p(x: T):
  goal: p(x)
  body:
    promotable:
      achieve n() == 1
    do c(x)
  eff:
    p[x] = True
    n = 0
behavior make_q(x: T):
  goal: q(x)
  body:
    promotable:
      achieve n() == 1
    do c(x)
  eff:
    q[x] = True
    n = 0
behavior count():
  goal: n() == 1
  body:
    do d()
  eff:
    n = 1
"""
    domain = "object_constant a: T\nobject_constant b: T\n" + domain
    task = problem_of(T + domain, 'problem "p"\ngoal: r()\n')
    plans = {plan for plan in all_calls(task, engine) if len(plan) == 5}
    # Counting twice before the first use would leave the second without: it is held.
    assert plans == {
        ("d()", "c(a)", "d()", "c(b)", "d()"),
        ("d()", "c(b)", "d()", "c(a)", "d()"),
    }


@pytest.mark.parametrize("engine", ENGINES)
def test_max_nested(engine: str) -> None:
    domain = """
behavior [[max_nested=1]] go(x: T):
  goal: p(x)
  body:
    bind y: T where: y != x
    achieve p(y)
    do c(x)
  eff:
    p[x] = True
"""
    assert isinstance(crow.plan(problem(domain, "p(a)"), engine), crow.Unsolvable)
    twice = domain.replace("max_nested=1", "max_nested=2")
    assert isinstance(crow.plan(problem(twice, "p(a)", "p[b] = True"), engine), crow.Plan)


@pytest.mark.parametrize("engine", ENGINES)
def test_bounds_make_a_transition_inapplicable(engine: str) -> None:
    domain = """
feature [[min=0, max=2]] level() -> int64
behavior fill():
  goal: r()
  body:
    do d()
  eff:
    level += 1
    r[...] = level() >= 2
"""
    domain += "behavior more(k: int64):\n  goal: level() == k\n  body:\n    do d()\n  eff:\n"
    domain += "    level += k\n"
    assert isinstance(crow.plan(problem(domain, "r()", "level = 2"), engine), crow.Unsolvable)
    assert calls(crow.plan(problem(domain, "r()", "level = 1"), engine)) == ["d()"]


@pytest.mark.parametrize("engine", ENGINES)
def test_a_comparison_no_goal_is_may_be_reached_in_steps(engine: str) -> None:
    domain = "behavior more():\n  body:\n    do d()\n  eff:\n    n += 1\n"
    result = crow.plan(problem(domain, "n() >= 3"), engine)
    assert calls(result) == ["d()"] * 3


@pytest.mark.parametrize("engine", ENGINES)
def test_commit_keeps_the_first_way_through_its_section(engine: str) -> None:
    committed = problem(COMMITTED, "r()", "q[b] = True")
    result = crow.plan(committed, engine)
    assert isinstance(result, crow.LimitReached)
    assert result.limits == ("commit",)
    free = problem(COMMITTED.replace("    commit\n", ""), "r()", "q[b] = True")
    assert calls(crow.plan(free, engine)) == ["c(b)", "d()"]


def test_commit_leaves_open_which_part_of_a_group_comes_last() -> None:
    domain = """
behavior m():
  goal: r()
  body:
    foreach x: T:
      do c(x)
      commit
    assert n() == 1
    do d()
  eff:
    r[...] = True
controller e(x: T):
  eff:
    if x == first():
      n = 1
    else:
      n = 0
feature first() -> T
"""
    domain = domain.replace("do c(x)", "do e(x)")
    for first in ("a", "b"):
        found = calls(crow.plan(problem(domain, "r()", f"first = {first}")))
        assert found[1] == f"e({first})"


@pytest.mark.parametrize("engine", ENGINES)
def test_an_l_that_acts_runs_before_all_of_m(engine: str) -> None:
    domain = """
behavior outer():
  goal: r()
  body:
    promotable sequential:
      achieve p(a)
      achieve q(b)
    do d()
  eff:
    r[...] = True
behavior inner(x: T):
  goal: q(x)
  body:
    do c(x)
    promotable:
      assert p(a)
    do c(x)
  eff:
    q[x] = True
"""
    domain = "object_constant a: T\nobject_constant b: T\n" + domain + SET.format(f="p")
    task = problem_of(T + domain, 'problem "p"\ngoal: r()\n')
    assert all_calls(task, engine) == {("c(b)", "c(a)", "c(b)", "d()")}
