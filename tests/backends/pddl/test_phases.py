"""Behaviors of several phases or ways: what PDDL gets, what planners find, and back."""

from pathlib import Path
from textwrap import dedent, indent

import pytest
from conftest import Golden
from programs import emitted, program_of

from cdlc.backends.engines import installed
from cdlc.backends.pddl import PddlTask, to_step
from cdlc.backends.pddl.parts import parts_of
from cdlc.backends.pddl.sexpr import NotPddl
from cdlc.backends.pddl.solve import InvalidPlan, run
from cdlc.cli import main
from crow.problem import Problem
from crow.trace import EffItem

GOLDEN = Path(__file__).parent / "golden"
needs_planner = pytest.mark.skipif("fast-downward" not in installed(), reason="needs `planners`")

HEAD = """
typedef room
typedef door
feature at(r: room)
feature near(r: room, s: room)
feature joins(d: door, r: room)
feature key(r: room)
feature tired()
feature oiled(d: door)
feature opened(d: door)
feature place() -> room
controller walk(r: room, s: room)
controller unlock(d: door)
controller push(d: door)
controller drip(d: door)
behavior go(r: room, s: room):
  goal: at(s)
  body:
    assert near(r, s)
    achieve at(r)
    do walk(r, s)
  eff:
    at[r] = False
    at[s] = True
    tired[] = True
"""
PLACED = f"{HEAD}    place[] = s\n"
OIL = """
feature oil() -> int64
controller use_oil(d: door):
  eff:
    oil[] -= 1
"""
WITH_OIL = HEAD.replace("    tired[] = True\n", "    tired[] = True\n    oil[] += 1\n")
NUMERIC = OIL + WITH_OIL

PROBLEM = """
problem "doors"
objects:
  a, b, c: room
  d, e: door
init:
  at[a] = True
  near[a, b] = True
  near[b, c] = True
  near[b, a] = True
  near[c, b] = True
  key[b] = True
  place[] = a
  joins[d, c] = True
  joins[e, a] = True
goal: {}
"""


def domain(body: str, eff: str = "", more: str = "", head: str = HEAD) -> str:
    """A head, with `open_door(d)` of a body and an effect."""
    behavior = f"behavior open_door(d: door):\n  goal: opened(d)\n  body:\n{indent(body, '    ')}"
    effect = indent(f"opened[d] = True\n{eff}", "    ")
    return f"{head}{dedent(more)}{behavior}\n  eff:\n{effect}\n"


def parts(text: str, name: str = "open_door") -> list[str]:
    """The names of the parts of a behavior, those that need another one marked."""
    program = program_of(text)
    behavior = next(b for b in program.behaviors if b.name == name)
    found = parts_of(program, behavior)
    return [
        part.name + (f" after {part.needs.feature.name}" if part.needs else "") for part in found
    ]


TWO = """
bind k: room where: key(k)
achieve at(k)
do unlock(d)
bind r: room where: joins(d, r)
achieve at(r)
do push(d)
"""
LET = """
let start = place()
bind r: room where: joins(d, r)
assert not oiled(d)
achieve at(r)
do push(d)
"""


SPLIT = ["open_door'1", "open_door'2 after open_door'1"]


@pytest.mark.parametrize(
    ("body", "eff", "expected"),
    [
        ("do unlock(d)", "", ["open_door"]),
        (TWO, "", SPLIT),
        ("do unlock(d)\nassert tired()\ndo push(d)", "", ["open_door"]),
        ("do unlock(d)\nachieve_once tired()", "", SPLIT),
        ("do unlock(d)\nif oiled(d): achieve tired()", "", SPLIT),
        (LET, "", ["open_door"]),
        (LET, "place[] = start", SPLIT),
        (f"{LET}assert start != r\n", "", SPLIT),
        ("sequential:\n  do unlock(d)\n  achieve tired()", "", SPLIT),
        ("alternative:\n  do unlock(d)", "", ["open_door'1"]),
        ("alternative:\n  do unlock(d)\n  do push(d)", "", ["open_door'1", "open_door'2"]),
        ("unordered:\n  do unlock(d)\n  do push(d)", "", ["open_door"]),
        (
            "unordered:\n  sequential:\n    achieve tired()\n    do unlock(d)\n  do push(d)",
            "",
            [
                "open_door'1",  # tired, unlock, push
                "open_door'2",  # tired, push, unlock
                "open_door'3",  # push
                "open_door'4 after open_door'3",  # tired, unlock
            ],
        ),
    ],
)
def test_parts(body: str, eff: str, expected: list[str]) -> None:
    assert parts(domain(body, eff, head=PLACED)) == expected


CALLED = """
behavior lubricate(d: door):
  body:
    bind r: room where: joins(d, r)
    let before = place()
    assert not oiled(d)
    do drip(d)
    achieve at(r)
    do drip(d)
  eff:
    oiled[d] = before != r
"""


def test_a_called_behavior_is_split_with_its_caller() -> None:
    text = domain("lubricate(d)\ndo push(d)", more=CALLED)
    assert parts(text) == SPLIT
    assert parts(text, "lubricate") == ["lubricate'1", "lubricate'2 after lubricate'1"]


