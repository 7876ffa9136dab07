"""Problems for all executors: with plans, without, and cut off by limits."""

import json
from collections.abc import Iterable

from programs import problem_of
from support import BLOCKS
from towers_in_python import IN_CDL, OUTSIDE, PYTHON, towers

from crow.many.records import Record, comparable
from crow.many.tasks import Configuration, Task
from crow.problem import Problem
from examples.namo.problems import problem as namo

GOALS = ("on(A, B) and on(B, C)", "on(C, B) and on(B, A)", "on(A, B) and on(B, A)", "on(B, A)")
CONFIGURATIONS = (
    Configuration(node_limit=2_000, depth_limit=6),
    Configuration(engine="best", h="add", node_limit=2_000, depth_limit=6, seed=3),
    Configuration(engine="iddfs", node_limit=300, depth_limit=4),
    Configuration(engine="iw", node_limit=40, name="narrow"),
    Configuration(optimal=True, node_limit=1_000, depth_limit=4),
)
SUSSMAN = """
problem "sussman"
objects:
  A, B, C: block
init:
  on_table[A] = True
  on_table[B] = True
  on[C, A] = True
  clear[B] = True
  clear[C] = True
  handempty[...] = True
goal: {goal}
"""
NEVER_ENDS = "on(A, B) and on(B, A)"


def sussman(goal: str = GOALS[0]) -> Problem:
    return problem_of((BLOCKS / "blocks.cdl").read_text("utf-8"), SUSSMAN.format(goal=goal))


def suite() -> list[Task]:
    """Three programs, two of them with Python, one of which draws, in several configurations."""
    problems = [sussman(goal) for goal in GOALS]
    init = "on[A, B] = True\n  on[B, C] = True"
    for goal in ("clear(C)", "on(C, B) and on(B, A)"):
        problems += [towers(IN_CDL, init, goal), towers(OUTSIDE, init, goal, PYTHON)]
    tasks = [
        Task(problem, configuration, f"{number}/{configuration.label}")
        for number, problem in enumerate(problems)
        for configuration in CONFIGURATIONS
    ]
    drawn = [Configuration(seed=s, node_limit=3_000, draw_limit=20) for s in range(4)]
    return [*tasks, *(Task(namo("hard"), one, f"namo/{one.seed}") for one in drawn)]


def written(records: Iterable[Record]) -> str:
    """What may be compared of records, in the order of their tasks."""
    in_order = sorted(records, key=lambda record: record.index)
    return "\n".join(json.dumps(comparable(r.json()), sort_keys=True) for r in in_order)
