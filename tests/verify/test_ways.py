# ruff: noqa: E501 - a row is a case
"""Every triple has the body it was made of, and only what runs is shown."""

import pytest
from programs import program_of
from verifying import check, report, verdict

from cdlc.ir.hoare import Model
from cdlc.verify.ways import ways, ways_of_triples

HEAD = """
typedef T
feature p(x: T)
feature q(x: T)
feature r(x: T)
feature n() -> int64
controller set_p(x: T):
  eff:
    p[x] = True
controller unset_p(x: T):
  eff:
    p[x] = False
controller go(x: T)
behavior helper(x: T):
  body:
    alternative:
      do set_p(x)
      do unset_p(x)
  eff:
    r[x] = True
"""


def acting(goal: str, body: str, effect: str) -> str:
    def block(head: str, lines: str) -> str:
        return f"  {head}:\n" + "".join(f"    {line}\n" for line in lines.splitlines())

    return f"{HEAD}behavior act(x: T, y: T):\n  goal: {goal}\n{block('body', body)}{block('eff', effect)}"


@pytest.mark.parametrize(
    ("goal", "body", "effect", "count", "expected"),
    [
        ("q(x)", "do go(y)", "q[x] = True", 1, "proved"),
        # Controllers have effects of their own.
        ("p(x)", "do set_p(x)", "q[x] = True", 1, "proved"),
        ("p(x)", "do set_p(x)\ndo unset_p(y)", "q[x] = True", 1, "refuted"),
        # One way that fails is enough.
        ("p(x)", "alternative:\n  do set_p(x)\n  do go(x)", "q[y] = True", 2, "refuted"),
        ("p(x)", "alternative:\n  do set_p(x)\n  assert p(x)", "q[y] = True", 2, "proved"),
        ("p(x)", "unordered:\n  do set_p(x)\n  do unset_p(x)", "q[y] = True", 2, "refuted"),
        ("p(x)", "unordered:\n  do set_p(x)\n  do go(x)", "q[y] = True", 2, "proved"),
        ("p(x)", "sequential:\n  do unset_p(x)\n  do set_p(x)", "q[y] = True", 1, "proved"),
        # Called behaviors are inlined, with their choices.
        ("r(x)", "helper(x)", "q[y] = True", 2, "proved"),
        ("p(x)", "helper(x)", "q[y] = True", 2, "refuted"),
        ("r(x)", "helper(x)\nhelper(y)", "q[y] = True", 4, "proved"),
        ("not r(x)", "helper(y)\nalternative:\n  assert q(x)\n  assert not r(x)", "q[y] = True", 4, "refuted"),
        # Conditions under `if`, `foreach` and `for`, and a `let`.
        ("q(x)", "foreach z: T:\n  assert q(z)", "r[x] = True", 1, "proved"),
        ("q(x)", "if r(x):\n  assert q(x)\nelse:\n  assert q(y)", "r[x] = False", 1, "refuted"),
        ("q(x)", "for i in range(2):\n  assert n() == i", "q[x] = False", 1, "proved"),
        ("q(x)", "let k = p(x)\nassert k", "q[x] = k", 1, "proved"),
        # A bind that takes the name of a parameter.
        ("q(x)", "bind y: T where: p(y)\ndo go(y)", "q[x] = p(y)", 1, "proved"),
        ("q(x)", "bind y: T where: p(y)\ndo go(y)", "q[x] = r(y)", 1, "refuted"),
    ],
)  # fmt: skip
def test_ways_through_bodies(goal: str, body: str, effect: str, count: int, expected: str) -> None:
    text = acting(goal, body, effect)
    program = program_of(text)
    behavior = next(b for b in program.behaviors if b.name == "act")
    assert len(ways(program, behavior)) == count
    # The model may see that orders make no difference.
    assert len(Model(program).triples(behavior)) <= count
    assert verdict(text) == expected


def test_triples_of_several_ways_are_tried_in_all_of_them() -> None:
    text = acting("q(x)", "unordered:\n  do set_p(x)\n  do unset_p(x)", "q[x] = True")
    program = program_of(text)
    behavior = next(b for b in program.behaviors if b.name == "act")
    both = ways(program, behavior)
    assert ways_of_triples(program, behavior, 2) == ((both[0],), (both[1],))
    assert ways_of_triples(program, behavior, 1) == (both,)


def test_what_has_no_model_is_unknown_and_the_rest_is_verified() -> None:
    text = acting("p(x)", "do go(x)\nachieve p(x)", "q[x] = True") + (
        "behavior fine(x: T):\n  goal: q(x)\n  eff:\n    q[x] = True\n"
    )
    assert [(v.behavior, str(v.verdict)) for v in report(text).behaviors] == [
        ("helper", "proved"),
        ("act", "unknown"),
        ("fine", "proved"),
    ]
    (missing,) = [v for v in report(text).behaviors if v.behavior == "act"]
    assert missing.checks[0].reason.startswith(
        "an `achieve` after a controller call has no formula"
    )


def test_a_function_of_the_state_is_not_what_it_was_before() -> None:
    text = """
typedef T
feature p(x: T)
feature q(x: T)
def [[reads=p]] sense(x: T) -> bool
def fixed(x: T) -> bool
def sensed(x: T) -> bool:
  return sense(x)
behavior act(x: T):
  goal: sensed(x)
  body:
    assert sense(x)
  eff:
    p[x] = True
"""
    found = check(text, "goal")
    assert str(found.verdict) == "unknown"
    assert found.reason.startswith("`sense`, which reads `p`, after a write of it has no formula")
    assert verdict(text.replace("reads=p", "reads=q")) == "proved"
    assert verdict(text.replace("[[reads=p]] ", "")) == "proved"


def test_deep_formulas_end_within_the_limit() -> None:
    """A chain of choices 10,000 nodes deep: undecided perhaps, but no crash."""
    text = """
feature f() -> int64
def wanted() -> bool:
  return f() >= 0
behavior act():
  goal: wanted()
  body:
    assert f() == 5
  eff:
    for i in range(2000):
      if f() > i:
        f[...] -= 1
"""
    assert verdict(text, limit=2) in ("proved", "unknown")
