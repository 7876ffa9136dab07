"""Continuous variables in chains, rings and grids, and candidates tested one by one or at once.

Poses lie in a square workspace with round obstacles; neighbours in the graph are less than 1 apart.
A generator yields poses near another one, at random; all else rejects.
"""

from collections.abc import Iterable, Iterator, Mapping
from itertools import pairwise
from math import hypot
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

import numpy as np

import cdlc
from benchmarks.fit import power
from benchmarks.plot import Plot
from benchmarks.table import Figure, Table
from crow.budget import Budget, Stopped
from crow.constraints import Conflict, Constraint, Draws, Solver, Store
from crow.functions import function, generator
from crow.problem import State, World
from crow.program import BOOL, Apply, Expression, Type, Variable
from crow.unknowns import Unknown

DOMAIN = """
typedef pose: vector[float64, 2]
def near(a: pose, b: pose) -> bool
def clear(a: pose) -> bool
generator gen_near(a, b):
  goal: near(a, b)
  in: a
  out: b
"""
_SIDE = 2.5
_OBSTACLES = np.array([[x, y] for x in (0.5, 1.25, 2.0) for y in (0.5, 1.25, 2.0)])
_RADIUS = 0.25
_START = (0.1, 0.1)
_SEEDS = 5
_LIMIT = 20.0
_SIZES: Mapping[str, tuple[int, ...]] = {
    "chain": (10, 30, 100, 300, 1_000, 3_000),
    "ring": (10, 30, 100, 300, 1_000),
    "grid": (9, 25, 100, 225, 400),
}
_COLUMNS = (
    "graph", "variables", "constraints", "solved", "CPU s", "samples", "samples a variable",
    "exponent",
)  # fmt: skip
_NOTE = (
    "targets: success; CPU near-linear for chains; candidates tested at once at least 10 times as"
    " fast as one by one. Medians of the seeds that were solved, 20 s at most for one; the exponent"
    " is that of CPU in variables, from 100 on"
)


def run(quick: bool) -> Table:
    """Each graph in each size, then one pose that is rarely good by both ways of testing."""
    rows: list[tuple[Figure, ...]] = []
    for name, sizes in _SIZES.items():
        rows += _graph_rows(name, sizes[:2] if quick else sizes, 2 if quick else _SEEDS)
    rows += _batch_rows(200 if quick else 2_000, 1 if quick else _SEEDS)
    plots = (
        Plot("variables", ("CPU s",), "CPU s", by="graph"),
        Plot("variables", ("samples",), "samples", by="graph", name="-samples"),
    )
    return Table("csp", _COLUMNS, tuple(rows), _NOTE, plots)


# ------------------------------------------------------------------------------------ the problems


def edges(name: str, count: int) -> list[tuple[int, int]]:
    """Pairs of neighbours of a chain, a ring, or a square grid of so many variables."""
    if name == "grid":
        side = round(count**0.5)
        right = [(i, i + 1) for i in range(count) if (i + 1) % side]
        return sorted([*right, *((i, i + side) for i in range(count - side))])
    chain = list(pairwise(range(count)))
    return [*chain, (0, count - 1)] if name == "ring" else chain


def constraints(
    world: World, count: int, pairs: Iterable[tuple[int, int]]
) -> tuple[list[Unknown], list[Constraint]]:
    """Poses of a graph, all of them clear and neighbours near, the first one known."""
    pose = world.functions["near"].parameters[0].type
    unknowns = [Unknown(f"x{i}", pose) for i in range(count)]
    known: dict[str, Any] = {u.name: u for u in unknowns} | {"x0": _START}
    found = [
        Constraint(call("near", pose, f"x{a}", f"x{b}"), _only(known, a, b), State())
        for a, b in pairs
    ]
    found += [
        Constraint(call("clear", pose, f"x{i}"), _only(known, i), State()) for i in range(1, count)
    ]
    return unknowns, found


def call(name: str, type_: Type, *variables: str) -> Expression:
    """A Boolean function of variables of one type."""
    return Apply(name, tuple(Variable(v, type_) for v in variables), BOOL)


def _only(values: Mapping[str, Any], *numbers: int) -> dict[str, Any]:
    return {name: values[name] for name in (f"x{i}" for i in numbers)}


def world_of(functions: Mapping[str, Any]) -> World:
    """The domain with its Python."""
    with TemporaryDirectory() as folder:
        file = Path(folder) / "poses.cdl"
        file.write_text(DOMAIN, "utf-8")
        domain = cdlc.load(file, functions=functions)
    return World.of(domain.program, (), domain.functions)


# ----------------------------------------------------------------------------------- one by one


def near(a: tuple[float, float], b: tuple[float, float]) -> bool:
    """Whether two poses are neighbours."""
    return hypot(a[0] - b[0], a[1] - b[1]) < 1


