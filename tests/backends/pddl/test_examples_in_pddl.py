"""The examples through planners: found, validated by two others, mapped back and replayed."""

from dataclasses import dataclass
from pathlib import Path

import pytest
from support import EXAMPLES, ROOT

from benchmarks.translator import task_size
from cdlc.backends.engines import PddlStep, installed, solve
from cdlc.backends.pddl import PddlTask, to_step
from cdlc.backends.pddl.solve import run
from cdlc.driver import Compilation
from crow.replay import replay_to_goal

kairos = pytest.importorskip("kairos")
if "fast-downward" not in installed():
    pytest.skip("needs the extra `planners`", allow_module_level=True)


@dataclass(frozen=True)
class Example:
    """A problem, the engines that take it, and the length of its shortest plan."""

    problem: str
    engines: tuple[str, ...]
    shortest: int

    @property
    def file(self) -> Path:
        return EXAMPLES / self.problem


BOTH = ("fast-downward", "kairos")
CASES = [
    Example("gripper/four.cdl", BOTH, 11),
    Example("logistics/parcel.cdl", BOTH, 13),
    Example("jugs/four.cdl", ("kairos",), 6),
    Example("briefcase/payday.cdl", BOTH, 4),
    Example("cupboard/dishes.cdl", ("kairos", "fast-downward"), 8),
]
# A run takes seconds: the first engine of each by default.
RUNS = [
    pytest.param(
        case, engine, marks=[pytest.mark.slow] if index else [], id=f"{case.problem}-{engine}"
    )
    for case in CASES
    for index, engine in enumerate(case.engines)
]


def compilation(case: Example) -> Compilation:
    return Compilation(None, str(case.file))


def is_valid(task: PddlTask, steps: tuple[PddlStep, ...]) -> bool:
    """What Kairos' validator, which shares no code with ours or unified-planning's, says."""
    text = "".join(f"({' '.join((s.action, *s.arguments))})\n" for s in steps)
    report = kairos.validate_plan(task.domain, task.problem, kairos.parse_plan(text))
    return bool(report.status == kairos.ValidationStatus.VALID)


@pytest.mark.parametrize(("case", "engine"), RUNS)
def test_plans_are_found_validated_and_replayed(case: Example, engine: str) -> None:
    compiled = compilation(case)
    task, problem = compiled.pddl, compiled.problem
    assert task.problem is not None
    # unified-planning validates what an engine returns.
    solved = solve(task.domain, task.problem, engine=engine, time_limit=60)
    assert is_valid(task, solved.steps)
    assert not is_valid(task, solved.steps[:-1])
    planned = [
        to_step(task, problem.world, step.action, step.arguments, number)
        for number, step in enumerate(solved.steps, 1)
    ]
    steps, trace = run(problem, planned)
    assert replay_to_goal(problem, trace).failure is None
    assert len(steps) >= case.shortest


@pytest.mark.parametrize("name", ["gripper", "logistics", "briefcase", "cupboard"])
def test_the_task_is_no_larger_than_one_written_by_hand(name: str) -> None:
    (case,) = (c for c in CASES if c.problem.startswith(name))
    task = compilation(case).pddl
    assert task.problem is not None
    by_hand = (ROOT / "benchmarks" / "handwritten" / f"{name}.pddl").read_text()
    assert task_size(task.domain, task.problem) == task_size(by_hand, task.problem)
