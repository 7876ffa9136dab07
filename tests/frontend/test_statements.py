"""Statements: where they may stand and what they may hold (language.md §3 and §5)."""

import pytest
from cases import PRELUDE, body, codes, diagnose, effect

BODIES = [
    ("achieve clear(x)", []),
    ("achieve_once clear(x)", []),
    ("assert clear(x)", []),
    ("assert clear(x); achieve clear(y)", []),
    ("do pick(x)", []),
    ("pick(x)", []),
    ("commit", []),
    ("pass", []),
    ("do clear(x)", ["wrong-kind"]),
    ("number(x)", ["wrong-kind"]),
    ("do nothing(x)", ["unknown-command"]),
    ("do pick(position(x))", ["wrong-argument-type"]),
    ("do pick(x, y)", ["wrong-argument-count"]),
    ("clear[x] = True", ["misplaced-statement"]),
    ("count = 1", ["misplaced-statement"]),
    ("return 1", ["misplaced-statement"]),
    ("for i in range(2):\n  break", ["misplaced-statement"]),
    ("sequential:\n  achieve clear(x)\n  unordered:\n    achieve clear(y)", []),
    ("alternative:\n  achieve clear(x)\n  achieve clear(y)", []),
    ("foreach z: block:\n  achieve clear(z)\n  commit", []),
    ("forall z: block:\n  achieve clear(z)", []),
    ("for each z: block:\n  achieve clear(z)", []),
    ("foreach z, w: block:\n  achieve on(z, w)", []),
    ("foreach p: Pose:\n  achieve clear(x)", ["not-an-object-type"]),
    ("for i in range(3):\n  do pick(x)", []),
    ("if clear(x):\n  do pick(x)\nelif clear(y):\n  do pick(y)\nelse:\n  pass", []),
    ("if count:\n  pass", ["wrong-type"]),
    ("while clear(x):\n  do pick(x)", ["while-loop"]),
    ("n = 1", ["unknown-feature"]),
    ("x = y", ["not-assignable"]),
    ("let n = 1\nn = 2", ["unused-variable"]),
    ("let n = 1\nfor i in range(n):\n  do pick(x)", ["range-not-constant"]),
]
BINDS = [
    ("bind z: block\ndo pick(z)", []),
    ("bind z: block where: on(x, z)\ndo pick(z)", []),
    ("bind z: block: on(x, z)\ndo pick(z)", []),
    ("bind z: block:\n  on(x, z)\ndo pick(z)", []),
    ("bind z: block where:\n  on(x, z)\ndo pick(z)", []),
    ("bind z, w: block where: on(z, w)\ndo pick(z)", []),
    ("bind z: block, p: Pose where: near(position(z), p)\ndo go(p)", []),
    ("bind p: Pose = middle(position(x), position(y))\ndo go(p)", []),
    ("bind p: Pose = near(position(x), p)\ndo go(p)", []),
    ("bind p = near(position(x), p)\ndo go(p)", []),
    ("bind p: near(position(x), p)\ndo go(p)", []),
    ("bind p = middle(position(x), position(y))\ndo go(p)", []),
    ("bind z = on(x, z)\ndo pick(z)", []),
    ("bind p, q = near(p, q)\ndo go(p)", []),
    ("bind p: Pose; assert near(position(x), p)\ndo go(p)", []),
    ("bind p: middle(position(x), position(y))", ["missing-type"]),
    ("bind p: middle(p, position(y))\ndo go(p)", ["wrong-type"]),
    ("bind p", ["missing-type"]),
    ("bind p: Pose where: middle(p, p)\ndo go(p)", ["wrong-type"]),
    ("bind p: Pose = extent(x)\ndo go(p)", ["wrong-type"]),
    ("bind p: nowhere where: near(p, p)\ndo go(p)", ["unknown-type"]),
    ("bind z: block where: unknown(z)\ndo pick(z)", ["unknown-feature"]),
    ("bind x: block where: clear(x)\ndo pick(x)", ["shadowing"]),
    ("bind clear: block\ndo pick(clear)", ["hides-definition"]),
    ("bind z: block", ["unused-variable"]),
    ("bind _z: block", []),
]
LETS = [
    ("let n = 1\nassert n > 0", []),
    ("let n: float32 = 1\nassert n > 0", []),
    ("let p: Pose = [1, 2]\ndo go(p)", []),
    ("let p = position(x)\nlet q: Pose = p\ndo go(q)", []),
    ("let n: int64 = 1.5\nassert n > 0", ["wrong-type"]),
    ("let n: bool = 1\nassert n", ["wrong-type"]),
    ("let p: Pose = extent(x)\ndo go(p)", ["wrong-type"]),
    ("let n: nowhere = 1\nassert n > 0", ["unknown-type"]),
    ("let n = unknown\nassert n > 0 and clear(n)", ["unknown-name"]),
    ("let x = y\ndo pick(x)", ["shadowing"]),
    ("let n = 1\nlet n = 2\nassert n > 0", ["shadowing"]),
    ("let ns: int64[] = [1, 2]\nassert ns == [1, 2]", []),
    ("let bs: block[] = [x, y]\nassert bs == [x, y]", []),
    ("let n = 1", ["unused-variable"]),
]
EFFECTS = [
    ("clear[x] = True", []),
    ("on[x, y] = not on(y, x)", []),
    ("count = 1", []),
    ("count[...] = 1", []),
    ("count += 1", []),
    ("size[x] *= 2", []),
    ("size[x] /= 2", []),
    ("position[x] += [1, 0]", []),
    ("position[x] *= 2", []),
    ("at[x] = table", []),
    ("level[x] = 2147483647", []),
    ("level[x] = -2147483648", []),
    ("clear(x) = True", ["call-for-index"]),
    ("clear[x] = 1", ["wrong-type"]),
    ("count = 1.5", ["wrong-type"]),
    ("count = True", ["wrong-type"]),
    ("level[x] = 2147483648", ["number-too-large"]),
    ("level[x] += 1.5", ["wrong-type"]),
    ("level[x] /= 2", ["wrong-type"]),
    ("clear[x] += 1", ["wrong-type"]),
    ("at[x] += 1", ["wrong-type"]),
    ("position[x] *= position(y)", ["wrong-type"]),
    ("position[x] = extent(y)", ["wrong-type"]),
    ("at[x] = y", ["wrong-type"]),
    ("clear[1] = True", ["value-index"]),
    ("size[count] = 1", ["value-index"]),
    ("number[x] = 1", ["not-assignable"]),
    ("claer[x] = True", ["unknown-feature"]),
    ("x = y", ["not-assignable"]),
    ("on[x] = True", ["wrong-argument-count"]),
    ("clear = True", ["wrong-argument-count"]),
    ("achieve clear(x)", ["misplaced-statement"]),
    ("bind z: block", ["misplaced-statement"]),
    ("do pick(x)", ["misplaced-statement"]),
    ("commit", ["misplaced-statement"]),
    ("let n = 1\nn += 1\ncount = n", []),
    ("let n = 1\nn /= 2\ncount = n", ["wrong-type"]),
    ("let c = True\nc += 1\nclear[x] = c", ["wrong-type"]),
    ("let n = 1\nn = 1.5\ncount = n", ["wrong-type"]),
    ("for i in range(3):\n  if count > i:\n    break\n  count -= 1", []),
    ("for i in range(3):\n  if count > i:\n    continue\n  count -= 1", []),
    ("break", ["outside-loop"]),
    ("foreach z: block:\n  break", ["outside-loop"]),
    ("for i in range(2):\n  foreach z: block:\n    break", ["outside-loop"]),
    ("foreach z: block:\n  for i in range(2):\n    break", []),
    ("for i in range(2):\n  i = 1", ["not-assignable"]),
    ("let n = 1\nforeach z: block:\n  n = 2\ncount = n", ["outer-local"]),
    ("foreach z: block:\n  let n = 1\n  n = 2\n  level[z] = n", []),
]
FOREACH = [
    ("foreach z: block:\n  clear[z] = True", []),
    ("foreach z: block:\n  clear[x] = True", []),
    ("foreach z: block:\n  level[z] += 1", []),
    ("foreach z, w: block:\n  on[z, w] = clear(z)", []),
    ("foreach z: block:\n  foreach w: block:\n    on[z, w] = z == w", []),
    ("foreach z: block:\n  if on(z, x):\n    size[x] = size(z)", []),
    ("foreach z: block:\n  let n = size(z)\n  size[z] = n", []),
    ("foreach z: block:\n  let n = size(x)\n  size[y] = n", []),
    ("foreach z: block:\n  at[z] = at(x)", []),
    ("foreach z: block:\n  for i in range(3):\n    level[z] += i", []),
    ("foreach z: block:\n  count += 1", ["write-conflict"]),
    ("foreach z: block:\n  if clear(z):\n    count += 1", ["write-conflict"]),
    ("foreach z: place:\n  at[x] = z", ["write-conflict"]),
    ("foreach w: block:\n  foreach z: place:\n    at[w] = z", ["write-conflict"]),
    ("foreach w: block, z: place:\n  at[w] = z", ["write-conflict"]),
    ("foreach z: block:\n  for i in range(3):\n    count += i", ["write-conflict"]),
    ("foreach z: block:\n  size[x] = size(z)", ["possible-write-conflict"]),
    ("foreach z: block:\n  let n = size(z)\n  size[x] = n", ["possible-write-conflict"]),
    ("foreach z, w: block:\n  clear[z] = on(z, w)", ["possible-write-conflict"]),
    ("foreach z: block:\n  let n = 0.0\n  if clear(z):\n    n = 1.0\n  size[x] = n",
     ["possible-write-conflict"]),
]  # fmt: skip
RANGES = [
    ("range(10)", []),
    ("range(2, 10)", []),
    ("range(10, 2, -1)", []),
    ("range(-3)", []),
    ("range(2 ** 10 // 3 - 1)", []),
    ("range(7 % 4, 2 * 5)", []),
    ("range(min(3, 4), max(2, 9))", []),
    ("range(abs(-3))", []),
    ("range(10000)", []),
    ("range(10001)", ["unroll-limit"]),
    ("range(10 ** 12)", ["unroll-limit"]),
    ("range(0, 10 ** 12, 10 ** 11)", []),
    ("range(10 ** 10 ** 10)", ["range-not-constant"]),
    ("range(10 ** 10 ** 10 ** 10)", ["range-not-constant"]),
    ("range(1 ** 10 ** 9)", []),
    ("range(2 ** -1)", ["range-not-constant"]),
    ("range(1 // 0)", ["range-not-constant"]),
    ("range(1 % 0)", ["range-not-constant"]),
    ("range(4 / 2)", ["range-not-constant"]),
    ("range(1.5)", ["range-not-constant"]),
    ("range(True)", ["range-not-constant"]),
    ("range(count)", ["range-not-constant"]),
    ("range(level(x) + 1)", ["range-not-constant"]),
    ("range(unknown)", ["unknown-name"]),
    ("range()", ["wrong-argument-count"]),
    ("range(1, 2, 3, 4)", ["wrong-argument-count"]),
    ("range(1, 2, 0)", ["range-not-constant"]),
    ("rnge(3)", ["unknown-name"]),
]
FUNCTIONS = [
    ("return size(x)", []),
    ("let n = size(x)\nreturn n", []),
    ("if clear(x):\n  return 1\nelse:\n  return 2.5", []),
    ("if clear(x):\n  return 1\nreturn 2", []),
    ("for i in range(3):\n  return 1", []),
    ("for i in range(3):\n  if clear(x):\n    break\n  return 1\nreturn 2", []),
    ("foreach z: block:\n  let _n = 1\nreturn 1", []),
    ("return True", ["wrong-type"]),
    ("if clear(x):\n  return 1", ["missing-return"]),
    ("for i in range(0):\n  return 1", ["missing-return"]),
    ("for i in range(3):\n  if clear(x):\n    break\n  return 1", ["missing-return"]),
    ("let n = size(x)\nlet _m = n", ["missing-return"]),
    ("foreach z: block:\n  return 1", ["return-in-foreach"]),
    ("foreach z: block:\n  if clear(z):\n    return 1\nreturn 2", ["return-in-foreach"]),
    ("for i in range(count):\n  return 1", ["range-not-constant"]),
    ("while clear(x):\n  return 1", ["while-loop"]),
    ("clear[x] = True\nreturn 1", ["misplaced-statement"]),
    ("achieve clear(x)\nreturn 1", ["misplaced-statement"]),
    ("assert clear(x)\nreturn 1", ["misplaced-statement"]),
    ("return f(x)", ["recursive-call"]),
]
PROMOTABLE = [
    ("promotable:\n  achieve clear(x)\n  assert clear(y)", []),
    ("promotable sequential:\n  achieve clear(x)\n  pick(x)\ndo pick(y)", []),
    ("bind z: block where: on(x, z)\npromotable:\n  achieve clear(z)", []),
    ("promotable:\n  foreach z: block:\n    achieve clear(z)", []),
    ("promotable:\n  if clear(x):\n    achieve clear(y)", []),
    ("promotable:\n  do pick(x)\n  achieve clear(x)", ["not-promotable"]),
    ("promotable:\n  bind z: block where: on(x, z)\n  achieve clear(z)", ["not-promotable"]),
    ("promotable:\n  let n = 1\n  assert n > 0", ["not-promotable"]),
    ("promotable:\n  commit", ["not-promotable"]),
    ("promotable:\n  achieve clear(x)\npromotable:\n  achieve clear(y)", ["misplaced-promotable"]),
    ("unordered:\n  promotable:\n    achieve clear(x)", ["misplaced-promotable"]),
    ("promotable alternative:\n  achieve clear(x)", ["misplaced-promotable"]),
]  # fmt: skip


