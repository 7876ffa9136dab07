"""Stacking blocks by an imperative program, beside GTPyhop's methods and Fast Downward."""

from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

import cdlc
import crow
from benchmarks.htn import Positions, stacked
from benchmarks.peers import cpu_seconds
from benchmarks.plot import Plot
from benchmarks.table import Figure, Table
from benchmarks.towers import BLOCKS, Towers, instance, names, on, random_towers

_SIZES = (10, 30, 60, 100, 300, 1_000)
_MOST_FOR_PDDL = 100
_LIMIT = 300
_COLUMNS = (
    "blocks", "actions", "CPU s", "load CPU s", "nodes", "GTPyhop actions", "GTPyhop CPU s",
    "fast downward CPU s",
)  # fmt: skip
_NOTE = (
    "target: at most GTPyhop's CPU, and plans as short. Ours and GTPyhop's are the least of three,"
    " without start-up, so programs and methods are compiled; for GTPyhop Python's recursion limit"
    " is raised, which it meets between 60 and 80 blocks; lama-first is a whole process"
)


def run(quick: bool) -> Table:
    """One random instance a size."""
    sizes = _SIZES[:2] if quick else _SIZES
    ys = ("CPU s", "GTPyhop CPU s", "fast downward CPU s")
    plots = (Plot("blocks", ys, "CPU seconds"),)
    return Table("serial", _COLUMNS, tuple(_row(count) for count in sizes), _NOTE, plots)


def _row(count: int) -> tuple[Figure, ...]:
    start, pairs = random_towers(count, 0)
    began = process_time()
    problem = stacking(start, pairs)
    loaded = process_time() - began
    seconds = []
    for _ in range(3):
        began = process_time()
        result = crow.plan(problem, time_limit=_LIMIT)
        seconds.append(process_time() - began)
    actions = sum(step.controller is not None for step in result.steps)
    told = stacked(positions(names(count), on(start)), positions(names(count), pairs), _LIMIT)
    peer: tuple[Figure, Figure] = ("-", told) if isinstance(told, str) else (told[1], told[0])
    pddl: Figure = "-"
    if count <= _MOST_FOR_PDDL:
        pddl = cpu_seconds("up_fast_downward", instance(start, pairs).pddl, _LIMIT)
    return (count, actions, min(seconds), loaded, result.statistics["nodes"], *peer, pddl)


def positions(blocks: list[str], pairs: list[tuple[str, str]]) -> Positions:
    """What each block is on."""
    return dict.fromkeys(blocks, "table") | dict(pairs)


def stacking(start: Towers, pairs: list[tuple[str, str]]) -> crow.Problem:
    """The problem of towers and pairs on(x, y) to achieve, for `examples/blocks/stacking.cdl`."""
    with TemporaryDirectory() as folder:
        file = Path(folder) / "problem.cdl"
        file.write_text(stacking_text(start, pairs))
        return cdlc.compile(BLOCKS.with_name("stacking.cdl"), file).task()


def stacking_text(start: Towers, pairs: list[tuple[str, str]]) -> str:
    """The same as a problem file."""
    blocks = sorted((block for tower in start for block in tower), key=lambda b: (len(b), b))
    lines = ['problem "towers"', 'domain "stacking.cdl"', "objects:"]
    lines += [f"  {', '.join(blocks)}: block", "init:"]
    lines += [f"  {f}[{p}] = True" for p in ("table", "nothing") for f in ("judged", "done")]
    for prefix, placed in (("", on(start)), ("goal_", pairs)):
        below = positions(blocks, placed)
        above = dict.fromkeys(["table", *blocks], "nothing") | {y: x for x, y in placed}
        lines += [f"  {prefix}below[{x}] = {y}" for x, y in below.items()]
        lines += [f"  {prefix}above[{y}] = {x}" for y, x in above.items()]
    return "\n".join([*lines, "goal:", "  stacked()", ""])
