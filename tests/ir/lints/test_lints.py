"""Warnings about programs that check: each with what it says and where it keeps quiet."""

from pathlib import Path

import pytest
from cases import codes, diagnose

import cdlc

HEAD = """\
typedef block
typedef Pose: vector[float32, 2]

feature clear(x: block)
feature on(x: block, y: block)
feature count() -> int64
feature position(x: block) -> Pose

controller move(x: block)
controller mark()
"""
CLEAR = """
behavior r_clear(x: block):
  goal: clear(x)
  body:
    bind y: block where: on(y, x)
    do move(y)
  eff:
    on[y, x] = False
    clear[x] = True
"""
OTHER = """
behavior r_on(x: block, y: block):
  goal: on(x, y)
  body:
    achieve clear(y)
    do move(x)
  eff:
    on[x, y] = True
    clear[y] = False
"""
USES = """
behavior uses(x: block, p: Pose):
  goal: position(x) == p
  body:
    do mark()
  eff:
    position[x] = p
    count += 1
"""


def lints(text: str, head: str = HEAD + CLEAR + OTHER + USES) -> list[str]:
    return codes(text, head)


def test_the_shared_program_is_clean() -> None:
    assert lints("") == []


# ------------------------------------------------------------------------------------------ goals

FUNCTIONS = """
feature agent() -> Pose
def external(x: block) -> bool
def at(p: Pose) -> bool:
  return agent == p
def free(x: block) -> bool:
  return clear(x) and not on(x, x)
"""
ESTABLISHED = [
    ("clear(x)", "clear[x] = True"),
    ("not clear(x)", "clear[x] = False"),
    ("on(x, y)", "on[x, y] = True\non[y, x] = on(x, y)"),
    ("position(x) == p", "position[x] = p"),
    ("p == position(x)", "position[x] = p"),
    ("at(p)", "agent = p"),
    ("free(x)", "clear[x] = True\non[x, x] = False"),
    ("external(x)", "clear[x] = True"),
    ("count >= 3", "count = 5"),
    ("count == 3", "count = 3"),
    ("clear(x) == True", "clear[x] = True"),
    # cannot be decided by folding, so nothing is said
    ("count >= 3", "count += 3"),
    ("clear(x)", "if on(x, y):\n  clear[x] = True"),
    ("clear(x)", "foreach z: block:\n  clear[z] = True"),
    ("clear(x)", "clear[x] = external(x)"),
    ("clear(x)", "clear[x] = on(x, y) or clear(y)"),
    ("position(x) == p", "position[x] = p + [0, 0]"),
    ("position(x) == p", "position[x] = position(y)"),
]
NOT_ESTABLISHED = [
    ("clear(x)", "clear[y] = True"),
    ("clear(x)", "clear[x] = False"),
    ("not clear(x)", "clear[x] = True"),
    ("clear(x)", "on[x, y] = True"),
    ("on(x, y)", "on[y, x] = True"),
    ("clear(x)", "clear[x] = True\nclear[x] = False"),
    ("count == 3", "count = 4"),
    ("position(x) == p", "position[y] = p"),
    ("position(x) == p", "clear[x] = True"),
    ("free(x)", "clear[x] = False"),
]


def with_goal(goal: str, effect: str, body: str = "") -> list[str]:
    lines = "".join(f"    {line}\n" for line in effect.splitlines())
    header = "behavior r(x: block, y: block, p: Pose):\n"
    mentions = "    let _all = [x, y]\n    let _p = p\n"
    text = f"{FUNCTIONS}{header}  goal: {goal}\n  body:\n{mentions}{body}  eff:\n{lines}"
    return [code for code in codes(text, HEAD) if code != "unused-definition"]


@pytest.mark.parametrize(("goal", "effect"), ESTABLISHED)
def test_no_alarm_where_the_goal_may_be_established(goal: str, effect: str) -> None:
    assert with_goal(goal, effect) == []


@pytest.mark.parametrize(("goal", "effect"), NOT_ESTABLISHED)
def test_goals_not_established(goal: str, effect: str) -> None:
    assert with_goal(goal, effect) == ["goal-not-established"]


