"""Plans of the runtime are plans of the emitted PDDL: by the validators of others."""

import random
from itertools import islice
from pathlib import Path

import pytest
from programs import emitted, problem_of, task_of
from small_programs import small_program
from support import EXAMPLES

import crow
from cdlc.backends.pddl.fit import report_unplannable
from cdlc.backends.pddl.inverse import to_pddl_plan
from crow.planning import Planning

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")

DOMAINS = {
    "blocks": (EXAMPLES / "blocks" / "blocks.cdl").read_text(),
    "strips": (EXAMPLES / "blocks" / "blocks_strips.cdl").read_text(),
}


def check(domain: str, problem: str) -> crow.Result:
    """Plan, and validate the plan as one of the emitted task."""
    from unified_planning.engines.plan_validator import SequentialPlanValidator
    from unified_planning.io import PDDLReader
    from unified_planning.plans import ActionInstance, SequentialPlan

    stated = problem_of(domain, problem)
    result = crow.plan(stated, time_limit=60)
    assert isinstance(result, crow.Plan), result
    task = task_of(domain, problem)
    assert task.problem is not None
    pddl = PDDLReader().parse_problem_string(task.domain, task.problem)
    actions = {action.name.lower(): action for action in pddl.actions}
    instances = []
    for step in to_pddl_plan(task, stated, result):
        objects = [pddl.object(argument.lower()) for argument in step.arguments]
        instances.append(ActionInstance(actions[step.action.lower()], objects))
    verdict = SequentialPlanValidator().validate(pddl, SequentialPlan(instances))
    assert verdict, (result.steps, verdict)
    return result


def strip_domain(file: Path) -> str:
    """A problem file without the line that names its domain."""
    return "\n".join(
        line for line in file.read_text().splitlines() if not line.startswith("domain ")
    )


@pytest.mark.parametrize(
    ("domain", "problem"),
    [
        ("tutorial/rooms", "tutorial/swap"),
        ("kitchen/kitchen", "kitchen/tidy"),
        ("blocks/blocks", "blocks/sussman"),
        ("blocks/blocks_strips", "blocks/sussman"),
        ("briefcase/briefcase", "briefcase/payday"),
        ("cupboard/cupboard", "cupboard/dishes"),
    ],
)
def test_examples(domain: str, problem: str) -> None:
    text = (EXAMPLES / f"{domain}.cdl").read_text()
    assert check(text, strip_domain(EXAMPLES / f"{problem}.cdl")).steps


def towers(rng: random.Random, names: list[str]) -> list[tuple[str, str | None]]:
    """Each block with what it stands on."""
    placed: list[tuple[str, str | None]] = []
    free: list[str] = []
    for name in rng.sample(names, len(names)):
        below = rng.choice([None, *free])
        if below is not None:
            free.remove(below)
        placed.append((name, below))
        free.append(name)
    return placed


def random_blocks(seed: int) -> str:
    rng = random.Random(seed)
    names = ["a", "b", "c"]
    start, goal = towers(rng, names), towers(rng, names)
    lines = ['problem "random"', "objects:", "  a, b, c: block", "init:", "  handempty[...] = True"]
    for name, below in start:
        lines.append(f"  {'on_table' if below is None else 'on'}[{name}"
                     f"{'' if below is None else f', {below}'}] = True")  # fmt: skip
    covered = {below for _, below in start}
    lines += [f"  clear[{name}] = True" for name in names if name not in covered]
    wanted = [f"on_table({n})" if below is None else f"on({n}, {below})" for n, below in goal]
    rng.shuffle(wanted)
    return "\n".join([*lines, f"goal: {' and '.join(wanted)}"]) + "\n"


@pytest.mark.parametrize("seed", range(12))
def test_random_blocks(seed: int) -> None:
    """All pairs of three blocks are solved by the program of Fig. 4."""
    check(DOMAINS["blocks"], random_blocks(seed))


@pytest.mark.slow
@pytest.mark.parametrize("domain", DOMAINS)
def test_more_random_blocks(domain: str) -> None:
    for seed in range(100, 250):
        check(DOMAINS[domain], random_blocks(seed))


def validated_plans(seed: int) -> int:
    """How many plans of a random program are valid in its PDDL, by Kairos; all have to be."""
    kairos = pytest.importorskip("kairos")
    small = small_program(seed)
    task, found, problem = emitted(small.domain, small.problem)
    if task is None or problem is None or found.has_errors:
        return 0
    report_unplannable(problem.world.program, found)
    if found.has_errors:
        return 0
    count = 0
    for plan in islice(Planning(problem, node_limit=1_000, time_limit=20).plans(), 4):
        steps = to_pddl_plan(task, problem, plan)
        text = "".join(f"({' '.join((s.action, *s.arguments))})\n" for s in steps)
        report = kairos.validate_plan(task.domain, task.problem, kairos.parse_plan(text))
        assert report.status == kairos.ValidationStatus.VALID, (seed, text, report.diagnostics)
        count += bool(steps)
    return count


def test_plans_of_random_programs() -> None:
    assert sum(map(validated_plans, range(120))) >= 10


@pytest.mark.slow
def test_plans_of_many_random_programs() -> None:
    assert sum(map(validated_plans, range(1_000, 4_000))) >= 400
