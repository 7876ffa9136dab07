"""Behaviors whose effects do not establish their goals, and those that do in other ways."""

from textwrap import dedent, indent

import pytest
from programs import program_of

from cdlc.diagnostics import Collector, Diagnostic
from cdlc.ir.lints import lint

DECLARATIONS = """
typedef T
typedef place
typedef pose: vector[float32, 2]
object_constant home: T
feature p(x: T)
feature q(x: T)
feature on(x: T, y: T)
feature level(x: T) -> int64
feature at(x: T) -> place
feature position(x: T) -> pose
controller go(x: T)
controller make(x: T):
  eff: p[x] = True
def external(x: T)
def outside(x: T) -> int64
def good(x: T): return p(x) and q(x)
"""


def found_in(goal: str, eff: str, body: str, parameters: str) -> tuple[Diagnostic, ...]:
    text = f"{DECLARATIONS}behavior act({parameters}):\n  goal: {goal}\n"
    text += "  body:\n" + indent(dedent(body), "    ") + "\n"
    text += "  eff:\n" + indent(dedent(eff), "    ") + "\n"
    found = Collector()
    lint(program_of(text), found)
    return tuple(d for d in found.sorted() if d.code == "goal-not-established")


@pytest.mark.parametrize(
    ("goal", "eff", "body"),
    [
        ("p(x)", "p[x] = True", "pass"),
        ("not p(x)", "p[x] = False", "pass"),
        ("p(x)", "q[x] = True", "assert p(x)"),
        ("p(x)", "q[x] = True", "bind z: T where: p(x) and q(z)"),
        ("p(x)", "q[x] = True", "do make(x)"),
        ("p(x)", "p[x] = True\np[y] = False", "assert x != y"),
        ("p(x)", "p[x] = True\np[y] = False", "assert not y == x"),
        ("p(x)", "p[x] = True\np[y] = q(x)", "assert q(x)"),
        ("p(x)", "p[y] = True", "assert x == y"),
        ("p(x)", "p[x] = q(y)", "assert q(y)"),
        ("p(x)", "p[x] = q(y)", "assert q(x) and q(y) or q(y)"),
        ("p(x)", "p[x] = q(y) ^ q(x)", "assert q(y)\nassert not q(x)"),
        ("p(x)", "p[x] = False", "assert q(x)\nassert not q(x)"),
        ("good(x)", "p[x] = True\nq[x] = True", "pass"),
        ("at(x) == o", "at[x] = o", "pass"),
        ("o == at(x)", "at[x] = o", "pass"),
        ("position(x) == t", "position[x] = t", "pass"),
        ("level(x) == 3", "level[x] = 3", "pass"),
    ],
)
def test_goals_that_are_established(goal: str, eff: str, body: str) -> None:
    assert found_in(goal, eff, body, "x: T, y: T, o: place, t: pose") == ()


@pytest.mark.parametrize(
    ("goal", "eff", "body"),
    [
        ("level(x) > 3", "level[x] = 4", "pass"),
        ("level(x) > 3", "level[x] = level(x) + 1", "pass"),
        ("level(x) == 3", "level[x] = outside(x)", "pass"),
        ("external(x)", "p[x] = True", "pass"),
        ("p(x)", "p[x] = external(x)", "pass"),
        ("p(x)", "p[x] = forall z: T: q(z)", "pass"),
        ("p(x)", "p[x] = level(x) > 3", "pass"),
        ("p(x)", "p[x] = q(y)", "pass"),
        ("p(x)", "foreach z: T: p[z] = True", "pass"),
    ],
)
def test_goals_that_folding_cannot_judge(goal: str, eff: str, body: str) -> None:
    assert found_in(goal, eff, body, "x: T, y: T") == ()


@pytest.mark.parametrize(
    ("goal", "eff", "body", "suggestion"),
    [
        ("p(x)", "p[y] = True", "pass", "p[x] = True"),
        ("not p(x)", "p[y] = False", "pass", "p[x] = False"),
        ("p(x)", "p[x] = False", "pass", None),
        ("p(x)", "q[x] = True", "pass", None),
        ("p(x)", "p[x] = True\np[y] = False", "pass", "p[x] = True"),
        ("p(x)", "p[home] = True", "pass", "p[x] = True"),
        ("on(x, y)", "on[y, x] = True", "pass", "on[x, y] = True"),
        ("p(x)", "q[x] = True", "achieve_once p(x)", None),
    ],
)
def test_goals_that_are_not_established(
    goal: str, eff: str, body: str, suggestion: str | None
) -> None:
    (warning,) = found_in(goal, eff, body, "x: T, y: T")
    assert warning.code == "goal-not-established"
    assert warning.message() == f"the effects of `act` do not establish its goal `{goal}`"
    assert warning.location.line == len(DECLARATIONS.splitlines()) + 2
    assert [help_.text for help_ in warning.help()] == (
        [] if suggestion is None else [f"did you mean `{suggestion}`?"]
    )
