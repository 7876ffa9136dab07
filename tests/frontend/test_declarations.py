"""Definitions: names, types, annotations, sections (language.md §2)."""

import pytest
from cases import PRELUDE, codes, diagnose, program

TYPES = [
    ("typedef T", []),
    ("typedef T: object", []),
    ("typedef T: U\ntypedef U", []),
    ("typedef p: vector[float32; 2]\ntypedef q: vector[float32, 2]\ntypedef r: vector[p]", []),
    ("typedef p: float32[]\ntypedef q: pyobject\ntypedef r: q", []),
    ("typedef T: T", ["type-cycle"]),
    ("typedef T: U\ntypedef U: T", ["type-cycle"]),
    ("typedef T: vector[U, 2]\ntypedef U: T", ["type-cycle"]),
    ("typedef T: nowhere\nfeature f(x: T)", ["unknown-type"]),
    ("typedef T: list[float32]", ["unknown-type"]),
    ("typedef T\ntypedef T", ["duplicate-definition"]),
    ("typedef bool", ["hides-definition"]),
    ("typedef object", ["hides-definition"]),
]
VALUES = [
    ("feature f()", []),
    ("feature f(x: block, y: block) -> place", []),
    ("feature f() -> vector[float32, 3]", []),
    ("feature f(x: int64)", ["value-index"]),
    ("feature f(p: Pose) -> bool", ["value-index"]),
    ("feature f(x, y: block)", ["missing-type"]),
    ("feature f(x: nowhere)", ["unknown-type"]),
    ("feature f(x: block, x: block)", ["duplicate-definition"]),
    ("feature f(x: block)\nfeature f()", ["duplicate-definition"]),
    ("feature f(clear: block)", ["hides-definition"]),
    ("feature pick(x: block)", ["duplicate-definition"]),
    ("feature table()", ["duplicate-definition"]),
    ("feature min()", ["hides-definition"]),
    ("feature block(x: block)", []),
    ("object_constant a, b: block", []),
    ("object_constant a, a: block", ["duplicate-definition"]),
    ("object_constant a: Pose", ["not-an-object-type"]),
    ("object_constant a: nowhere", ["unknown-type"]),
    ("controller c(x)", ["missing-type"]),
    ("def f(x) -> bool", ["missing-type"]),
    ("objects:\n  A: block", ["misplaced-part"]),
    ("init:\n  count = 1", ["misplaced-part"]),
    ("goal: clear(A)", ["misplaced-part"]),
    ("minimize: count", ["misplaced-part"]),
]
SECTIONS = [
    ("controller c(x: block):\n  eff:\n    clear[x] = True", []),
    ("controller c(x: block):\n  goal: clear(x)", ["misplaced-section"]),
    ("behavior r(x: block):\n  goal: clear(x)\n  goal: clear(x)", ["duplicate-section"]),
    ("behavior r(x: block):\n  eff: clear[x] = True\n  body: pass\n  goal: clear(x)", []),
    ("behavior r(x: block):\n  in: x", ["misplaced-section"]),
    ("action r(x: block):\n  goal: clear(x)", []),
    ("generator g(x: block, p: Pose):\n  goal: near(p, position(x))\n  in: x\n  out: p",
     ["unsupported-goal"]),
    ("generator g(p: Pose, q: Pose):\n  goal: near(p, q)\n  in: p\n  out: q", []),
    ("generator g(p: Pose, q: Pose):\n  in: p\n  out: q", ["missing-section"]),
    ("generator g(p: Pose, q: Pose):\n  goal: near(p, q)\n  in: p\n  out: r", ["unknown-name"]),
    ("generator g(p: Pose, q: Pose):\n  goal: near(p, q)\n  in: p, q\n  out: q", ["bad-direction"]),
    ("generator g(p: Pose, q: Pose):\n  goal: near(p, q)\n  in: p", ["missing-section"]),
    ("generator g(p: Pose, q: Pose):\n  goal: near(p, q)\n  in: p\n  out:", ["missing-section"]),
    ("generator g(p: Pose, q: Pose):\n  goal: near(p, q)\n  out: q", ["bad-direction"]),
    ("generator g(p: Pose, q: Pose, r: Pose):\n  goal: middle(p, q) = r\n  in: r\n  out: p, q", []),
]  # fmt: skip
GOALS = [
    ("clear(x)", []),
    ("not clear(x)", []),
    ("position(x) == p", []),
    ("p == position(x)", []),
    ("size(x) >= 2", []),
    ("near(p, p)", []),
    ("at(x) == table", []),
    ("clear(x) and on(x, x)", ["unsupported-goal"]),
    ("clear(x) or on(x, x)", ["unsupported-goal"]),
    ("forall y: block: on(x, y)", ["unsupported-goal"]),
    ("size(x) >= 2 + 1", ["unsupported-goal"]),
    ("p == p", ["unsupported-goal"]),
    ("near(p, position(x))", ["unsupported-goal"]),
    ("position(x) = p", ["equals-in-goal"]),
    ("count", ["wrong-type"]),
    ("clear(z)", ["unknown-name"]),
]
ANNOTATIONS = [
    ("feature [[min=0, max=20]] f() -> int32", []),
    ("feature [[min=-5]] f() -> int64", []),
    ("feature [[max=0]] [[min=0]] f() -> int32", []),
    ('feature [[pddl="on-table"]] f()', []),
    ('typedef [[pddl="Block"]] T', []),
    ('object_constant [[pddl="a-b"]] a: block', []),
    ("typedef [[tolerance=0.01]] P: vector[float32, 2]", []),
    ("typedef [[tolerance=1]] P: float32", []),
    ("def [[reads=position]] f(x: block) -> bool", []),
    ("def [[reads=position, size]] f(x: block) -> bool", []),
    ("def [[reads=all]] f(x: block) -> bool", []),
    ("generator [[reads=position]] g(x: block):\n  goal: clear(x)\n  out: x", []),
    ("generator [[reads=siez]] g(x: block):\n  goal: clear(x)\n  out: x", ["unknown-feature"]),
    ("behavior [[max_nested=1]] r(x: block):\n  goal: clear(x)", []),
    ("feature [[min=1.5]] f() -> int32", ["bad-annotation"]),
    ('feature [[min="a"]] f() -> int32', ["bad-annotation"]),
    ("feature [[min=True]] f() -> int32", ["bad-annotation"]),
    ("feature [[min=low]] f() -> int32", ["bad-annotation"]),
    ("feature [[min]] f() -> int32", ["bad-annotation"]),
    ("feature [[min=2, max=1]] f() -> int32", ["bad-annotation"]),
    ("feature [[min=2, min=1]] f() -> int32", ["bad-annotation"]),
    ("feature [[min=0]] f() -> float32", ["bad-annotation"]),
    ("feature [[min=0]] f()", ["bad-annotation"]),
    ("feature [[min=0]] f() -> nowhere", ["unknown-type"]),
    ("typedef [[tolerance=0.01]] T", ["bad-annotation"]),
    ("typedef [[tolerance=-1]] P: float32", ["bad-annotation"]),
    ("typedef [[tolerance]] P: float32", ["bad-annotation"]),
    ("def [[reads=number]] f(x: block) -> bool", ["bad-annotation"]),
    ("def [[reads=positon]] f(x: block) -> bool", ["unknown-feature"]),
    ("def [[reads=position, siez]] f(x: block) -> bool", ["unknown-feature"]),
    ("def [[reads]] f(x: block) -> bool", ["bad-annotation"]),
    ("def [[reads=1]] f(x: block) -> bool", ["bad-annotation"]),
    ("def [[reads=position]] f(x: block) -> bool:\n  return clear(x)", ["bad-annotation"]),
    ("feature [[reads=position]] f(x: block)", ["bad-annotation"]),
    ("behavior [[max_nested=0]] r(x: block):\n  goal: clear(x)", ["bad-annotation"]),
    ("behavior [[max_nested=1.5]] r(x: block):\n  goal: clear(x)", ["bad-annotation"]),
    ("behavior [[max_nested]] r(x: block):\n  goal: clear(x)", ["bad-annotation"]),
    ("feature [[max_nested=1]] f()", ["bad-annotation"]),
    ("feature [[pddl=on_table]] f()", ["bad-annotation"]),
    ("feature [[pddl=1]] f()", ["bad-annotation"]),
    ("feature [[colour]] f()", ["unknown-annotation"]),
    ("feature [[colour=red]] f()", ["unknown-annotation"]),
    ("feature [[mim=0]] f() -> int32", ["unknown-annotation"]),
    ("behavior r(x: block):\n  body:\n    [[slow]] achieve clear(x)", ["unknown-annotation"]),
    ("behavior r(x: block):\n  body:\n    [[max_nested=1]] achieve clear(x)", ["bad-annotation"]),
]  # fmt: skip


