"""Programs as JSON: the round trip is the identity, and damaged JSON is refused with its place."""

import copy
import json
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import statement_of
from support import BLOCKS

from crow.program import Location, Node, Program
from crow.program.codec import ProgramFormatError, decode_problem, decode_program, encode

EVERYTHING = """
typedef item
typedef box: item
typedef pose: vector[float32, 2]
typedef path: vector[float32]
object_constant home: item
feature [[pddl="on-top", cost=1.5, flags]] on(x: item, y: item)
feature [[min=0, max=20]] level(x: item) -> int32
feature where(x: item) -> pose
feature label(x: item) -> string
def [[reads=on]] reachable(x: item, p: pose) -> bool
def near(x: item, y: item):
  let k = 1
  for i in range(0, 4, 2):
    if i == 2: break
    else: continue
  foreach z: item: pass
  k = k + 1
  return on(x, y) or not on(y, x) ^ on(x, x)
def distance(x: pose) -> float64
controller move(x: item, p: pose)
controller drop(x: item):
  eff:
    level[x] -= 1
behavior lift(x: item):
  goal: level(x) > 3
  body:
    bind y: item where: on(x, y)
    bind p: pose
    assert forall z: item: z == x or exists w: box: on(z, w)
    promotable sequential:
      achieve on(x, y)
      achieve_once not on(y, x)
    alternative:
      do move(x, p)
      place(x)
    commit
    if label(x) == "one": do drop(x)
    else: do drop(y)
  eff:
    where[x] = [1, -2.5]
    level[x] = min(abs(level(x) + 2 ** 3), 5 if on(x, home) else 6)
    foreach z: box: on[z, x] = True
behavior place(x: item):
  eff: pass
generator towards(x: item, p: pose):
  goal: reachable(x, p)
  in: x
  out: p
"""
PROBLEM = """
problem "everything"
objects:
  a, b: box
init:
  on[a, b] = True
goal: on(a, home) and level(a) > 1
minimize: level(a)
"""


def blocks() -> str:
    return (BLOCKS / "blocks.cdl").read_text()


def document() -> dict[str, Any]:
    return encode(*statement_of(EVERYTHING, PROBLEM))


def locations(node: Any) -> list[Location]:
    if isinstance(node, tuple):
        return [place for item in node for place in locations(item)]
    if not isinstance(node, Node | Program):
        return [node] if isinstance(node, Location) else []
    return [place for f in fields(node) for place in locations(getattr(node, f.name))]


def test_the_round_trip_is_the_identity_through_real_json() -> None:
    program, problem = statement_of(EVERYTHING, PROBLEM)
    text = json.dumps(encode(program, problem), allow_nan=False)
    again = json.loads(text)
    assert decode_program(again) == program
    assert decode_problem(again) == problem
    # Equality ignores places; they survive all the same.
    assert locations(decode_program(again)) == locations(program)
    assert len(locations(program)) > 150
    assert json.dumps(encode(decode_program(again), decode_problem(again))) == text


def test_a_program_alone_has_no_problem() -> None:
    program, _ = statement_of(EVERYTHING, PROBLEM)
    alone = encode(program)
    assert decode_program(alone) == program
    assert decode_problem(alone) is None


def test_the_examples_survive(tmp_path: Path) -> None:
    for problem in ("sussman", "towers12"):
        stated = statement_of(blocks(), (BLOCKS / f"{problem}.cdl").read_text())
        again = json.loads(json.dumps(encode(*stated)))
        assert (decode_program(again), decode_problem(again)) == stated


