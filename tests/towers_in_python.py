"""One program twice: its functions in CDL, and in Python that reads the state."""

from typing import Any

from programs import problem_of

import crow
from crow.problem import Problem
from crow.registration import registered

DOMAIN = """
typedef block
typedef spot: vector[int32, 2]
feature on(x: block, y: block)
feature holding(x: block)
feature place(x: block) -> spot
feature spent() -> int32
{functions}
controller pick(x: block, cost: int32)
controller drop(x: block, where: spot):
  eff:
    holding[x] = False
    place[x] = where
controller stack(x: block, y: block)
behavior r_holding(x: block):
  goal: holding(x)
  body:
    promotable:
      achieve clear(x)
    achieve handempty()
    do pick(x, price(x))
  eff:
    foreach y: block:
      on[x, y] = False
    holding[x] = True
    spent += price(x)
behavior r_clear(x: block):
  goal: clear(x)
  body:
    bind y: block where: on(y, x)
    achieve holding(y)
    do drop(y, beside(place(x)))
behavior r_handempty():
  goal: handempty()
  body:
    bind x: block where: holding(x)
    do drop(x, beside(place(x)))
behavior r_on(x: block, y: block):
  goal: on(x, y)
  body:
    assert x != y and price(x) <= 2 * price(y)
    promotable:
      achieve holding(x)
      achieve clear(y)
    do stack(x, y)
  eff:
    on[x, y] = True
    holding[x] = False
    place[x] = place(y)
"""

IN_CDL = """
def clear(x: block) -> bool:
  return not holding(x) and (forall y: block: not on(y, x))
def handempty() -> bool:
  return forall x: block: not holding(x)
def price(x: block) -> int32:
  return 2 if x == A else 1
def beside(s: spot) -> spot:
  return s + [1, 0]
object_constant A: block
"""

OUTSIDE = """
def [[reads=on, holding]] clear(x: block) -> bool
def [[reads=holding]] handempty() -> bool
def price(x: block) -> int32
def beside(s: spot) -> spot
object_constant A: block
"""

READING_ALL = OUTSIDE.replace("reads=on, holding", "reads=all").replace("=holding", "=all")

PROBLEM = """
problem "p"
objects:
  B, C: block
init:
  {init}
  foreach x: block: place[x] = [0, 0]
goal: {goal}
"""


@crow.function
def clear(state: Any, x: str) -> bool:
    above = [lower for _, lower in state.cells("on")]
    return x not in above and not state.holding(x)


@crow.function
def handempty(state: Any) -> bool:
    return not any(state["holding", x] for x in state.objects("block"))


@crow.function("price")
def price_of(x: str) -> int:
    return 2 if x == "A" else 1


@crow.function
def beside(spot: tuple[int, int]) -> list[int]:
    return [spot[0] + 1, spot[1]]


PYTHON = {"clear": clear, "handempty": handempty, "price": price_of, "beside": beside}


def towers(functions: str, init: str, goal: str, python: Any = None) -> Problem:
    """A problem of blocks by one of the texts of functions."""
    problem = problem_of(DOMAIN.format(functions=functions), PROBLEM.format(init=init, goal=goal))
    return with_python(problem, python)


def with_python(problem: Problem, python: Any) -> Problem:
    """A problem whose program has functions in Python."""
    from dataclasses import replace

    given = registered(problem.world.program, python)
    return problem.changed(world=replace(problem.world, registered=given))
