"""Methods: one action a `do` of a controller with an effect, and back."""

import json
from pathlib import Path
from textwrap import dedent

import pytest
from programs import emitted, task_of
from support import cdlc

from cdlc.backends.engines import installed
from cdlc.backends.pddl import PddlTask, to_step
from cdlc.backends.pddl.solve import run

PDDL = ("--engine", "fast-downward")
needs_planner = pytest.mark.skipif("fast-downward" not in installed(), reason="needs `planners`")

HEAD = """
typedef place
typedef item
feature at() -> place
feature loc(x: item) -> place
feature held(x: item)
feature busy()
controller goto(p: place):
  eff: at[...] = p
controller grasp(x: item):
  eff: held[x] = True
controller beep()
"""
FETCH = """
behavior fetch(x: item):
  goal: held(x)
  body:
    bind p: place where: loc(x) == p
    assert not busy()
    do goto(p)
    assert at() == loc(x)
    do grasp(x)
"""
PROBLEM = """
problem "p"
domain "domain.cdl"
objects:
  here, there: place
  a, b: item
init:
  at = here
  loc[a] = there
  loc[b] = there
goal: held(a) and held(b)
"""


def preconditions(behavior: str, head: str = HEAD) -> dict[str, list[str]]:
    """The preconditions of each action, but for the old value of what it writes."""
    domain = task_of(head + dedent(behavior)).domain
    found: dict[str, list[str]] = {}
    for action in domain.split("(:action ")[1:]:
        text = action.split(":precondition ")[1].split(":effect")[0].strip()
        lines = text.removeprefix("(and").removesuffix(")").splitlines()
        found[action.split()[0]] = [x.strip() for x in lines if x.strip() and "?old" not in x]
    return found


GRASP = ["(loc ?x ?at)", "(at ?at)"]


def test_a_step_demands_what_is_asserted_since_the_last_change() -> None:
    assert preconditions(FETCH) == {"goto": ["(loc ?x ?p)", "(not (busy))"], "grasp": GRASP}


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("assert busy()\nachieve held(x)\ndo goto(home)", []),
        ("if busy(): do goto(home)", ["(busy)"]),
        ("if busy(): pass\nelse: do goto(home)", ["(not (busy))"]),
        ("if busy(): assert held(x)\ndo goto(home)", ["(or (not (busy)) (held ?x))"]),
        ("foreach y: item: assert held(y)\ndo goto(home)", ["(forall (?i - item) (held ?i))"]),
        ("assert busy()\nfor i in range(2): do goto(home)", ["(busy)"]),
        ("let b = busy()\nassert b\ndo goto(home)", ["(busy)"]),
        ("unordered:\n  assert busy()\n  assert held(x)\ndo goto(home)", ["(busy)", "(held ?x)"]),
        ("unordered:\n  assert busy()\n  do goto(home)", []),
    ],
)
def test_conditions_of_steps(body: str, expected: list[str]) -> None:
    head = HEAD + "object_constant home: place\n"
    lines = "".join(f"    {line}\n" for line in body.splitlines())
    found = preconditions(f"behavior act(x: item):\n  body:\n{lines}", head)
    assert found["goto"] == expected


def test_the_same_step_of_two_methods_is_one_action() -> None:
    task = task_of(HEAD + "behavior one(x: item):\n  body: do grasp(x)\n"
                   "behavior two(y: item):\n  body: do grasp(y)\n")  # fmt: skip
    (action,) = task.actions
    assert [source.behavior for source in action.sources] == ["one", "two"]


def test_further_actions_of_a_name_are_numbered() -> None:
    asserts = ("True", "busy()", "not busy()")
    body = "".join(f"    assert {a}\n    do grasp(x)\n" for a in asserts)
    task = task_of(HEAD + "behavior one(x: item):\n  body:\n" + body)
    assert [action.name for action in task.actions] == ["grasp", "one", "one-2"]


