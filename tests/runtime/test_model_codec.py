"""Hoare models as JSON and back: shared parts once, damage refused with its path."""

import json
from contextlib import suppress
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from programs import program_of

from cdlc.ir.hoare import Model
from cdlc.ir.model import carried
from crow.program.codec import ProgramFormatError
from crow.program.model_codec import decode_model, decode_model_part, encode_model
from crow.program.triples import HoareModel

DOMAIN = """
typedef T
feature p(x: T)
feature f(x: T) -> int64
controller go(x: T, n: int64)
controller put(x: T)
behavior act(x: T, y: T):
  goal: p(x)
  body:
    assert p(y) and f(x) > 2
    bind z: T where: not p(z)
    do go(z, f(x) + 1)
  eff:
    for i in range(40):
      if f(x) > i: f[x] -= 1
    foreach w: T:
      if f(w) > 0: p[y] = p(w)
    p[x] = True
behavior late(x: T):
  goal: p(x)
  body:
    do put(x)
    achieve p(x)
  eff: pass
"""


def document() -> Any:
    """Through real JSON, so that tuples have become lists."""
    return json.loads(json.dumps(encode_model(carried(Model(program_of(DOMAIN))))))


def test_the_round_trip_is_the_identity() -> None:
    again = decode_model_part(document())
    assert json.loads(json.dumps(encode_model(again))) == document()
    (triple,) = again.triples
    assert [p.name for p in triple.parameters] == ["x", "y", "z"]
    assert triple.conflicts
    assert [m.behavior for m in again.unmodelled] == ["late"]
    assert len(triple.reasons) == len(triple.pre) == 3


def test_shared_parts_are_one_object() -> None:
    """The tree of this formula has more than 2**40 leaves."""
    again = decode_model_part(document())
    update = next(u for u in again.triples[0].post if u.feature == "f")
    seen: set[int] = set()
    pending: list[Any] = [update.value]
    while pending:
        node = pending.pop()
        if id(node) not in seen:
            seen.add(id(node))
            names = ("condition", "then", "otherwise", "left", "right")
            pending += [getattr(node, name) for name in names if hasattr(node, name)]
    assert 100 < len(seen) <= len(document()["nodes"]) < 200


def test_a_program_without_a_model_has_none() -> None:
    assert decode_model({"version": 1, "program": {}}) is None
    with pytest.raises(ProgramFormatError, match="version 2"):
        decode_model({"version": 2, "model": document()})
    found = decode_model({"version": 1, "model": document()})
    assert isinstance(found, HoareModel)


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ((), None, "no table of `nodes`"),
        (("nodes",), {}, "no table of `nodes`"),
        (("nodes", 0), 5, r"nodes\[0\]: expected an expression"),
        (("nodes", 0, "node"), "Assign", r"nodes\[0\]: expected an expression"),
        (("nodes", 0, "node"), [], r"nodes\[0\]: expected an expression"),
        (("nodes", 0, "typo"), 1, "has no field `typo`"),
        (("level",), 3, "model.level: expected `str`, found 3"),
        (("triples",), {}, "model.triples: expected a list"),
        (("triples", 0, "pre"), 4, r"triples\[0\].pre: expected a list"),
        (("triples", 0, "pre", 0), 100_000, "no node 100000 before this one"),
        (("triples", 0, "pre", 0), -1, "no node -1"),
        (("triples", 0, "pre", 0), True, "no node True"),
        (("triples", 0, "pre", 0), {"node": "Read"}, "no node"),
        (("triples", 0, "post", 0), 1, "expected an object"),
        (("triples", 0, "post", 0, "sources"), [[1]], "expected"),
        (("triples", 0, "limited"), ["a"], "expected `int`"),
        (("triples", 0, "goal"), "x", "no node 'x'"),
    ],
)
def test_damage_is_refused(path: tuple[str | int, ...], value: object, message: str) -> None:
    damaged: Any = document()
    if not path:
        damaged = value
    else:
        inner = damaged
        for step in path[:-1]:
            inner = inner[step]
        inner[path[-1]] = value
    with pytest.raises(ProgramFormatError, match=message):
        decode_model_part(damaged)


def test_a_node_cannot_be_part_of_itself() -> None:
    damaged = document()
    index = next(i for i, n in enumerate(damaged["nodes"]) if n["node"] == "Arithmetic")
    damaged["nodes"][index]["left"] = index
    with pytest.raises(ProgramFormatError, match=f"no node {index} before this one"):
        decode_model_part(damaged)


DOCUMENT = document()
VALUES = st.one_of(
    st.none(), st.booleans(), st.integers(), st.text(), st.lists(st.integers(), max_size=2)
)


@given(st.randoms(use_true_random=False), VALUES)
def test_any_damage_is_refused_or_read(chance: Any, value: object) -> None:
    """A value anywhere in the document is changed."""
    damaged = json.loads(json.dumps(DOCUMENT))
    inner, parent, key = damaged, None, None
    while isinstance(inner, dict | list) and inner and (parent is None or chance.random() < 0.9):
        key = chance.choice(list(inner) if isinstance(inner, dict) else range(len(inner)))
        parent, inner = inner, inner[key]
    assert parent is not None
    parent[key] = value
    with suppress(ProgramFormatError):
        decode_model_part(damaged)
