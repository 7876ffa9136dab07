"""What is refused with code and place, names, and plans of planners read back."""

from textwrap import dedent

import pytest
from programs import emitted, task_of

from benchmarks.translator import task_size
from cdlc.backends.engines import installed
from cdlc.backends.pddl import PddlTask, read_plan, to_step
from cdlc.backends.pddl.names import Names, legal_name, variable_name
from cdlc.backends.pddl.plans import PlanFormatError
from cdlc.backends.pddl.solve import InvalidPlan, run, solve_task
from cdlc.diagnostics import Collector
from crow.problem import World

needs_planner = pytest.mark.skipif("fast-downward" not in installed(), reason="needs `planners`")

HEAD = f"""
typedef T
object_constant {", ".join(f"c{i}" for i in range(20))}: T
typedef U: T
typedef none
typedef pose: vector[float32, 2]
feature p(x: T)
feature q(x: T)
controller go(x: T)
controller move(x: T, to: pose)
controller count(x: T, n: int64)
def external(x: T)
"""


def try_to_emit(
    domain: str, goal: str = "True", more: str = "", objects: str = "a, b: T"
) -> tuple[PddlTask | None, Collector, World]:
    lines = "".join(f"  {line.strip()}\n" for line in objects.split(";"))
    text = f'problem "p"\nobjects:\n{lines}goal: {goal}\n{more}'
    task, found, problem = emitted(HEAD + dedent(domain), text)
    assert problem is not None
    return task, found, problem.world


def emit(domain: str, goal: str = "True", objects: str = "a, b: T") -> tuple[PddlTask, World]:
    task, found, world = try_to_emit(domain, goal, objects=objects)
    assert task is not None, [d.message() for d in found]
    return task, world


# ---------------------------------------------------------------------------------------- refused

ACT = "behavior act(x: T):\n  body:\n    {}\n  eff: q[x] = True\n"


@pytest.mark.parametrize(
    ("domain", "message", "line"),
    [
        (ACT.format("assert external(x)"), "the external function `external`", 3),
        (
            "behavior act(x: T, n: int64):\n  body: do count(x, n)\n  eff: q[x] = True",
            "parameter `n` of `act`, of type `int64`,",
            1,
        ),
        (
            "behavior act(x: T, to: pose):\n  body: do move(x, to)\n  eff: q[x] = True",
            "parameter `to` of `act`, of type `pose`,",
            1,
        ),
        (
            "behavior act(x: T, n: int64):\n  eff: q[x] = True",
            "parameter `n` of `act`, of type `int64`,",
            1,
        ),
        (
            ACT.format("assert " + " ^ ".join(f"p(c{i})" for i in range(20))),
            "a condition that is too large when written out",
            3,
        ),
    ],
)
def test_what_has_no_pddl_is_refused_with_its_place(domain: str, message: str, line: int) -> None:
    task, found, _ = try_to_emit(domain)
    assert task is None
    (diagnostic,) = found
    assert diagnostic.code == "not-in-pddl"
    assert diagnostic.message() == f"{message} has no PDDL"
    assert diagnostic.location.file == "domain.cdl"
    assert diagnostic.location.line == len(HEAD.splitlines()) + line


@pytest.mark.parametrize(
    ("goal", "more", "message"),
    [
        ("external(a)", "", "the external function `external`"),
        ("p(a)", "minimize: 1 if p(b) else 0\n", "`1 if p(b) else 0`"),
    ],
)
def test_problems_are_refused_too(goal: str, more: str, message: str) -> None:
    task, found, _ = try_to_emit("", goal, more)
    assert task is None
    (diagnostic,) = found
    assert diagnostic.message() == f"{message} has no PDDL"
    assert diagnostic.location.file == "problem.cdl"


def test_everything_unfit_is_reported_at_once() -> None:
    _, found, _ = try_to_emit("feature n() -> string\nfeature m() -> pose\n")
    assert len(found.found) == 2


def test_an_action_that_can_never_be_applied_is_left_out() -> None:
    task, _ = emit(ACT.format("assert p(x) and not p(x)") + ACT.replace("act", "ok").format("pass"))
    assert [a.name for a in task.actions] == ["ok"]


@needs_planner
@pytest.mark.parametrize(("goal", "status"), [("False", "unsolvable"), ("True", "plan")])
def test_constant_goals(goal: str, status: str) -> None:
    text = f'problem "p"\nobjects:\n  a: T\ngoal: {goal}\n'
    task, _, problem = emitted(HEAD + ACT.format("do go(x)"), text)
    assert task is not None
    assert problem is not None
    assert task.problem is not None
    assert task_size(task.domain, task.problem) is not None
    assert solve_task(task, problem, "fast-downward", time_limit=60).status == status


@needs_planner
def test_a_task_without_objects_is_read() -> None:
    domain = "feature p()\nbehavior b():\n  eff: p = True\n"
    task = task_of(domain, 'problem "p"\ngoal: p\n')
    assert task.problem is not None
    assert task_size(task.domain, task.problem).operators == 1


def test_comments_stay_on_their_line() -> None:
    task = task_of('domain "one\\n(two"\nfeature p()\n')
    assert task.domain.startswith('; Emitted by cdlc from the CDL domain "one (two".\n(define')
    assert task.problem is None