@pytest.mark.parametrize(("text", "expected"), TYPES)
def test_types(text: str, expected: list[str]) -> None:
    assert codes(f"{text}\n") == expected


@pytest.mark.parametrize(("text", "expected"), [*VALUES, *SECTIONS, *ANNOTATIONS])
def test_definitions(text: str, expected: list[str]) -> None:
    assert codes(f"{text}\n", PRELUDE) == expected


@pytest.mark.parametrize(("text", "expected"), GOALS)
def test_goals(text: str, expected: list[str]) -> None:
    header = "behavior r(x: block, p: Pose):\n"
    body = "  body:\n    let _x = x\n    let _p = p\n"
    assert codes(f"{header}  goal: {text}\n{body}", PRELUDE) == expected


def test_annotations_are_kept() -> None:
    text = """typedef [[tolerance=0.5]] T: float32
feature [[min=0, max=20]] [[colour=red]] f(x: block) -> int32
def [[reads=position, size]] g(x: block) -> bool
object_constant [[pddl="a-b"]] a: block
"""
    checked = program(text, PRELUDE)
    definitions = (checked.types[-1], checked.features[-1], checked.functions[-1])
    kept = [[(a.name, a.value) for a in d.annotations] for d in definitions]
    assert kept == [
        [("tolerance", 0.5)],
        [("min", 0), ("max", 20), ("colour", ("red",))],
        [("reads", ("position", "size"))],
    ]
    assert checked.constants[-1].annotations[0].value == "a-b"


