"""The refinement tree of any engine's plan accounts for all of the plan."""

from collections import Counter

import pytest
from programs import problem_of
from refinements import check_tree
from small_programs import small_program

from crow.planning import Planning
from crow.refinement import Kind
from crow.results import Plan

ENGINES = ("iddfs", "best", "auto", "reference")


def check_random(seeds: range) -> Counter[str]:
    told: Counter[str] = Counter()
    for seed in seeds:
        small = small_program(seed)
        problem = problem_of(small.domain, small.problem)
        for engine in ENGINES:
            planning = Planning(problem, engine, depth_limit=2, node_limit=3_000)
            plan = planning.first()
            tree = planning.refinement()
            if not isinstance(plan, Plan):
                told["failed"] += any(node.kind is Kind.FAILED for node in tree.nodes)
                continue
            told["plans"] += 1
            told["nested"] += any(node.level > 2 for node in tree.nodes)
            try:
                check_tree(problem, plan, tree)
            except AssertionError as error:
                text = f"seed {seed}, {engine}\n{small.domain}{small.problem}"
                raise AssertionError(text) from error
    return told


def test_trees_of_random_programs() -> None:
    told = check_random(range(60, 150))
    assert told["plans"] > 50
    assert told["nested"] >= 2
    assert told["failed"] > 10


@pytest.mark.slow
def test_trees_of_many_random_programs() -> None:
    check_random(range(20_000, 23_000))
