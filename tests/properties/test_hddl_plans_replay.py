"""HDDL of random programs: unified-planning reads it, and Aries' plans are plans of the program."""

import random
import re
from collections import Counter
from collections.abc import Callable

import pytest
from hddl_tasks import Stated
from htn_planner import answers_of
from programs import emitted
from small_programs import Maker

import crow
from cdlc.backends.hddl import to_hddl
from cdlc.backends.pddl import to_step
from cdlc.backends.pddl.solve import run
from crow.problem import Problem

pytest.importorskip("unified_planning")


class WithoutNumbers(Maker):
    """Draws programs that HDDL has a form for, but for some calls."""

    def literal(self, scope: list[str]) -> str:
        while "n()" in (drawn := super().literal(scope)):
            pass
        return drawn

    def effect(self, goal: str | None, scope: list[str]) -> list[str]:
        return [line for line in super().effect(goal, scope) if line[:2] != "n "] or ["pass"]

    def goal(self, arity: int) -> tuple[str, str]:
        while "k" in (drawn := super().goal(arity))[0].split():
            pass
        return drawn

    def domain(self) -> str:
        return re.sub("feature .* n().*\n", "", super().domain())


def drawn(seeds: range, told: Counter[str]) -> dict[str, Stated]:
    """The programs of some seeds that have HDDL; the others are refused for a reason."""
    found: dict[str, Stated] = {}
    for seed in seeds:
        maker = WithoutNumbers(random.Random(seed))
        domain = maker.domain()
        pddl, reported, problem = emitted(domain, maker.problem(maker.rng.randrange(1, 4)))
        if reported.has_errors:  # some behavior has no Hoare model
            told["no model"] += 1
            continue
        assert pddl is not None
        assert problem is not None
        task = to_hddl(pddl, problem, reported)
        if task is None:
            told["refused"] += 1
            assert {d.code for d in reported if d.severity == "error"} == {"not-in-format"}
        else:
            found[str(seed)] = Stated(task, problem)
    return found


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_random_tasks_are_read() -> None:
    from unified_planning.io import PDDLReader

    told: Counter[str] = Counter()
    tasks = drawn(range(20), told)
    assert len(tasks) > 7
    for task in tasks.values():
        problem = PDDLReader().parse_problem_string(*task.texts)
        achieved = {method.achieved_task.task.name for method in problem.methods}
        assert achieved <= {each.name for each in problem.tasks}


# What Aries does not take: quantifiers, `when`, and a conjunction within another formula.
BEYOND = re.compile(r"\((?:exists|forall|when|not \(and|or[^\n]*\(and)")


def check(seeds: range) -> Counter[str]:
    told: Counter[str] = Counter()
    drawn_ = drawn(seeds, told)
    tasks = {n: task for n, task in drawn_.items() if not BEYOND.search("".join(task.texts))}
    answers = answers_of({name: task.texts for name, task in tasks.items()}, seconds=2)
    for name, (status, steps) in answers.items():
        assert status != "INTERNAL_ERROR", name
        task, problem = tasks[name]
        if steps is None:
            told[_without_plan(problem, status)] += 1
            continue
        told["plan"] += 1
        world = problem.world
        planned = [to_step(task.pddl, world, a, objects, i) for i, (a, objects) in enumerate(steps)]
        run(problem, planned)  # raises InvalidPlan
    return told


def _without_plan(problem: Problem, status: str) -> str:
    if not status.startswith("UNSOLVABLE"):
        return "no answer"
    return f"none, and the program: {crow.plan(problem, time_limit=5).status}"


def test_plans_of_random_tasks_replay(record_property: Callable[[str, object], None]) -> None:
    pytest.importorskip("up_aries")
    told = check(range(60))
    record_property("tasks", dict(told))
    assert told["plan"] >= 2
    assert told["none, and the program: unsolvable"] >= 2
    # Only `promotable sequential` may lack orders that the program has; it does in none of these.
    assert not told["none, and the program: plan"]


@pytest.mark.slow
def test_plans_of_many_random_tasks_replay(record_property: Callable[[str, object], None]) -> None:
    pytest.importorskip("up_aries")
    for start in range(100, 2_000, 100):
        record_property(f"tasks from {start}", dict(check(range(start, start + 100))))