@pytest.mark.parametrize(
    ("damaged", "message"),
    [
        (None, "no `version`"),
        ([], "no `version`"),
        ("text", "no `version`"),
        ({}, "no `version`"),
        ({"version": 2, "program": {}}, "version 2"),
        ({"version": "1", "program": {}}, "version '1'"),
        ({"version": True, "program": {}}, "version True"),
        ({"version": 1}, "no `program`"),
        ({"version": 1, "program": None}, "program: expected `Program`, found None"),
        ({"version": 1, "program": {"node": "Program"}}, "program: `Program` without `name`"),
        ({"version": 1, "program": {"node": "Read"}}, "program: expected `Program`"),
        ({"version": 1, "program": {"node": []}}, "program: expected `Program`"),
        (
            {"version": 1, "program": {"node": "Program", "name": "p", "typo": 1}},
            "`Program` has no field `typo`",
        ),
        (
            {"version": 1, "program": {"node": "Program", "name": 3}},
            "program.name: expected `str`, found 3",
        ),
        (
            {"version": 1, "program": {"node": "Program", "name": "p", "types": {}}},
            "program.types: expected a list",
        ),
    ],
)
def test_what_is_no_program_is_refused(damaged: object, message: str) -> None:
    with pytest.raises(ProgramFormatError) as raised:
        decode_program(damaged)
    assert message in str(raised.value)


def test_damage_is_named_with_its_path() -> None:
    damaged = document()
    behavior = damaged["program"]["behaviors"][0]
    behavior["left"][0]["condition"]["arguments"][0]["type"] = {"node": "Primitive"}
    with pytest.raises(ProgramFormatError) as raised:
        decode_program(damaged)
    path = "program.behaviors[0].left[0].condition.arguments[0].type"
    assert str(raised.value) == f"{path}: `Primitive` without `name`"


@pytest.mark.parametrize(
    "place", [["f", 1, 1, 1], ["f", True, 1, 1, 1], ["f", 0, 1, 1, 1], [1, 1, 1, 1, 1], "f:1:1"]
)
def test_damaged_places_are_refused(place: object) -> None:
    damaged = document()
    damaged["program"]["features"][0]["location"] = place
    with pytest.raises(ProgramFormatError, match=r"features\[0\].location: expected \[file"):
        decode_program(damaged)


def test_a_wrong_value_where_only_a_list_or_nothing_may_stand() -> None:
    damaged = document()
    damaged["program"]["controllers"][0]["effect"] = 5
    with pytest.raises(ProgramFormatError, match="effect: expected a list, found 5"):
        decode_program(damaged)


def test_deep_nesting_is_refused() -> None:
    damaged = document()
    goal: Any = damaged["program"]["behaviors"][0]["goal"]
    for _ in range(20_000):
        goal = {"node": "Not", "operand": goal}
    damaged["program"]["behaviors"][0]["goal"] = goal
    with pytest.raises(ProgramFormatError, match="nested too deeply"):
        decode_program(damaged)


DOCUMENT = document()


def paths(value: Any, here: tuple[str | int, ...] = ()) -> list[tuple[str | int, ...]]:
    found = [here]
    if isinstance(value, dict):
        found += [p for key, item in value.items() for p in paths(item, (*here, key))]
    elif isinstance(value, list):
        found += [p for i, item in enumerate(value) for p in paths(item, (*here, i))]
    return found


PATHS = [path for path in paths(DOCUMENT) if path]
JSON = st.recursive(
    st.one_of(
        st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=5),
        st.sampled_from(["Read", "And", "Quantified", "Location", "Primitive"]),
    ),
    lambda inner: st.one_of(
        st.lists(inner, max_size=3),
        st.dictionaries(st.sampled_from(["node", "type", "name", "x"]), inner, max_size=3),
    ),
    max_leaves=5,
)  # fmt: skip


@given(st.sampled_from(PATHS), st.sampled_from(["replace", "delete", "copy"]), JSON, st.data())
@settings(max_examples=150, deadline=None)
def test_no_damage_raises_anything_else(
    path: tuple[str | int, ...], how: str, value: Any, data: st.DataObject
) -> None:
    damaged = copy.deepcopy(DOCUMENT)
    holder: Any = damaged
    for step in path[:-1]:
        holder = holder[step]
    if how == "delete":
        del holder[path[-1]]
    elif how == "copy":
        other: Any = DOCUMENT
        for step in data.draw(st.sampled_from(PATHS)):
            other = other[step]
        holder[path[-1]] = copy.deepcopy(other)
    else:
        holder[path[-1]] = value
    for decode in (decode_program, decode_problem):
        try:
            decode(damaged)
        except ProgramFormatError:
            continue
