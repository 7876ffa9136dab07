"""Blocks problems of any size: towers built at random, and one tower to reverse."""

import random
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory

import cdlc
from crow import Problem

BLOCKS = Path(__file__).resolve().parent.parent / "examples" / "blocks" / "blocks.cdl"

Towers = list[list[str]]
"""Each from the table up."""


@dataclass(frozen=True, slots=True)
class Instance:
    """A problem as the runtime has it, and as PDDL: domain and problem."""

    problem: Problem
    pddl: tuple[str, str]


def random_towers(count: int, seed: int) -> tuple[Towers, list[tuple[str, str]]]:
    """So many blocks in √n random towers, and pairs on(x, y) of others, in random order."""
    generator = random.Random(f"{count} blocks, {seed}")  # noqa: S311 - the same everywhere
    blocks = names(count)
    start, goal = (_built(blocks, round(count**0.5), generator) for _ in range(2))
    pairs = on(goal)
    generator.shuffle(pairs)
    return start, pairs


def _built(blocks: list[str], count: int, generator: random.Random) -> Towers:
    towers: Towers = [[] for _ in range(count)]
    for block in generator.sample(blocks, len(blocks)):
        generator.choice(towers).append(block)
    return [tower for tower in towers if tower]


def names(count: int) -> list[str]:
    """b1, b2, …"""
    return [f"b{number}" for number in range(1, count + 1)]


def on(towers: Towers) -> list[tuple[str, str]]:
    """Which block is on which."""
    return [(x, y) for tower in towers for y, x in pairwise(tower)]


def instance(towers: Towers, goal: list[tuple[str, str]]) -> Instance:
    """The problem of towers and pairs on(x, y) to achieve, for `examples/blocks/blocks.cdl`."""
    lines = ['problem "towers"', f'domain "{BLOCKS.name}"', "objects:"]
    lines += [f"  {', '.join(block for tower in towers for block in tower)}: block", "init:"]
    facts = [f"on[{x}, {y}]" for x, y in on(towers)]
    facts += [f"on_table[{tower[0]}]" for tower in towers] + ["handempty[...]"]
    facts += [f"clear[{tower[-1]}]" for tower in towers]
    lines += [f"  {fact} = True" for fact in facts]
    lines += ["goal:", f"  {' and '.join(f'on({x}, {y})' for x, y in goal)}", ""]
    with TemporaryDirectory() as folder:
        (Path(folder) / BLOCKS.name).write_text(BLOCKS.read_text("utf-8"))
        file = Path(folder) / "problem.cdl"
        file.write_text("\n".join(lines))
        compiled = cdlc.compile(Path(folder) / BLOCKS.name, file)
        task = compiled.pddl()
        assert task.problem is not None
        return Instance(compiled.task(), (task.domain, task.problem))