@pytest.mark.parametrize(
    ("text", "construct"),
    [
        (domain("do unlock(d)\nachieve opened(d)"), "`open_door`, which achieves something after"),
        (
            domain(
                "do unlock(d)\nachieve oiled(d)",
                more="""
                behavior oiling(d: door):
                  goal: oiled(d)
                  body:
                    achieve opened(d)
                    do drip(d)
                  eff:
                    oiled[d] = True
                """,
            ),
            "may be applied for that itself",
        ),
        (
            domain("if oiled(d): assert tired()\n" + LET, "place[] = start", head=PLACED),
            "an `if` before an `achieve`",
        ),
        (
            domain("unordered:\n  let k = place()\n  do unlock(d)\n  achieve tired()"),
            "a local or `bind` in an `unordered` group",
        ),
        (
            domain(
                "unordered:\n"
                + "".join(
                    f"  sequential:\n    do {c}(d)\n    achieve tired()\n" for c in 3 * ["push"]
                )
            ),
            "more than 64 ways",
        ),
    ],
)
def test_what_cannot_be_split_is_refused(text: str, construct: str) -> None:
    with pytest.raises(NotPddl) as raised:
        parts(text)
    assert construct in str(raised.value)
    assert raised.value.location is not None


NUMBERS = domain(
    TWO + "let left = oil()\nachieve tired()\ndo drip(d)", "oil[] = left - 1", head=NUMERIC
)


def test_golden(golden: Golden) -> None:
    task, found, _ = emitted(NUMBERS, PROBLEM.format("opened(d) and opened(e)"))
    assert task is not None
    assert [d.code for d in found] == ["split-behavior"]
    golden(GOLDEN / "phases.pddl", f"{task.domain}\n{task.problem}")


# ------------------------------------------------------------------------------------------- plans

ANYTIME = """
alternative:
  sequential:
    assert oiled(d)
    do push(d)
  do drip(d)
"""
DISTURBING = """
unordered:
  sequential:
    bind r: room where: joins(d, r)
    achieve at(r)
    do use_oil(d)
  do unlock(d)
"""


WAYS = """
alternative:
  sequential:
    assert oiled(d)
    do push(d)
  do drip(d)
"""
ORDERS = """
bind r: room where: joins(d, r)
unordered:
  sequential:
    achieve at(r)
    do push(d)
  do unlock(d)
"""


@needs_planner
@pytest.mark.parametrize(
    ("text", "engine"),
    [
        (domain(TWO), "fast-downward"),
        (domain(TWO + "achieve tired()\ndo drip(d)"), "fast-downward"),
        (domain(WAYS), "fast-downward"),
        (domain(ORDERS), "fast-downward"),
        (domain(LET, "place[] = start", head=PLACED), "fast-downward"),
        (domain("lubricate(d)\ndo push(d)", more=CALLED), "fast-downward"),
        (NUMBERS, "kairos"),
        (domain("let left = oil()\n" + TWO, "oil[] = left - 1", head=NUMERIC), "kairos"),
        (domain("let l = oil() > 1\n" + TWO, "tired[] = l", head=NUMERIC), "kairos"),
    ],
)
def test_plans_come_back_and_replay(
    text: str, engine: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "d.cdl").write_text(text)
    problem = PROBLEM.format("opened(d) and opened(e)").replace(
        "objects:", 'domain "d.cdl"\nobjects:', 1
    )
    (tmp_path / "p.cdl").write_text(problem)
    file, plan = str(tmp_path / "p.cdl"), tmp_path / "plan"
    for form in ("text", "json"):
        assert main(["plan", file, "--engine", engine, "--format", form]) == 0
        plan.write_text(capsys.readouterr().out)
        status = main(["validate", file, str(plan)])
        assert status == 0, capsys.readouterr().err
        capsys.readouterr()
    assert main(["plan", file, "--time-limit", "20"]) == 0, capsys.readouterr().err


def open_task(text: str) -> tuple[PddlTask, Problem]:
    task, _, problem = emitted(text, PROBLEM.format("opened(d)"))
    assert task is not None
    assert problem is not None
    return task, problem


@pytest.mark.parametrize(
    ("steps", "message"),
    [
        ("walk a b; unlock d b c; walk b c; push d c", None),
        ("push d c", "step 1: .*the phase before this one has not been"),
        ("walk a b; unlock d b c; walk b c; push d c; push d c", "step 5: .*has not been"),
        ("walk a b; unlock d b c; unlock d b c", "step 3: .*has begun already"),
        ("walk a b; unlock d b c; walk b a; push d c", "step 4: "),
        ("walk a b; unlock d b c; walk b c", "`open_door` has begun and does not end"),
    ],
)
def test_phases_are_carried_out_in_order(steps: str, message: str | None) -> None:
    task, problem = open_task(domain(TWO))
    lines = [line.split() for line in steps.split("; ")]
    planned = [to_step(task, problem.world, name, tuple(rest), 1) for name, *rest in lines]
    if message is None:
        made, trace = run(problem, planned)
        assert [s.controller for s in made] == ["walk", "unlock", "walk", "push"]
        assert [s.bindings for s in made][1::2] == [{"k": "b", "r": "c"}, {"r": "c"}]
        assert [i.owner for i in trace if isinstance(i, EffItem)] == ["go", "go", "open_door"]
        return
    with pytest.raises(InvalidPlan, match=message):
        run(problem, planned)


def test_what_was_held_before_a_split_is_held_after_it() -> None:
    task, _ = open_task(domain(LET, "place[] = start", head=PLACED))
    action = task.actions_by_name["push"]
    assert "oiled" in str(action.precondition)
