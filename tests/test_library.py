"""`import cdlc` as scripts use it: what a condition needs before a behavior."""

from pathlib import Path

import pytest
from support import BLOCKS

import cdlc
from cdlc.ir.text import sexpr

ALTERNATIVES = """
typedef T
feature p(x: T)
feature n() -> int64
controller up():
  eff: n[...] += 1
controller down():
  eff: n[...] -= 1
behavior act(x: T):
  goal: p(x)
  body:
    alternative:
      do up()
      do down()
  eff: p[x] = n(...) > 0
"""


def written(expression: object) -> str:
    return sexpr(expression, {"x": "x", "y": "y"})  # type: ignore[arg-type]


def test_the_weakest_precondition_of_a_condition_as_text() -> None:
    compiled = cdlc.compile(BLOCKS / "blocks.cdl")
    assert written(compiled.weakest_precondition("r_on", "on(x, y)")) == "true"
    assert written(compiled.weakest_precondition("r_on", "clear(y)")) != "true"
    kept = compiled.weakest_precondition("r_on", "exists z: block: on_table(z)")
    assert written(kept) == "(exists (?b - block) (on_table ?b))"


def test_it_is_enough_whichever_way_the_body_goes(tmp_path: Path) -> None:
    file = tmp_path / "act.cdl"
    file.write_text(ALTERNATIVES)
    weakest = cdlc.compile(file).weakest_precondition("act", "p(x)")
    assert written(weakest) == "(and (> (n) -1) (> (n) 1))"


def test_wrong_names_and_conditions_are_said() -> None:
    compiled = cdlc.compile(BLOCKS / "blocks.cdl")
    with pytest.raises(KeyError, match="r_onn"):
        compiled.weakest_precondition("r_onn", "on(x, y)")
    for text in ("on(x)", "on(x, unknown)", "on(x, y", "", "x"):
        with pytest.raises(ValueError, match=r"^`"):
            compiled.weakest_precondition("r_on", text)