def test_a_value_from_before_a_change_is_refused() -> None:
    behavior = (
        "behavior act(x: item):\n  body:\n    let p = at()\n    do grasp(x)\n    do goto(p)\n"
    )
    task, found, _ = emitted(HEAD + behavior)
    assert task is None
    (diagnostic,) = found
    assert "`p`, whose value is not known at this step of `act`," in diagnostic.message()


def test_a_method_that_only_achieves_is_no_action() -> None:
    assert task_of(HEAD + "behavior act(x: item):\n  body: achieve held(x)\n").actions == ()


def files(folder: Path, domain: str) -> Path:
    (folder / "domain.cdl").write_text(dedent(domain))
    (folder / "problem.cdl").write_text(dedent(PROBLEM))
    return folder / "problem.cdl"


@needs_planner
@pytest.mark.parametrize("form", ["text", "json"])
def test_plans_of_steps_lead_back_and_validate(form: str, tmp_path: Path) -> None:
    problem, plan = files(tmp_path, HEAD + FETCH), tmp_path / "plan"
    ran = cdlc("plan", problem, *PDDL, "--format", form, "-o", plan)
    assert ran.status == 0, ran.err
    if form == "text":
        assert plan.read_text().startswith("1. goto(there)  by fetch(a, p=there)\n")
    else:
        steps = json.loads(plan.read_text())["steps"]
        assert [step["controller"] for step in steps] == ["goto", "grasp", "grasp"]
    validated = cdlc("validate", problem, plan)
    assert validated.status == 0, validated.err


def test_a_pddl_plan_of_steps_validates(tmp_path: Path) -> None:
    problem, plan = files(tmp_path, HEAD + FETCH), tmp_path / "plan"
    plan.write_text("(goto there a here)\n(grasp a there)\n(grasp b there)\n")
    validated = cdlc("validate", problem, plan)
    assert validated.status == 0, validated.err
    plan.write_text("(grasp a there)\n")
    assert "at() == loc(x)" in cdlc("validate", problem, plan).err


def test_steps_are_applied_and_replayed() -> None:
    task, _, problem = emitted(HEAD + FETCH, PROBLEM)
    assert isinstance(task, PddlTask)
    assert problem is not None
    calls = [("goto", ("there", "a", "here")), ("grasp", ("a", "there")), ("grasp", ("b", "there"))]
    planned = [to_step(task, problem.world, *call, line) for line, call in enumerate(calls, 1)]
    steps, _ = run(problem, planned)
    assert [(s.behavior, s.behavior_arguments, s.controller) for s in steps] == [
        ("fetch", ("a",), "goto"), ("fetch", ("a",), "grasp"), ("fetch", ("b",), "grasp"),
    ]  # fmt: skip


SILENT = HEAD + FETCH + "behavior warn(x: item):\n  goal: busy()\n  body: do beep()\n"


def test_what_no_effect_describes_is_a_warning_and_no_plan(tmp_path: Path) -> None:
    problem = files(tmp_path, SILENT)
    ran = cdlc("compile", problem, "--emit", "pddl")
    assert (ran.status, "warning[unmodelled-controller]" in ran.err) == (0, True)
    assert "beep" not in ran.out
    strict = cdlc("compile", problem, "--emit", "pddl", "--strict")
    assert (strict.status, strict.out) == (1, "")
    planned = cdlc("plan", problem, *PDDL)
    assert planned.status == 1
    assert "error[not-in-pddl]: `beep`, which `warn` runs" in planned.err


def test_verbose_names_the_methods_that_are_no_action(tmp_path: Path) -> None:
    ready = "behavior ready(x: item):\n  goal: busy()\n  body:\n    achieve held(x)\n"
    domain = tmp_path / "domain.cdl"
    domain.write_text(HEAD.replace("controller beep()\n", "") + dedent(FETCH) + ready)
    quiet = cdlc("compile", domain, "--emit", "pddl")
    told = cdlc("compile", domain, "--emit", "pddl", "--verbose")
    assert told.out == quiet.out
    assert "note:" not in quiet.err
    assert [line for line in told.err.splitlines() if line.startswith("note:")] == [
        "note: `ready` is a method, which planners need not see"
    ]
