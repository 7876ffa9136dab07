"""Values that complete generators yield plan like objects of which the same is known.

Each program stands twice: over numbers, with functions and generators in Python, and over objects,
with the same relations as features. Both have the same plans, in all orders, without pruning. The
behavior that binds is a method: what it asserts of objects would be held in one with an effect, and
what it asserts of values not (semantics.md §2).
"""

from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import hypothesis.strategies as st
import pytest
from hypothesis import given

import cdlc
import crow
from crow.search.engine import CrowEngine

SPOTS = (1, 2, 3)
BESIDE = {(1, 2), (2, 1), (2, 3), (3, 2)}

STATEMENTS = (
    "assert is_free(p)",
    "assert is_free(q)",
    "assert p != q",
    "assert not beside(p, q)",
    "achieve pos(o) == p",
    "achieve pos(o) == q",
    "do go(o, p)",
    "do go(o, q)",
    "if is_free(q): achieve pos(o) == q\n    else: do go(o, p)",
    "foreach x: Thing: assert pos(x) != q",
    "alternative:\n      achieve pos(o) == q\n      do go(o, p)",
)
MEMBERS = STATEMENTS[:6]

HEAD = """
typedef Thing
{declarations}
feature pos(o: Thing) -> {spot}
feature done(o: Thing)
controller go(o: Thing, s: {spot})
def is_free(s: {spot}) -> bool:
  return forall x: Thing: pos(x) != s
behavior mark(o: Thing):
  eff:
    done[o] = True
behavior move(o: Thing, s: {spot}):
  goal: pos(o) == s
  body:
    assert is_free(s)
    do go(o, s)
  eff:
    pos[o] = s
"""

NUMBERS = """
def shelf(s: int64) -> bool
def beside(a: int64, b: int64) -> bool
generator shelves(s):
  goal: shelf(s)
  out: s
generator neighbours(a, b):
  goal: beside(a, b)
  in: a
  out: b
"""

OBJECTS = """
typedef Spot
feature shelf(s: Spot)
feature beside(a: Spot, b: Spot)
"""


@crow.generator("shelves", complete=True)
def shelves() -> Iterator[int]:
    yield from SPOTS


@crow.generator("neighbours", complete=True)
def neighbours(a: int) -> Iterator[int]:
    yield from (b for x, b in sorted(BESIDE) if x == a)


FUNCTIONS = {
    "shelf": lambda s: s in SPOTS,
    "beside": lambda a, b: (a, b) in BESIDE,
    "shelves": shelves,
    "neighbours": neighbours,
}


@st.composite
def bodies(draw: Any) -> str:
    """The body of a behavior that binds two values."""
    lines = [
        draw(st.sampled_from(("bind p: {spot} where: shelf(p)",
                              "bind p: {spot}\n    assert shelf(p)"))),
        draw(st.sampled_from(("bind q: {spot} where: beside(p, q)",
                              "bind q: {spot} where: beside(p, q) and is_free(q)",
                              "bind q: {spot} where: shelf(q) and p != q"))),
    ]  # fmt: skip
    lines += draw(st.lists(st.sampled_from(STATEMENTS), max_size=2))
    members = draw(st.lists(st.sampled_from(MEMBERS), max_size=3))
    if members:
        lines += ["promotable:", *(f"  {member}" for member in members)]
    lines += draw(st.lists(st.sampled_from(STATEMENTS), max_size=2))
    return "\n    ".join(lines)


def plans_of(problem: crow.Problem, depth: int) -> Counter[Any]:
    """Every plan, with how often it is found; spots by their numbers."""
    engine = CrowEngine(problem, lambda _: None, prunes=False)
    found: Counter[Any] = Counter()
    for step_and_trace in engine.round(depth, 100):
        assert step_and_trace is not None
        steps, _ = step_and_trace
        found[tuple((s.controller, tuple(map(number, s.arguments))) for s in steps)] += 1
    assert engine.left_out() in ((), ("depth",))
    return found


def number(value: Any) -> Any:
    return int(value[1:]) if isinstance(value, str) and value[:1] == "s" else value


def problems(body: str) -> tuple[crow.Problem, crow.Problem]:
    """The program over numbers, and over objects."""
    finish = f"\nbehavior finish(o: Thing):\n  goal: done(o)\n  body:\n    {body}\n    mark(o)\n"
    with TemporaryDirectory() as folder:
        file = Path(folder) / "domain.cdl"
        file.write_text((HEAD + finish).format(declarations=NUMBERS, spot="int64"))
        numbers = cdlc.load(file, functions=FUNCTIONS)
        file.write_text((HEAD + finish).format(declarations=OBJECTS, spot="Spot"))
        objects = cdlc.load(file)
    things = {"a": "Thing", "b": "Thing"}
    spots = {f"s{n}": "Spot" for n in SPOTS}
    relations = {f"shelf({s})": True for s in spots}
    relations |= {f"beside(s{a}, s{b})": True for a, b in BESIDE}
    at = {"pos(a)": "s1", "pos(b)": "s3"}
    return (
        crow.Problem(numbers, things, {"pos(a)": 1, "pos(b)": 3}, "done(a)"),
        crow.Problem(objects, things | spots, relations | at, "done(a)"),
    )


@given(bodies())
def test_values_plan_like_objects(body: str) -> None:
    numbers, objects = problems(body)
    assert set(plans_of(numbers, 2)) == set(plans_of(objects, 2))


@pytest.mark.parametrize(
    "body",
    [
        "bind p: {spot} where: shelf(p)\n    bind q: {spot} where: beside(p, q)\n    do go(o, q)",
        "bind p, q: {spot}\n    assert beside(p, q)\n    assert shelf(p)\n    do go(o, q)",
    ],
)
def test_each_value_is_a_plan_of_its_own(body: str) -> None:
    numbers, objects = problems(body)
    found = plans_of(numbers, 2)
    assert len(found) > 1
    assert found.keys() == plans_of(objects, 2).keys()