@pytest.mark.parametrize(("text", "expected"), [*BODIES, *BINDS, *LETS, *PROMOTABLE])
def test_bodies(text: str, expected: list[str]) -> None:
    assert body(text) == expected


@pytest.mark.parametrize(("text", "expected"), [*EFFECTS, *FOREACH])
def test_effects(text: str, expected: list[str]) -> None:
    assert effect(text) == expected


@pytest.mark.parametrize(("text", "expected"), RANGES)
def test_ranges(text: str, expected: list[str]) -> None:
    assert effect(f"for i in {text}:\n  count += i") == expected


@pytest.mark.parametrize(("text", "expected"), FUNCTIONS)
def test_functions(text: str, expected: list[str]) -> None:
    lines = "".join(f"  {line}\n" for line in text.splitlines())
    assert codes(f"def f(x: block) -> float32:\n  let _x = x\n{lines}", PRELUDE) == expected


def test_nested_loops_multiply() -> None:
    nest = "for i in range(100):\n  for j in range({}):\n    count += i * j"
    assert effect(nest.format(100)) == []
    assert effect(nest.format(101)) == ["unroll-limit"]


def test_a_nest_names_its_innermost_loop_and_shows_the_others() -> None:
    text = """behavior r():
  eff:
    for i in range(200):
      foreach z: block:
        for j in range(200):
          for k in range(200):
            level[z] += i + j + k
"""
    (limit,) = diagnose(text, PRELUDE)
    assert "`j`" in limit.message()
    assert "40,000 copies" in limit.message()
    start = PRELUDE.count("\n")
    assert limit.location.line == start + 5
    assert [label.location.line for label in limit.labels()] == [start + 3]


