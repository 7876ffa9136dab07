"""Bounds in the Hoare model: `pre` excludes just the transitions that would leave them."""

from itertools import product

import pytest
from programs import program_of, start

from cdlc.ir.hoare import Model
from crow.evaluate import holds
from crow.problem import State
from crow.text import expression_text
from crow.transition import apply

DOMAIN = """
typedef tank
feature full(t: tank)
feature [[min=0, max=3]] level(t: tank) -> int64
feature [[max=2]] used() -> int64
controller fill(t: tank):
  eff:
    level[t] += 2
behavior act(a: tank, b: tank):
  body:
"""
EFFECTS = {
    "a constant in range": "level[a] = 3",
    "a constant outside": "level[a] = 4",
    "a sum": "level[a] += 1",
    "two cells, perhaps one": "level[a] -= 1\nlevel[b] += 1",
    "overwritten": "level[a] = 7\nlevel[b] = 2",
    "in between outside": "level[a] += 3\nlevel[a] -= 3",
    "under a condition": "if full(a):\n  level[a] += 2\nelse:\n  used += 2",
    "for all": "foreach t: tank:\n  if not full(t):\n    level[t] += 1",
    "for all after one": "level[a] -= 1\nforeach t: tank:\n  if full(t):\n    level[t] = 1",
    "one after for all": "foreach t: tank:\n  level[t] = 9\nlevel[a] = 1",
    "a value of another cell": "level[a] = level(b) - used()",
}


def behavior(effect: str, body: str = "pass") -> str:
    lines = "\n".join(f"    {line}" for line in effect.splitlines())
    return f"{DOMAIN}    {body}\n  eff:\n{lines}\n"


@pytest.mark.parametrize("body", ["pass", "do fill(a)", "do fill(b)"])
@pytest.mark.parametrize("effect", EFFECTS.values(), ids=EFFECTS)
def test_pre_is_where_the_behavior_can_be_applied(effect: str, body: str) -> None:
    text = behavior(effect, body)
    (triple,) = Model(program_of(text)).triples(program_of(text).behaviors[0])
    world, _ = start(text, "a, b: tank")
    states = product((0, 1, 3), (0, 2, 3), (0, 1, 2), (False, True))
    for first, second, used, full in states:
        cells = {
            ("level", ("a",)): first,
            ("level", ("b",)): second,
            ("used", ()): used,
            ("full", ("a",)): full,
        }
        state = State(cells)
        for arguments in product("ab", repeat=2):
            variables = dict(zip("ab", arguments, strict=True))
            expected = apply(world, state, world.behaviors["act"], arguments).problem is None
            found = all(holds(world, state, c, variables) for c in triple.pre)
            assert found == expected, (cells, arguments)


@pytest.mark.parametrize(
    ("effect", "expected"),
    [
        ("level[a] = 3", []),
        ("level[a] = 4", ["False"]),
        ("level[a] += 1", ["level(a) <= 2"]),
        ("level[a] -= 1", ["level(a) >= 1"]),
        ("full[a] = True", []),
    ],
)
def test_only_what_can_be_left_is_demanded(effect: str, expected: list[str]) -> None:
    program = program_of(behavior(effect))
    (triple,) = Model(program).triples(program.behaviors[0])
    assert [expression_text(c) for c in triple.pre] == expected