def test_the_domain_alone_is_the_domain_of_a_problem() -> None:
    alone = task_of(HEAD + ACT.format("do go(x)"))
    task, _ = emit(ACT.format("do go(x)"), "p(a)", objects="a, Act, GO: T")
    assert alone.domain == task.domain
    assert "; Names" in str(task.problem)


# ------------------------------------------------------------------------------------------ names


def test_names_are_kept_apart_and_lead_back() -> None:
    names = Names()
    assert names.add("feature", "on") == "on"
    assert names.add("object", "On") == "On-2"
    assert names.add("object", "ON") == "ON-3"
    assert names.add("feature", "on") == "on"
    assert names.origin("object", "on-2") == "On"
    assert names.origin("feature", "ON") == "on"
    assert names.origin("object", "on") is None
    assert names.origin("object", "ghost") is None
    assert names.get("object", "ON") == "ON-3"
    assert (names.has("object"), names.has("type")) == (True, False)
    assert (names.has("object", "On"), names.has("object", "on")) == (True, False)
    assert names.changed() == [("On", "On-2"), ("ON", "ON-3")]


@pytest.mark.parametrize(
    ("name", "legal"),
    [
        ("a_b", "a_b"),
        ("_a", "n_a"),
        ("2x", "n2x"),
        ("ä b", "b"),
        ("", "n"),
        ("--", "n"),
        ("_", "n_"),
    ],
)
def test_legal_names(name: str, legal: str) -> None:
    assert legal_name(name) == legal


def test_variables_differ_in_more_than_case() -> None:
    assert variable_name("X", ["x"]) == "X-2"
    assert variable_name("_x", []) == "n_x"
    assert variable_name("and", []) == "and"


# ------------------------------------------------------------------------------------------ plans

RULES = """
feature on(x: T, y: T)
object_constant home: U
behavior act(x: T, unused: U):
  body:
    bind y: T where: on(x, y)
    bind y: U where: p(y)
    do go(x)
  eff: q[x] = True
behavior also(z: T):
  body:
    bind w: T where: on(z, w)
    bind v: U where: p(v)
    do go(z)
  eff: q[z] = True
behavior strange(x: T, n: none):
  eff: p[x] = True
"""


def test_a_plan_is_read_line_by_line() -> None:
    text = "; a comment\n(stack a b)\n\n 3 : (unstack b c) ; more\n0.001: (go)  [1.0]\n( x  y )\n"
    assert read_plan(text) == [
        (2, "stack", ("a", "b")),
        (4, "unstack", ("b", "c")),
        (5, "go", ()),
        (6, "x", ("y",)),
    ]
    assert read_plan("") == []


@pytest.mark.parametrize("line", ["stack a b", "(stack a b", "(a) (b)", "((a))", "()", "{}"])
def test_what_is_no_step_is_refused_with_its_line(line: str) -> None:
    with pytest.raises(PlanFormatError, match="not a step of a PDDL plan") as raised:
        read_plan(f"(fine)\n\x0b\n{line}\n")
    assert raised.value.line == 3


def test_a_step_leads_back_to_the_first_of_its_behaviors() -> None:
    task, world = emit(RULES, "q(a)", "a, b: T; u: U")
    (action, _) = task.actions
    assert [p.name for p in action.parameters] == ["x", "y", "y_2"]
    step = to_step(task, world, "GO", ("A", "b", "Home"), 1)
    assert (step.behavior.name, step.arguments) == ("act", ("a", "home"))
    assert (step.bindings, step.also) == ({"y": "b", "y_2": "home"}, ("also",))


@pytest.mark.parametrize(
    ("action", "arguments", "message"),
    [
        ("jump", (), "no action `jump`"),
        ("go", ("a",), "`go` takes 3 arguments, not 1"),
        ("go", ("a", "b", "ghost"), "no object `ghost`"),
        ("go", ("a", "b", "p"), "no object `p`"),
        ("go", ("a", "b", "a"), "`a` is a `T`, not a `U`"),
        ("strange", ("a",), "`strange` needs an object of type `none`"),
    ],
)
def test_steps_that_are_none(action: str, arguments: tuple[str, ...], message: str) -> None:
    task, world = emit(RULES, "q(a)", "a, b: T; u: U")
    with pytest.raises(PlanFormatError) as raised:
        to_step(task, world, action, arguments, 7)
    assert message in str(raised.value)
    assert raised.value.line == 7


def test_a_plan_is_applied_and_replayed() -> None:
    text = 'problem "p"\nobjects:\n  a, b: T\ninit: on[a, b] = True; p[home] = True\ngoal: q(a)\n'
    task, _, problem = emitted(HEAD + RULES, text)
    assert task is not None
    assert problem is not None
    step = to_step(task, problem.world, "go", ("a", "b", "home"), 1)
    steps, trace = run(problem, [step])
    assert [(s.controller, s.arguments, s.bindings) for s in steps] == [
        ("go", ("a",), {"y": "b", "y_2": "home"})
    ]
    assert len(trace) == 4
    with pytest.raises(InvalidPlan, match="step 1: "):
        run(problem, [to_step(task, problem.world, "go", ("b", "b", "home"), 1)])
    with pytest.raises(InvalidPlan, match=r"`q\(a\)`: it is false here"):
        run(problem, [])
