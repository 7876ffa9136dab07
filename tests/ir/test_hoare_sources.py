"""Which statements each part of a triple comes from."""

from textwrap import dedent, indent

import pytest
from programs import program_of

from cdlc.ir.hoare import Model
from cdlc.ir.nodes import Level
from cdlc.ir.updates import MAX_SOURCES, merged
from crow.program import Location
from crow.program.triples import Triple

DECLARATIONS = """
typedef T
feature p(x: T)
feature q(x: T)
feature f(x: T) -> int64
controller make(x: T):
  eff: p[x] = True
controller raise_by(x: T, by: int64):
  eff: f[x] += by
"""
BODY = len(DECLARATIONS.splitlines()) + 3


def model_of(eff: str, body: str = "pass", level: Level = Level.BASIC) -> Triple:
    """The triple of a behavior whose body starts at line BODY, its effect one line after it."""
    text = f"{DECLARATIONS}behavior act(x: T, y: T):\n  body:\n"
    text += indent(dedent(body), "    ") + "\n  eff:\n" + indent(dedent(eff), "    ") + "\n"
    program = program_of(text)
    (triple,) = Model(program, level).triples(program.behaviors[0])
    return triple


def lines(sources: tuple[Location, ...], first: int) -> list[int]:
    """Lines of places, counted from 0 at the first of a section; those before it as they are."""
    return [place.line - first if place.line >= first else -place.line for place in sources]


MAKE, RAISE = -7, -9


@pytest.mark.parametrize(
    ("eff", "expected"),
    [
        ("f[x] = 1\nf[x] = 2", [[1]]),
        ("f[x] = 1\nf[x] += 2", [[0, 1]]),
        ("f[x] = 1\nf[x] = f(x) + 2", [[0, 1]]),
        ("f[x] = 1\nf[y] = f(x)", [[0], [0, 1]]),
        ("f[x] = 1\nf[y] = 2", [[0], [1]]),
        ("if p(x):\n  f[x] = 1\nelse:\n  f[x] = 2", [[1, 3]]),
        ("f[x] = 0\nif p(x): f[x] = 1", [[0, 1]]),
        ("if p(x): f[x] = 1\nf[x] = 2", [[1]]),
        ("if p(x): f[x] = 1\nif p(y): f[x] = 2", [[0, 1]]),
        ("for i in range(3):\n  if f(x) > 0:\n    f[x] -= 1\n  else:\n    break", [[2]]),
        ("for i in range(3):\n  if f(x) == i:\n    f[x] = 7\n    continue\n  f[x] += 1", [[2, 4]]),
        ("foreach z: T: p[z] = q(z)", [[0]]),
        ("foreach z: T:\n  if q(z): p[z] = True\n  else: p[z] = False", [[1, 2]]),
        ("p[y] = q(x)\nforeach z: T: p[z] = not p(z)", [[0], [0, 1]]),
        ("if q(x):\n  p[x] = True\n  p[y] = False\nelse:\n  p[y] = True", [[1, 2], [2, 4]]),
        ("let k = f(x)\nf[y] = k", [[1]]),
        ("if False: f[x] = 1\nf[y] = 2", [[1]]),
    ],
)
@pytest.mark.parametrize("level", Level)
def test_updates(eff: str, expected: list[list[int]], level: Level) -> None:
    triple = model_of(eff, level=level)
    assert [lines(update.sources, BODY + 2) for update in triple.post] == expected


def test_effects_of_controllers() -> None:
    triple = model_of("f[x] -= 1", "do make(y)\ndo raise_by(x, 2)")
    assert [lines(update.sources, BODY + 3) for update in triple.post] == [[MAKE], [RAISE, 0]]


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("assert p(x)\nassert q(x)", [[0], [1]]),
        ("assert p(x) and q(x)\nachieve p(x)", [[0, 1], [0]]),
        ("assert p(x)\nassert not p(x)", [[0, 1]]),
        ("bind z: T where: p(z) and q(z)", [[0], [0]]),
        ("if p(x):\n  assert q(x)\nelse:\n  assert q(y)", [[1], [3]]),
        ("foreach z: T:\n  achieve p(z)\n  achieve q(z)", [[1, 2]]),
        ("for i in range(2):\n  assert f(x) > i", [[1], [1]]),
        ("do make(x)\nassert p(y) or q(y)", [[1]]),
        ("do make(x)\nassert p(x)", []),
    ],
)
def test_conjuncts(body: str, expected: list[list[int]]) -> None:
    triple = model_of("pass", body)
    assert [lines(sources, BODY) for sources in triple.reasons] == expected


def test_very_many_statements_are_not_told_apart() -> None:
    eff = "\n".join(f"if f(y) > {i}: f[x] = {i}" for i in range(3 * MAX_SOURCES))
    (update,) = model_of(eff).post
    assert lines(update.sources, BODY + 2) == list(range(MAX_SOURCES + 1))


def test_merging_keeps_source_order_and_each_place_once() -> None:
    first, second = Location("a", 1, 1, 1, 2), Location("a", 2, 1, 2, 2)
    assert merged((second,), (first,)) == (first, second)
    assert merged((first, second), (second,)) == (first, second)
    assert merged((), (first,), ()) == (first,)
    assert merged() == ()
