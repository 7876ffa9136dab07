"""Compiled programs are kept with their world, and shared by the searches in it."""

import pickle
from concurrent.futures import ThreadPoolExecutor

import cdlc
import crow
from benchmarks.serial import stacking
from benchmarks.towers import random_towers
from crow.search.compile import Programs


def test_a_world_has_its_programs_once() -> None:
    problem = stacking(*random_towers(4, 0))
    first = Programs.of(problem.world)
    crow.plan(problem)
    assert Programs.of(problem.changed(goal=problem.goal).world) is first


def test_threads_plan_in_one_world() -> None:
    problem = cdlc.load_problem("examples/blocks/sussman.cdl")
    alone = crow.plan(cdlc.load_problem("examples/blocks/sussman.cdl"), engine="iddfs")
    with ThreadPoolExecutor(4) as threads:
        plans = list(threads.map(lambda _: crow.plan(problem, engine="iddfs"), range(12)))
    assert isinstance(alone, crow.Plan)
    assert all(isinstance(plan, crow.Plan) and plan.steps == alone.steps for plan in plans)


def test_a_problem_that_was_planned_for_can_be_pickled() -> None:
    problem = stacking(*random_towers(4, 0))
    planned = crow.plan(problem)
    again = crow.plan(pickle.loads(pickle.dumps(problem)))
    assert isinstance(planned, crow.Plan)
    assert isinstance(again, crow.Plan)
    assert again.steps == planned.steps
