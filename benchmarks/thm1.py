"""Theorem 1: a plan that needs depth d is found at depth d, and no sooner; a search that has tried
everything says so.

A courier goes along a line of places, each with a side path from which there is no way back. The
place to reach is d behaviors deep; or the line does not begin where the courier is.
"""

import crow
from benchmarks.plot import Plot
from benchmarks.problems import from_texts
from benchmarks.table import Figure, Table

DOMAIN = """
typedef place
feature at(x: place)
feature path(x: place, y: place)
controller go(x: place, y: place)

behavior reach(y: place):
  goal: at(y)
  body:
    bind x: place where: path(x, y)
    achieve at(x)
    do go(x, y)
  eff:
    at[x] = False
    at[y] = True
"""
_DEPTHS = 20
_COLUMNS = (
    "depth d", "limit d-1", "nodes to d-1", "limit d", "nodes to d", "depth", "steps",
    "auto: steps", "iw: depth", "no way", "nodes no way",
)  # fmt: skip
_NOTE = "expected: `limit: depth` below d, a plan of d steps at d, `unsolvable` where there is none"


def run(quick: bool) -> Table:
    """Every depth with limits d - 1 and d, without a limit, and without a way."""
    rows = tuple(_row(depth) for depth in range(1, 5 if quick else _DEPTHS + 1))
    plot = Plot("depth d", ("nodes to d-1", "nodes to d", "nodes no way"), "nodes", scale="linear")
    return Table("thm1", _COLUMNS, rows, _NOTE, (plot,))


def places(depth: int, *, has_way: bool = True) -> crow.Problem:
    """The problem whose plans need a depth; or one without any, as deep."""
    names = [f"p{i}" for i in range(depth + 1)]
    sides = [f"s{i}" for i in range(1, depth + 1)]
    lines = ['problem "places"', "objects:", f"  {', '.join([*names, *sides, 'far'])}: place"]
    lines += ["init:", f"  at[{'p0' if has_way else 'far'}] = True"]
    for i, side in enumerate(sides):
        lines += [
            f"  path[{side}, {names[i + 1]}] = True",
            f"  path[{names[i]}, {names[i + 1]}] = True",
        ]
    return from_texts(DOMAIN, "\n".join([*lines, "goal:", f"  at({names[-1]})", ""]))


def _row(depth: int) -> tuple[Figure, ...]:
    task = places(depth)
    below = crow.plan(task, "iddfs", depth_limit=depth - 1)
    at = crow.plan(task, "iddfs", depth_limit=depth)
    others = (len(crow.plan(task).steps), crow.plan(task, "iw").statistics["depth"])
    none = crow.plan(places(depth, has_way=False), "iddfs")
    return (
        depth, told(below), below.statistics["nodes"], told(at), at.statistics["nodes"],
        at.statistics["depth"], len(at.steps), *others, told(none), none.statistics["nodes"],
    )  # fmt: skip


def told(result: crow.Result) -> str:
    """The kind of a result, with the limits that kept a search from its end."""
    limits = result.limits if isinstance(result, crow.LimitReached) else ()
    return ": ".join([result.status, ", ".join(limits)]) if limits else result.status
