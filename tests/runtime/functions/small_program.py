"""A program with a function of each kind, a generator, and controllers that Python carries out."""

from typing import Any

from programs import problem_of

from crow.problem import Problem
from crow.registration import registered

DOMAIN = """
typedef Thing
typedef Box: Thing
typedef Spot: vector[float64, 2]
typedef Path: pyobject
object_constant table: Thing
feature at(t: Thing) -> Spot
feature held(b: Box)
feature on(b: Box) -> Thing
feature count() -> int32
feature last() -> Path
def heavy(b: Box) -> bool
def weight(b: Box, n: int32) -> float32
def middle(a: Spot, b: Spot) -> Spot
def path(a: Spot, b: Spot) -> Path
def name_of(b: Box) -> string
def nearest(b: Box) -> Thing
def [[reads=at, held]] free(b: Box) -> bool
def [[reads=all]] steady() -> bool
def twice(n: int32) -> int32:
  return 2 * n
controller carry(b: Box, to: Spot)
controller note(p: Path)
controller wait():
  eff: count += 1
behavior r_held(b: Box):
  goal: held(b)
  body:
    assert free(b)
    do carry(b, at(b))
behavior r_on(b: Box, t: Thing):
  goal: on(b) == t
  body:
    let p = path(at(b), at(t))
    do carry(b, middle(at(b), at(t)))
    do note(p)
generator reach(b: Box, s: Spot):
  goal: close(b, s)
  in: b
  out: s
generator paths(a: Spot, b: Spot, p: Path):
  goal: path(a, b) == p
  in: a, b
  out: p
generator [[reads=held]] pairs(b: Box, s: Spot, q: Path):
  goal: both(b, s, q)
  in: b
  out: s, q
def [[reads=at]] close(b: Box, s: Spot) -> bool
def both(b: Box, s: Spot, q: Path) -> bool
"""
PROBLEM = """
problem "p"
objects:
  a, b: Box
init:
  at[a] = [0.0, 1.0]
  at[b] = [2.0, 1.0]
  at[table] = [5.0, 5.0]
  held[b] = True
  on[a] = table
  on[b] = table
goal: {goal}
"""


def problem(python: Any, goal: str = "held(a)") -> Problem:
    """A problem of the program, with Python for it."""
    from dataclasses import replace

    made = problem_of(DOMAIN, PROBLEM.format(goal=goal))
    given = registered(made.world.program, python)
    world = made.world.of(made.world.program, (), given)
    return made.changed(world=replace(world, objects=made.world.objects))