def test_the_order_of_definitions_does_not_matter() -> None:
    text = """behavior r(x: thing):
  goal: f(x)
  body: c(x)
controller c(x: thing)
feature f(x: thing)
typedef thing: base
typedef base
"""
    assert codes(text) == []


def test_a_duplicate_shows_both_places() -> None:
    (duplicate,) = diagnose("feature f()\ncontroller f()\n")
    assert duplicate.location.line == 2
    assert duplicate.labels()[0].location.line == 1


@pytest.mark.parametrize(
    "text",
    [
        "feature f(x: nowhere)\nbehavior r(x: block):\n  goal: f(x)\n  eff: f[x] = True\n",
        "feature f() -> nowhere\nbehavior r():\n  body:\n    assert f() == 1 and f()\n",
        "controller c(x: nowhere)\nbehavior r(x: block):\n  body:\n    c(x)\n    c(1)\n",
        "def f(x: nowhere) -> float32:\n  return x + 1\n",
        "behavior r(x: nowhere):\n  goal: clear(x)\n  body:\n    assert x == 1 and x\n",
        "behavior r(x):\n  goal: nothing(x)\n",
        "typedef T: nowhere\nfeature f(x: T)\nbehavior r(x: T):\n  goal: f(x)\n",
        "object_constant a: nowhere\nbehavior r():\n  body:\n    assert clear(a) and a == 1\n",
        "feature f(x: Pose)\nbehavior r(p: Pose):\n  body:\n    assert f(p) and f(1)\n",
    ],
)
def test_one_mistake_gives_one_message(text: str) -> None:
    assert len(codes(text, PRELUDE)) == 1
