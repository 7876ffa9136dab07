"""Theorem 2: programs of a fixed width K take nodes polynomial in the number of objects N.

A corridor of doors, each with K locks, and keys that the doors share: for each lock one of them can
be chosen, and only one choice for all locks of a door opens it. The program of one door holds K
`achieve`s, however many other doors there are: it is called, one door after another. Without that
serialisation all locks of all doors are in one promotable section.
"""

from itertools import chain

import crow
from benchmarks.fit import exponential, power
from benchmarks.plot import Plot
from benchmarks.problems import from_texts
from benchmarks.table import Figure, Table

_SIZES = (12, 36, 72, 108, 144, 180)
_SMALL = (12, 18, 24, 30, 36, 42, 48, 54, 60)
_MOST = 300_000
_COLUMNS = (
    "program", "K", "N", "nodes", "status", "width", "exponent", "R² of exponent", "base",
    "R² of base",
)  # fmt: skip
_NOTE = (
    "exponent: b of N^b, from N = 36 on where doors are serialised, expected at most 2 K there;"
    f" base: b of b^N, the better fit in one section. Searches end at {_MOST} nodes"
)

_HEAD = """
typedef door
typedef key
{kinds}
feature opened(d: door)
feature all_opened()
feature fits(d: door, {parameters})
controller push(d: door)
"""
_LOCK = """
feature ready_{i}(d: door)
feature chosen_{i}(d: door) -> key_{i}
controller insert_{i}(d: door, k: key_{i})

behavior insert_in_{i}(d: door):
  goal: ready_{i}(d)
  body:
    bind k: key_{i}
    do insert_{i}(d, k)
  eff:
    chosen_{i}[d] = k
    ready_{i}[d] = True
"""
_DOOR = """
behavior open(d: door):
  goal: opened(d)
  body:
    promotable:
{wanted}
    assert fits(d, {chosen})
    do push(d)
  eff:
    opened[d] = True

behavior open_one_by_one():
  goal: all_opened()
  body:
    foreach d: door:
      open(d)
  eff:
    all_opened[...] = True
"""


def run(quick: bool) -> Table:
    """K = 1, 2, 3 with `iw`, serialised; and with `iddfs`, in one section."""
    sizes, small = (_SIZES[:4], _SMALL[:4]) if quick else (_SIZES, _SMALL)
    most, widths = (5_000, (1, 2)) if quick else (_MOST, (1, 2, 3))
    rows = list(chain(*(_serial(k, sizes) for k in widths)))
    # With more locks, keys become more only every other size.
    rows += chain(*(_joint(k, small[:: 1 if k == 1 else 2], most) for k in widths))
    plots = (
        Plot("N", ("nodes",), "nodes", by="program"),
        Plot("N", ("nodes",), "nodes", by="program", scale="semilogy", name="-exponential"),
    )
    return Table("thm2", _COLUMNS, tuple(rows), _NOTE, plots)


def doors(width: int, size: int, *, is_serial: bool) -> crow.Problem:
    """Of N objects one in twelve is a door, and one in six a key, as many for each lock."""
    count, each = size // 12, max(1, size // (6 * width))
    locks = range(1, width + 1)
    domain = _HEAD.format(
        kinds="\n".join(f"typedef key_{i}: key" for i in locks),
        parameters=", ".join(f"k{i}: key_{i}" for i in locks),
    )
    domain += "".join(_LOCK.format(i=i) for i in locks)
    domain += _DOOR.format(
        wanted="\n".join(f"      achieve ready_{i}(d)" for i in locks),
        chosen=", ".join(f"chosen_{i}(d)" for i in locks),
    )
    names = [f"d{i}" for i in range(1, count + 1)]
    keys = [[f"k{i}_{j}" for j in range(1, each + 1)] for i in locks]
    lines = ['problem "doors"', "objects:", f"  {', '.join(names)}: door"]
    lines += [f"  {', '.join(own)}: key_{i}" for i, own in zip(locks, keys, strict=True)]
    # What nobody needs: objects that make N what it is.
    lines += [f"  {', '.join(f'x{i}' for i in range(size - count - each * width))}: key", "init:"]
    lines += [f"  fits[{door}, {', '.join(own[-1] for own in keys)}] = True" for door in names]
    goal = "all_opened()" if is_serial else "forall d: door: opened(d)"
    return from_texts(domain, "\n".join([*lines, "goal:", f"  {goal}", ""]))


def _serial(width: int, sizes: tuple[int, ...]) -> list[tuple[Figure, ...]]:
    results = [crow.plan(doors(width, size, is_serial=True), "iw") for size in sizes]
    return _rows(f"serial, K = {width}", width, sizes, results, least=_SIZES[1])


def _joint(width: int, sizes: tuple[int, ...], most: int) -> list[tuple[Figure, ...]]:
    """Sizes up to the first one that takes too many nodes."""
    results = []
    for size in sizes:
        task = doors(width, size, is_serial=False)
        results.append(crow.plan(task, "iddfs", node_limit=most))
        if results[-1].status != "plan":
            break
    return _rows(f"one section, K = {width}", width, sizes, results, least=0)


def _rows(
    program: str, width: int, sizes: tuple[int, ...], results: list[crow.Result], least: int
) -> list[tuple[Figure, ...]]:
    told = [(n, r.statistics["nodes"], r) for n, r in zip(sizes, results, strict=False)]
    points = [(n, nodes) for n, nodes, r in told if n >= least and r.status == "plan"]
    fits = [fit(*zip(*points, strict=True)) for fit in (power, exponential)]
    fitted = [figure for fit in fits for figure in fit]
    return [
        (program, width, n, nodes, r.status, r.statistics.get("width", "-"), *fitted)
        for n, nodes, r in told
    ]
