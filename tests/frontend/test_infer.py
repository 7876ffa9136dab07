"""Untyped parameters of behaviors and generators (language.md §4)."""

import pytest
from cases import PRELUDE, codes, diagnose, program

INFERRED = [
    ("goal: clear(x)", "block"),
    ("goal: heavy(x)", "box"),
    ("goal: position(table_block) == x", "Pose"),
    ("goal: x == position(table_block)", "Pose"),
    ("goal: at(table_block) == x", "place"),
    ("goal: size(table_block) >= x", "float32"),
    ("eff: clear[x] = True", "block"),
    ("eff: position[table_block] = x", "Pose"),
    ("eff: position[table_block] += x", "Pose"),
    ("eff: size[table_block] = x + 1", "float32"),
    ("eff: size[table_block] = 2 * x", "float32"),
    ("eff: size[table_block] = -x", "float32"),
    ("eff: size[table_block] = 1 if clear(table_block) else x", "float32"),
    ("eff: clear[table_block] = x", "bool"),
    ("eff: position[table_block] = [x, 1]", "float32"),
    ("body: do pick(x)", "block"),
    ("body: do go(x)", "Pose"),
    ("body: other(x)", "box"),
    ("body: achieve clear(x) and heavy(x)", "box"),
    ("body: assert near(x, x)", "Pose"),
    ("body: assert x", "bool"),
    ("body: assert x > 0", "int64"),
    ("body: assert x > 0 or x < 0.5", "float64"),
    ("body: assert x > level(table_block)", "int32"),
    ("body: assert x == width(table_block) and size(table_block) == x", "Length"),
    ("body: assert level(table_block) == x and size(table_block) == x", "int32"),
    ('body: assert x == "red"', "string"),
    ("body: let y = x; do pick(y)", "block"),
    ("body: let y: Pose = x; do go(y)", "Pose"),
    ("body: bind y: block where: on(x, y); do pick(y)", "block"),
    ("body: assert exists y: block: on(y, x)", "block"),
    ("body: bind y: block; assert y == x", "block"),
    ("body: assert min(x, size(table_block)) > 0", "float32"),
    ("body: assert position(table_block) + x == position(table_block)", "Pose"),
    ("body: assert (x ^ clear(table_block)) and not x", "bool"),
    ("body:\n    foreach y: block:\n      if on(x, y):\n        do pick(y)", "block"),
    ("body:\n    for i in range(3):\n      assert i < x", "int64"),
    ("body:\n    unordered:\n      achieve clear(x)", "block"),
    ("body:\n    promotable:\n      achieve heavy(x)", "box"),
]
OTHERS = """
object_constant table_block: box
behavior other(x: box):
  goal: heavy(x)
"""
REJECTED = [
    ("behavior r(x):\n  goal: clear(table_block)", []),
    ("behavior r(x):\n  body: pass", []),
    ("behavior r(x):\n  goal: clear(x)\n  eff: at[table_block] = x", ["block", "place"]),
    ("behavior r(x):\n  body: assert clear(x) and near(x, x)", ["block", "Pose"]),
    ("behavior r(x):\n  body: assert x == width(table_block) or x == mass(table_block)",
     ["Length", "Mass"]),
    ("behavior r(x):\n  body: assert exists y: block: clear(y)", []),
]  # fmt: skip


@pytest.mark.parametrize(("section", "expected"), INFERRED)
def test_uses_imply_a_type(section: str, expected: str) -> None:
    checked = program(f"{OTHERS}behavior r(x):\n  {section}\n", PRELUDE)
    assert str(checked.behaviors[-1].parameters[0].type) == expected


@pytest.mark.parametrize(("text", "candidates"), REJECTED)
def test_undecided_parameters_ask_for_a_type(text: str, candidates: list[str]) -> None:
    asked, *rest = diagnose(f"{OTHERS}{text}\n", PRELUDE)
    assert asked.code == "uninferable-parameter"
    assert list(asked.candidates) == candidates  # type: ignore[attr-defined]
    assert rest == []


def test_calls_pass_types_on_in_any_order() -> None:
    text = """behavior a(x, y):
  body: b(y, x)
behavior b(u, v):
  body:
    c(u)
    if clear(u):
      achieve at(u) == v
behavior c(w):
  body: achieve heavy(w)
"""
    checked = program(text, PRELUDE)
    types = {b.name: [str(p.type) for p in b.parameters] for b in checked.behaviors}
    assert types == {"a": ["place", "box"], "b": ["box", "place"], "c": ["box"]}


def test_recursive_behaviors_are_inferred_and_reported() -> None:
    text = """behavior a(x):
  body: b(x)
behavior b(x):
  body:
    a(x)
    pick(x)
"""
    assert codes(text, PRELUDE) == ["recursive-call"]


def test_generators_are_inferred_from_their_goal() -> None:
    text = """generator g(p, q, r):
  goal: middle(p, q) = r
  in: r
  out: p, q
generator h(x, n):
  goal: number(x) == n
  in: n
  out: x
"""
    checked = program(text, PRELUDE)
    types = [[str(p.type) for p in g.parameters] for g in checked.generators]
    assert types == [["Pose"] * 3, ["block", "float32"]]


def test_a_problem_elsewhere_in_the_definition_is_the_only_message() -> None:
    assert codes("behavior r(x):\n  goal: nothing(x)\n", PRELUDE) == ["unknown-feature"]
    assert codes("behavior r(x):\n  body:\n    achieve ) (\n", PRELUDE) != []
    assert "uninferable-parameter" not in codes("behavior r(x):\n  body:\n    pick x\n", PRELUDE)


def test_inferred_types_are_checked_at_calls() -> None:
    text = (
        "behavior r(x):\n  goal: heavy(x)\nbehavior s(x: block):\n  goal: clear(x)\n  body: r(x)\n"
    )
    assert codes(text, PRELUDE) == ["wrong-argument-type"]


def test_deep_expressions_are_reported_once() -> None:
    text = f"behavior r(x):\n  body: assert {' + '.join(['x'] * 300)} == 1\n"
    assert codes(text, PRELUDE) == ["nesting-too-deep"]