def clear(a: tuple[float, float]) -> bool:
    """Whether a pose is in the workspace and in no obstacle."""
    is_inside = 0 <= a[0] <= _SIDE and 0 <= a[1] <= _SIDE
    return is_inside and all(hypot(a[0] - x, a[1] - y) > _RADIUS for x, y in _OBSTACLES)


@generator
def gen_near(a: tuple[float, float], *, rng: np.random.Generator) -> Iterator[tuple[float, float]]:
    """Poses near another one."""
    while True:
        dx, dy = rng.uniform(-1, 1, 2)
        if hypot(dx, dy) < 1:
            yield a[0] + dx, a[1] + dy


_SCALAR = {"near": near, "clear": clear, "gen_near": gen_near}


def _graph_rows(name: str, sizes: tuple[int, ...], seeds: int) -> list[tuple[Figure, ...]]:
    rows: list[tuple[Figure, ...]] = []
    measured: list[tuple[int, float]] = []
    for count in sizes:
        pairs = edges(name, count)
        runs = [_solved(_SCALAR, count, pairs, seed) for seed in range(seeds)]
        solved = [(seconds, samples) for seconds, samples, is_solved in runs if is_solved]
        cpu: Figure = median(s for s, _ in solved) if solved else "-"
        samples: Figure = median(n for _, n in solved) if solved else "-"
        each: Figure = samples / (count - 1) if isinstance(samples, int | float) else "-"
        if isinstance(cpu, float) and count >= 100:
            measured.append((count, cpu))
        exponent = power(*zip(*measured, strict=True)).value if len(measured) > 1 else ""
        row = (count, len(pairs) + count - 1, f"{len(solved)}/{seeds}", cpu, samples, each)
        rows.append((name, *row, exponent))
    return rows


def _solved(
    functions: Mapping[str, Any], count: int, pairs: list[tuple[int, int]], seed: int
) -> tuple[float, int, bool]:
    """CPU seconds, samples, and whether all constraints are true by the functions themselves."""
    world = world_of(functions)
    unknowns, own = constraints(world, count, pairs)
    draws = Draws(world, seed, limit=10**9)
    began = process_time()
    solution = None
    try:
        with Budget(time_limit=_LIMIT).running():
            store = Store.of(world).having(*own)
            if not isinstance(store, Conflict):
                solution = next(Solver(world, draws).solutions(store), None)
    except Stopped:
        pass
    seconds = process_time() - began
    samples = sum(tally.yielded for tally in draws.tallies.values())
    if solution is None:
        return seconds, samples, False
    poses = [_START, *(solution.values[u] for u in unknowns[1:])]
    assert all(near(poses[a], poses[b]) for a, b in pairs)
    assert all(map(clear, poses[1:]))
    return seconds, samples, True


# ------------------------------------------------------------------------------- many at once


def _batch_rows(rarity: int, seeds: int) -> list[tuple[Figure, ...]]:
    """A pose of which one in so many is good, tested one by one and by the thousand."""
    radius = (1 / rarity) ** 0.5

    def is_rare(a: tuple[float, float]) -> bool:
        return hypot(a[0] - 0.5, a[1] - 0.2) < radius

    @function(vectorized=True)
    def are_near(a: Any, b: Any) -> Any:
        return np.hypot(*(a - b).T) < 1

    @function(vectorized=True)
    def are_rare(a: Any) -> Any:
        return np.hypot(a[:, 0] - 0.5, a[:, 1] - 0.2) < radius

    @generator(batch=True)
    def batches(a: tuple[float, float], *, rng: np.random.Generator) -> Iterator[Any]:
        while True:
            steps = rng.uniform(-1, 1, (1_000, 2))
            yield np.array(a) + steps[np.hypot(*steps.T) < 1]

    ways = {
        "one by one": {**_SCALAR, "clear": is_rare},
        "by the thousand": {"near": are_near, "clear": are_rare, "gen_near": batches},
    }
    rows: list[tuple[Figure, ...]] = []
    each = {}
    for name, functions in ways.items():
        runs = [_found(functions, seed) for seed in range(seeds)]
        seconds, samples = median(s for s, _ in runs), median(n for _, n in runs)
        each[name] = sum(s for s, _ in runs) / sum(n for _, n in runs)
        rows.append((name, 1, 2, f"{seeds}/{seeds}", seconds, samples, samples, ""))
    ratio = each["one by one"] / each["by the thousand"]
    rows.append(("times as fast, a sample", 1, 2, "", ratio, "", "", ""))
    return rows


def _found(functions: Mapping[str, Any], seed: int) -> tuple[float, int]:
    """CPU seconds and samples until ten good poses are found."""
    world = world_of(functions)
    _, own = constraints(world, 2, [(0, 1)])
    draws = Draws(world, seed, limit=10**9)
    store = Store.of(world).having(*own)
    assert isinstance(store, Store)
    began = process_time()
    solutions = Solver(world, draws).solutions(store)
    for _ in range(10):
        next(solutions)
    seconds = process_time() - began
    return seconds, draws.tallies["gen_near"].yielded