def test_what_is_already_required_counts() -> None:
    assert with_goal("clear(x)", "on[x, y] = True", "    assert clear(x)\n") == []
    assert with_goal("clear(x)", "clear[y] = True", "    assert x == y\n") == []
    assert with_goal("clear(x)", "clear[y] = True", "    assert x != y\n") == [
        "goal-not-established"
    ]


# ------------------------------------------------------------------------------------------ reach

UNMATCHED = [
    ("achieve clear(x)", []),
    ("achieve not clear(x)", ["unmatched-achieve"]),
    ("achieve on(x, x) and clear(x)", []),
    ("achieve forall y: block: on(x, y) or clear(y)", []),
    ("achieve exists y: block: on(x, y) and still(y)", []),
    ("achieve still(x)", ["unmatched-achieve"]),
    ("achieve clear(x) and still(x)", ["unmatched-achieve"]),
    ("achieve still(x) or clear(x)", []),
    ("achieve still(x) or odd(x)", ["unmatched-achieve"]),
    ("achieve forall y: block: still(y)", ["unmatched-achieve"]),
    ("achieve not (still(x) and clear(x))", ["unmatched-achieve"]),
    ("achieve not not clear(x)", []),
    ("achieve_once still(x)", []),
    ("achieve position(x) == [1, 2]", []),
    ("achieve [1, 2] == position(x)", []),
    ("achieve count > 3", []),
    ("achieve weight(x) > 3", ["unmatched-achieve"]),
    ("achieve derived(x)", []),
    ("achieve not derived(x)", ["unmatched-achieve"]),
    ("achieve odd(x)", ["unmatched-achieve"]),
    ("foreach y: block:\n      achieve still(y)", ["unmatched-achieve"]),
    ("if clear(x):\n      achieve still(x)", ["unmatched-achieve"]),
]
STILL = """
feature still(x: block)
feature weight(x: block) -> int64
def odd(x: block) -> bool
def derived(x: block) -> bool:
  return clear(x)
behavior top(x: block):
  goal: on(x, x)
  body:
    let _used = [still(x), odd(x), derived(x), weight(x) > 0]
"""


@pytest.mark.parametrize(("statement", "expected"), UNMATCHED)
def test_unmatched_achieves(statement: str, expected: list[str]) -> None:
    assert lints(f"{STILL}    {statement}\n") == expected


def test_types_decide_which_goals_match() -> None:
    text = """
typedef box: block
typedef lid
feature shut(x: box)
feature off(x: lid)
behavior shutting(x: box):
  goal: shut(x)
  eff: shut[x] = True
behavior all_shut():
  goal: off(a_lid)
  body:
    achieve shut(a_box)
  eff: off[a_lid] = True
object_constant a_box: box
object_constant a_lid, b_lid: lid
behavior wrong():
  goal: count == 1
  body:
    achieve off(b_lid)
"""
    assert lints(text) == ["unmatched-achieve"]


def test_an_unmatched_achieve_shows_the_effect_that_writes_it() -> None:
    text = "\nbehavior top(x: block):\n  goal: on(x, x)\n  body: achieve not on(x, x)\n"
    (unmatched,) = diagnose(text, HEAD + CLEAR + OTHER + USES)
    assert unmatched.message() == "no behavior has the goal `not on(x, x)`"
    assert "assert" in unmatched.help()[0].text
    assert len(unmatched.labels()) == 1


def test_a_single_behavior_is_a_fragment() -> None:
    text = "behavior top(x: block):\n  goal: clear(x)\n  body: achieve on(x, x)\n"
    assert codes(text, HEAD) == []


def test_unreachable_behaviors() -> None:
    text = """
behavior called(x: block):
  body: do move(x)
behavior calls(x: block):
  goal: on(x, x)
  body: called(x)
behavior idle(x: block):
  body: also_idle(x)
behavior also_idle(x: block):
  body: do move(x)
"""
    assert lints(text) == ["unreachable-behavior"] * 2


