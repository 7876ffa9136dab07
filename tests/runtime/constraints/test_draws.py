"""The random stream of a call is its own: the same in each run, whatever else is drawn."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from typing import Any

import numpy as np
from posed import Posed, posed
from support import ROOT

from crow.constraints import Draws
from crow.functions import generator
from crow.program import FLOAT64
from crow.unknowns import Unknown

DOMAIN = """
typedef spot
typedef shape: pyobject
feature height(s: spot) -> float64
def near(x: float64, y: float64) -> bool
def [[reads=height]] above(x: float64) -> bool
def made(x: float64, s: shape) -> bool
def cut(s: shape, y: float64) -> bool
generator gen_near(x, y):
  goal: near(x, y)
  in: x
  out: y
generator gen_above(x):
  goal: above(x)
  in:
  out: x
generator gen_made(x, s):
  goal: made(x, s)
  in: x
  out: s
generator gen_cut(s, y):
  goal: cut(s, y)
  in: s
  out: y
"""


class Shape:
    """Something that prints with its address, and has state."""

    def __init__(self, size: float) -> None:
        self.size = size


@generator
def near(x: float, *, rng: np.random.Generator) -> Iterator[float]:
    while True:
        yield x + rng.normal()


@generator
def above(state: Any, *, rng: np.random.Generator) -> Iterator[float]:
    while True:
        yield max(state.cells("height").values()) + rng.random()


@generator
def made(x: float, *, rng: np.random.Generator) -> Iterator[Shape]:
    while True:
        yield Shape(x + rng.random())


@generator
def cut(s: Shape, *, rng: np.random.Generator) -> Iterator[float]:
    while True:
        yield s.size * rng.random()


PYTHON = {
    "near": lambda x, y: abs(x - y) < 1,
    "above": lambda state, x: all(x > h for h in state.cells("height").values()),
    "made": lambda x, s: s.size >= x,
    "cut": lambda s, y: y < s.size / 2,
    "gen_near": near,
    "gen_above": above,
    "gen_made": made,
    "gen_cut": cut,
}


def problem(height: int = 3) -> Posed:
    return posed(
        "x, y, z, w: float64; s: shape",
        "x == 1\nnear(x, y)\nnear(y, z)\nabove(w)\nmade(x, s)\ncut(s, z) or cut(s, y) or cut(s, w)",
        DOMAIN,
        objects="a, b: spot",
        init=f"height[a] = {height}",
        functions=PYTHON,
    )


def drawn(seed: int, height: int = 3) -> list[dict[str, Any]]:
    own = problem(height)
    solutions = islice(own.solver(seed).solutions(own.store), 4)
    found = [own.checked(solution) for solution in solutions]
    return [{n: v.size if n == "s" else v for n, v in f.items()} for f in found]


def test_runs_are_the_same_for_a_seed_and_others_for_others() -> None:
    assert drawn(1) == drawn(1)
    assert drawn(1) != drawn(2)


def test_another_process_draws_the_same() -> None:
    code = "import json, test_draws; print(json.dumps(test_draws.drawn(5)))"
    places = [str(ROOT), str(ROOT / "runtime"), str(ROOT / "tests"), os.path.dirname(__file__)]  # noqa: PTH120
    for hash_seed in ("1", "2"):
        environment = {**os.environ, "PYTHONHASHSEED": hash_seed, "PYTHONPATH": ":".join(places)}
        done = subprocess.run(
            [sys.executable, "-c", code],
            env=environment,
            check=True,
            capture_output=True,
            text=True,
        )
        assert json.loads(done.stdout) == drawn(5)


def values(draws: Draws, *key: Any, count: int = 5) -> list[Any]:
    stream = draws.stream(*key)
    return [stream.item(index) for index in range(count)]


def test_streams_do_not_depend_on_what_else_is_drawn_nor_on_when() -> None:
    world = problem().world
    alone = values(Draws(world, 0), "gen_near", "p", {}, (1.0,))
    draws = Draws(world, 0)
    first = draws.stream("gen_near", "p", {}, (1.0,)).item(0)
    values(draws, "gen_near", "q", {}, (1.0,))
    values(draws, "gen_near", "p", {}, (2.0,))
    assert [first, *values(draws, "gen_near", "p", {}, (1.0,))[1:]] == alone


def test_what_a_stream_is_for_is_what_it_depends_on() -> None:
    world = problem().world
    cells, other, more = ({("height", ("a",)): h} for h in (1.0, 2.0, 1.0))
    more["width", ("a",)] = 7  # type: ignore[index]
    base = values(Draws(world, 0), "gen_above", "p", cells, ())
    assert values(Draws(world, 0), "gen_above", "p", more, ()) == base
    assert values(Draws(world, 0), "gen_above", "p", other, ()) != base
    assert values(Draws(world, 0), "gen_above", "q", cells, ()) != base
    assert values(Draws(world, 1), "gen_above", "p", cells, ()) != base
    near_one = values(Draws(world, 0), "gen_near", "p", {}, (1.0,))
    assert values(Draws(world, 0), "gen_near", "p", cells, (1.0,)) == near_one


def test_the_path_of_an_unknown_is_part_of_its_stream() -> None:
    own = problem()
    found = []
    for path in ("behavior 1", "behavior 2"):
        unknown = Unknown("y", FLOAT64, path)
        (near_x,) = [c for c in own.constraints if c.text == "near(x, y)"]
        constraint = type(near_x)(
            near_x.condition, {"x": 1.0, "y": unknown}, near_x.state, location=near_x.location
        )
        store = own.store.having(constraint)
        drawn_ = own.solver().draws(store, unknown)  # type: ignore[arg-type]
        assert drawn_ is not None
        found.append(next(drawn_).values[unknown])
    assert found[0] != found[1]


@dataclass(frozen=True)
class Named:
    name: str


def test_opaque_values_are_told_by_where_they_came_from_or_what_they_are() -> None:
    draws = Draws(problem().world, 0)
    shape, other = Shape(1.0), Shape(2.0)
    assert draws.told(shape) == Draws(problem().world, 0).told(Shape(1.0))
    assert draws.told(shape) != draws.told(other)
    assert draws.told(Named("a")) == "Named(name='a')"
    draws.came_from((shape, 3), "stream#1")
    assert draws.told((shape, 3)) == "(<stream#1.0>, 3,)"
    assert draws.told(lambda: 1) == draws.told(lambda: 2)
    assert draws.told((1, 1.0, True)) == "(1, 1.0, True,)"