def test_a_write_conflict_shows_its_loop_and_a_cure() -> None:
    (conflict,) = diagnose(
        "behavior r():\n  eff:\n    foreach z: block:\n      count += 1\n", PRELUDE
    )
    assert "`count[...]`" in conflict.message()
    assert "do not add up" in conflict.help()[0].text
    assert conflict.labels()[0].location.line == conflict.location.line - 1


def test_recursion_through_behaviors_is_an_error() -> None:
    text = """behavior a(x: block):
  body:
    b(x)
behavior b(x: block):
  body:
    foreach z: block:
      if clear(z):
        c(x)
behavior c(x: block):
  body:
    promotable:
      a(x)
"""
    (recursive,) = diagnose(text, PRELUDE)
    assert "a → b → c → a" in recursive.message()
    assert codes("behavior a(x: block):\n  body:\n    a(x)\n", PRELUDE) == ["recursive-call"]


def test_recursion_through_achieve_is_the_idea() -> None:
    text = "behavior a(x: block):\n  goal: clear(x)\n  body:\n    achieve clear(x)\n"
    assert codes(text, PRELUDE) == []


def test_what_a_section_introduces_is_known_in_the_effect() -> None:
    text = """behavior a(x: block):
  body:
    bind y: block where: on(x, y)
    do pick(y)
  eff:
    on[x, y] = False
"""
    assert codes(text, PRELUDE) == []