def test_behaviors_run_by_name_are_not_reported() -> None:
    assert codes("behavior a():\n  body: do mark()\nbehavior b():\n  body: do mark()\n",
                 "controller mark()\n") == []  # fmt: skip


# ------------------------------------------------------------------------------------ controllers

METHOD = """
controller attach(x: block)
behavior grab(x: block):
  goal: on(x, x)
  body: do attach(x)
"""
MODELLED = """
controller push(x: block):
  eff: clear[x] = True
behavior pushing(x: block):
  goal: clear(x)
  body: do push(x)
"""


def test_unmodelled_controllers() -> None:
    (warning,) = diagnose(METHOD + MODELLED, HEAD + CLEAR + OTHER + USES)
    assert warning.code == "unmodelled-controller"
    assert "`attach`" in warning.message()
    assert len(warning.labels()) == 1


@pytest.mark.parametrize(
    "text",
    [
        METHOD,  # no controller says what it changes: behaviors do
        f"{METHOD.replace('attach(x: block)', 'attach(x: block):', 1)}{MODELLED}".replace(
            "attach(x: block):\n", "attach(x: block):\n  eff: pass\n", 1
        ),
        METHOD + MODELLED + "behavior also(x: block):\n  body: do attach(x)\n"
        "  eff: on[x, x] = True\nbehavior calls(x: block):\n  goal: on(x, x)\n  body: also(x)\n",
        METHOD + MODELLED + "behavior whole(x: block):\n  goal: on(x, x)\n  body: grab(x)\n"
        "  eff: on[x, x] = True\n",
    ],
)
def test_modelled_controllers(text: str) -> None:
    assert lints(text) == []


# ------------------------------------------------------------------------------------- generators

CONNECT = """
typedef Path: pyobject
def connect(a: Pose, b: Pose, t: Path) -> bool
def length(t: Path) -> float64
def other(a: Pose, t: Path) -> bool
controller follow(t: Path)
"""
GENERATOR = """
generator gen(a: Pose, b: Pose, t: Path):
  goal: connect(a, b, t)
  in: a, b
  out: t
"""
GO = """
behavior go(x: block, y: block):
  goal: on(x, y)
  body:
    bind t: Path where: {}
    do follow(t)
  eff: on[x, y] = True
"""
CONSTRAINTS = [
    ("connect(position(x), position(y), t)", []),
    ("connect(position(x), position(y), t) and length(t) < 3.0", []),
    ("other(position(x), t)", ["unmatched-generator", "missing-generator"]),
]


@pytest.mark.parametrize(("condition", "expected"), CONSTRAINTS)
def test_generators(condition: str, expected: list[str]) -> None:
    text = CONNECT + GENERATOR + GO.format(condition)
    found = [c for c in lints(text) if c != "unused-definition"]
    assert found == expected


def test_a_program_without_generators_leaves_them_to_python() -> None:
    text = CONNECT + GO.format("other(position(x), t)")
    assert [c for c in lints(text) if c != "unused-definition"] == []


def test_equations_and_other_behaviors_decide_values() -> None:
    text = CONNECT + GENERATOR + GO.format("connect(position(x), position(y), t)")
    more = """
behavior put(x: block):
  goal: clear(x)
  body:
    bind p: Pose where: p == position(x)
    achieve position(x) == p
    bind q: Pose where: near(q, p)
    achieve position(x) == q
  eff: clear[x] = True
def near(p: Pose, q: Pose) -> bool
"""
    assert [c for c in lints(text + more) if c != "unused-definition"] == []


# ------------------------------------------------------------------------------------- conditions

CONDITIONS = [
    ("assert True", ["constant-condition"]),
    ("assert not False", ["constant-condition"]),
    ("assert 1 < 2", ["constant-condition"]),
    ("assert -1 < 2", ["constant-condition"]),
    ("assert 1 < 2 < 3", ["constant-condition"]),
    ("assert x == x", ["constant-condition"]),
    ("assert clear(x) == clear(x)", ["constant-condition"]),
    ("assert clear(x) or not clear(x)", ["constant-condition"]),
    ("assert clear(x) or True", ["constant-condition"]),
    ("achieve True", ["constant-condition"]),
    ("if 1 > 2:\n      do move(x)", ["constant-condition"]),
    ("let _n = 1 if True else 2", ["constant-condition"]),
    ("assert clear(x)", []),
    ("assert clear(x) == True", []),
    ("assert count > 1", []),
]


