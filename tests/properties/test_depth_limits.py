"""Answers under a limit: never `unsolvable` where a deeper plan is, and always the same."""

import json
import subprocess
import sys
from collections import Counter
from functools import cache

import pytest
from oracle import ENGINES, OverTheCapError, answer, reference
from programs import checked_domain, checked_problem, problem_of
from small_programs import small_program
from support import EXAMPLES, ROOT

from crow.planning import Planning
from crow.problem import Problem
from crow.results import LimitReached, Plan, Unsolvable

MOST_NODES = 10_000
EVERY_ENGINE = (*ENGINES, ("reference", "ff"))


def hold_limits(problem: Problem, deepest: int, told: Counter[str]) -> None:
    """Compare the answers at each tighter limit with the reference at the deepest."""
    found = [reference(problem, depth, MOST_NODES) for depth in range(deepest + 1)]
    for depth, expected in enumerate(found[:-1]):
        for engine, heuristic in EVERY_ENGINE:
            result = answer(problem, engine, heuristic, depth)
            about = (engine, heuristic, depth, result)
            assert isinstance(result, Plan) == bool(expected.plans), about
            told[f"{type(result).__name__} at {depth}"] += 1
            if isinstance(result, Unsolvable):
                assert not any(deeper.plans for deeper in found), about
            if isinstance(result, LimitReached) and found[-1].plans:
                told["deeper"] += 1
    if not found[-1].is_cut and not found[-1].plans:
        told["exhausted"] += 1
        for engine, heuristic in ENGINES:
            # Widening searches each width to its end.
            most = 100_000 if engine == "iw" else 3_000
            ended = Planning(problem, engine, h=heuristic, node_limit=most).first()
            assert isinstance(ended, Unsolvable), (engine, heuristic, ended)


def hold_limits_of(first: int, number: int, deepest: int) -> Counter[str]:
    told: Counter[str] = Counter()
    for seed in range(first, first + number):
        small = small_program(seed)
        try:
            hold_limits(problem_of(small.domain, small.problem), deepest, told)
        except OverTheCapError:
            told["over the cap"] += 1
        except AssertionError as error:
            raise AssertionError(f"seed {seed}\n{small.domain}{small.problem}") from error
    checked_domain.cache_clear()
    checked_problem.cache_clear()
    return told


@pytest.mark.parametrize("part", range(2))
def test_no_engine_gives_up_where_a_deeper_plan_is(part: int) -> None:
    told = hold_limits_of(30_000 + 1_000 * part, 100, 2)
    assert told["over the cap"] < 20
    assert told["deeper"] >= 20, told
    assert told["exhausted"] >= 5, told
    assert told["Unsolvable at 0"] >= 10, told
    assert told["LimitReached at 1"] >= 10, told


@pytest.mark.slow
@pytest.mark.parametrize("part", range(10))
def test_no_engine_gives_up_where_a_much_deeper_plan_is(part: int) -> None:
    told = hold_limits_of(200_000 + 1_000 * part, 200, 3)
    assert told["deeper"] >= 60, told
    assert told["exhausted"] >= 10, told


# ------------------------------------------------------------------------------------- determinism

FILES = ["blocks/sussman", "kitchen/tidy", "logistics/parcel", "briefcase/payday"]


@cache
def outcomes() -> list[object]:
    """What each engine says with a node limit, statistics included but for the time."""
    problems = {}
    for seed in range(40, 50):
        small = small_program(seed)
        problems[f"seed {seed}"] = problem_of(small.domain, small.problem)
    from cdlc.driver import problem_compilation

    for name in FILES:
        problems[name] = problem_compilation([str(EXAMPLES / f"{name}.cdl")]).problem
    told: list[object] = []
    for name, problem in problems.items():
        for engine, heuristic in EVERY_ENGINE:
            document = Planning(problem, engine, h=heuristic, seed=1, node_limit=300).first().json()
            del document["statistics"]["seconds"]
            told.append([name, engine, heuristic, document])
    return json.loads(json.dumps(told))  # type: ignore[no-any-return]


@pytest.mark.parametrize("hash_seed", ["0", "1"])
def test_the_same_in_another_process(hash_seed: str) -> None:
    paths = [ROOT, ROOT / "runtime", ROOT / "tests", ROOT / "tests" / "properties"]
    program = (
        f"import sys, json\nsys.path[:0] = {[str(p) for p in paths]!r}\n"
        "import test_depth_limits\nprint(json.dumps(test_depth_limits.outcomes()))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        env={"PYTHONHASHSEED": hash_seed},
        check=True,
        timeout=300,
    )
    other = json.loads(done.stdout)
    own = outcomes()
    assert len(own) == len(other)
    for mine, theirs in zip(own, other, strict=True):
        assert mine == theirs
    assert {"plan", "limit", "unsolvable"} <= {entry[3]["status"] for entry in own}  # type: ignore[index]
