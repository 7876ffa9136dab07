"""HDDL through an HTN planner: its plans are PDDL plans, mapped back and replayed."""

import re
from functools import cache
from itertools import pairwise
from pathlib import Path

import pytest
from hddl_tasks import Stated, stated
from htn_planner import Steps, answers_of
from support import BLOCKS, EXAMPLES

from cdlc.backends.pddl import to_step
from cdlc.backends.pddl.solve import InvalidPlan, run
from cdlc.driver import Compilation
from crow.replay import replay_to_goal

pytest.importorskip("up_aries")
HERE = Path(__file__).parent

# Towers from the table up, before and wanted; what is wanted of blocks on the table is open.
TOWERS = {
    "two, turned over": ("a b", "b a"),
    "three, Sussman": ("a c|b", "c b a"),
    "three, reversed": ("a b c", "c b a"),
    "four, two and two": ("a b|c d", "d a|b c"),
    "four, reversed": ("a b c d", "d c b a"),
    "five, reversed": ("a b c d e", "e d c b a"),
    "five, unstacked": ("c b e a d", "a b|d e"),
    "three, as they are": ("a b c", "a b"),
}


def towers_problem(before: str, wanted: str) -> str:
    towers = [tower.split() for tower in before.split("|")]
    facts = [f"on[{above}, {below}] = True" for t in towers for below, above in pairwise(t)]
    facts += [f"on_table[{t[0]}] = True" for t in towers]
    facts += [f"clear[{t[-1]}] = True" for t in towers]
    goals = [tower.split() for tower in wanted.split("|")]
    goal = " and ".join(f"on({above}, {below})" for t in goals for below, above in pairwise(t))
    blocks = ", ".join(sorted(block for t in towers for block in t))
    init = "\n  ".join([*facts, "handempty[...] = True"])
    return f'problem "towers"\nobjects:\n  {blocks}: block\ninit:\n  {init}\ngoal: {goal}\n'


# Only what another behavior does on the way would help, and no behavior has it as its goal.
BY_THE_WAY = """
    typedef lamp
    feature lit(x: lamp)
    feature warm(x: lamp)
    controller switch(x: lamp)
    behavior light(x: lamp):
      goal: lit(x)
      body:
        do switch(x)
      eff:
        lit[x] = True
        warm[x] = True
"""
WARM = 'problem "warm"\nobjects:\n  a: lamp\ngoal: warm(a)\n'


@cache
def cases() -> dict[str, Stated]:
    domain = (BLOCKS / "blocks.cdl").read_text()
    found = {name: stated(domain, towers_problem(*towers)) for name, towers in TOWERS.items()}
    strips = (BLOCKS / "blocks_strips.cdl").read_text()
    found["strips"] = stated(strips, towers_problem(*TOWERS["three, Sussman"]))
    rooms = Compilation(None, str(EXAMPLES / "tutorial" / "swap.cdl"))
    found["rooms"] = Stated(rooms.hddl, rooms.problem)
    errands = (HERE / "golden" / "errands.cdl").read_text()
    found["errands"] = stated(*re.split(r"^(?=problem )", errands, flags=re.MULTILINE))
    found["by the way"] = stated(BY_THE_WAY, WARM)
    return found


@pytest.fixture(scope="module")
def answers() -> dict[str, tuple[str, Steps | None]]:
    return answers_of({name: case.texts for name, case in cases().items()})


@pytest.mark.parametrize("name", [name for name in cases() if name != "by the way"])
def test_plans_are_found_mapped_back_and_replayed(
    name: str, answers: dict[str, tuple[str, Steps | None]]
) -> None:
    status, steps = answers[name]
    assert status == "SOLVED_SATISFICING"
    assert steps is not None
    assert bool(steps) is (name != "three, as they are")
    task, problem = cases()[name]
    planned = [
        to_step(task.pddl, problem.world, action, objects, number)
        for number, (action, objects) in enumerate(steps, 1)
    ]
    _, trace = run(problem, planned)
    assert replay_to_goal(problem, trace).failure is None
    if planned:
        with pytest.raises(InvalidPlan):
            run(problem, planned[:-1])


def test_what_no_behavior_is_for_can_only_be_true(
    answers: dict[str, tuple[str, Steps | None]],
) -> None:
    status, steps = answers["by the way"]
    assert (status, steps) == ("UNSOLVABLE_INCOMPLETELY", None)