@pytest.mark.parametrize(("statement", "expected"), CONDITIONS)
def test_constant_conditions(statement: str, expected: list[str]) -> None:
    text = (
        f"\nbehavior top(x: block):\n  goal: on(x, x)\n  body:\n    {statement}\n    do move(x)\n"
    )
    assert lints(text) == expected


# ----------------------------------------------------------------------------------------- unused

UNUSED = [
    ("feature lonely(x: block)", ["unused-definition"]),
    ("def external(x: block) -> bool", []),
    ("def lonely(x: block) -> bool:\n  return clear(x)", ["unused-definition"]),
    ("controller lonely(x: block)", ["unused-definition"]),
    ("typedef lonely", ["unused-definition"]),
    ("typedef Lonely: float32", ["unused-definition"]),
    ("typedef kind: block", []),
    ("typedef thing\nobject_constant a: thing", []),
    ("feature read(x: block)\ndef [[reads=read]] f(x: block) -> bool", []),
    ("def f(x: block) -> bool:\n  return True", ["unused-definition", "unused-parameter"]),
    ("def f(_x: block) -> bool:\n  return True", ["unused-definition"]),
    ("behavior top(x: block, y: block):\n  goal: clear(x)", ["unused-parameter"]),
    ("behavior top(x: block, _y: block):\n  goal: clear(x)", []),
    ("behavior top(x: block):\n  goal: clear(x)\n  body:\n    let n = 1", ["unused-variable"]),
    ("behavior top(x: block):\n  goal: clear(x)\n  body:\n    bind y: block where: clear(x)",
     ["unused-variable"]),
    ("behavior top(x: block):\n  goal: clear(x)\n  body:\n    bind y: block where: on(x, y)", []),
    ("behavior top(x: block):\n  goal: clear(x)\n  eff:\n    let n = 1\n    clear[x] = True",
     ["unused-variable"]),
]  # fmt: skip


@pytest.mark.parametrize(("text", "expected"), UNUSED)
def test_unused_names(text: str, expected: list[str]) -> None:
    assert lints(f"\n{text}\n") == expected


def test_included_files_are_libraries(tmp_path: Path) -> None:
    (tmp_path / "library.cdl").write_text(f"{HEAD}{CLEAR}{OTHER}{USES}feature spare(x: block)\n")
    main = tmp_path / "main.cdl"
    main.write_text('include "library.cdl"\nfeature extra(x: block)\n' + METHOD)
    assert [(d.code, Path(d.location.file).name) for d in cdlc.check(main)] == [
        ("unused-definition", "main.cdl")
    ]


def test_a_problem_uses_what_its_goal_mentions(tmp_path: Path) -> None:
    (tmp_path / "d.cdl").write_text(f"{HEAD}{CLEAR}{OTHER}{USES}feature spare(x: block)\n")
    problem = tmp_path / "p.cdl"
    problem.write_text('problem "p"\ndomain "d.cdl"\nobjects: A: block\ngoal: spare(A)\n')
    assert cdlc.check(problem) == ()
    assert [d.code for d in cdlc.check(tmp_path / "d.cdl")] == ["unused-definition"]


NAMO = Path(__file__).parent / "namo"


@pytest.mark.parametrize("strategy", ["direct", "waypoint", "interleaved"])
@pytest.mark.parametrize("in_one_file", [False, True])
def test_namo_has_the_warning_of_appendix_c_alone(
    strategy: str, in_one_file: bool, tmp_path: Path
) -> None:
    file = NAMO / f"{strategy}.cdl"
    if in_one_file:
        text = file.read_text().replace('include "shared.cdl"', (NAMO / "shared.cdl").read_text())
        file = tmp_path / "whole.cdl"
        file.write_text(text)
    (warning,) = cdlc.check(file)
    assert warning.code == "shadowing"
    assert "`t`" in warning.message()
