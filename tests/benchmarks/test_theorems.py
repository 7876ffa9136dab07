"""What the experiments claim: theorems 1 and 2, commit, sparse objects, and stacking."""

from itertools import pairwise

import pytest

import crow
from benchmarks.commit import stages
from benchmarks.fit import exponential, power
from benchmarks.htn import stacked
from benchmarks.objects import DOMAIN, house
from benchmarks.problems import from_texts
from benchmarks.serial import positions, stacking
from benchmarks.thm1 import places, told
from benchmarks.thm2 import doors
from benchmarks.towers import names, on, random_towers
from crow.search.engine import CrowEngine


@pytest.mark.parametrize("engine", ["iddfs", "iw", "auto", "reference"])
def test_a_plan_of_depth_d_is_found_at_d_and_not_before(engine: str) -> None:
    for depth in range(1, 7 if engine == "reference" else 21):
        task = places(depth)
        assert told(crow.plan(task, engine, depth_limit=depth - 1)) == "limit: depth"
        result = crow.plan(task, engine, depth_limit=depth)
        assert isinstance(result, crow.Plan)
        assert len(result.steps) == depth
        if engine != "auto":  # there best-first search may be the one that finds it
            assert result.statistics["depth"] == depth


@pytest.mark.parametrize("engine", ["iddfs", "iw", "auto", "best", "reference"])
def test_a_space_that_is_exhausted_is_reported_as_such(engine: str) -> None:
    for depth in (1, 2, 5) if engine == "reference" else range(1, 21):
        result = crow.plan(places(depth, has_way=False), engine)
        assert isinstance(result, crow.Unsolvable)
        assert engine == "reference" or result.explanation is not None


@pytest.mark.parametrize("width", [1, 2, 3])
def test_a_width_takes_polynomially_many_nodes(width: int) -> None:
    sizes = (36, 72, 108)
    results = [crow.plan(doors(width, size, is_serial=True), "iw") for size in sizes]
    assert [r.statistics["width"] for r in results] == [width] * 3
    nodes = [float(r.statistics["nodes"]) for r in results]
    assert power(sizes, nodes).value <= 2 * width
    assert power(sizes, nodes).quality > exponential(sizes, nodes).quality
    if width > 1:
        narrower = CrowEngine(doors(width, 36, is_serial=True), lambda _: None, width=width - 1)
        assert list(narrower.round(9)) == []
        assert narrower.left_out() == ("width",)


def test_without_serialisation_nodes_grow_exponentially() -> None:
    sizes = (12, 24, 36, 48)
    results = [crow.plan(doors(1, size, is_serial=False), "iddfs") for size in sizes]
    nodes = [float(r.statistics["nodes"]) for r in results]
    assert exponential(sizes, nodes).quality > power(sizes, nodes).quality
    ratios = [after / before for before, after in pairwise(nodes)]
    assert ratios == sorted(ratios)  # those of a polynomial fall


def test_commit_makes_linear_what_is_exponential() -> None:
    without = [crow.plan(stages(n, commits=False), "iddfs").statistics["nodes"] for n in (4, 6, 8)]
    assert without[1] > 3 * without[0]
    assert without[2] > 3 * without[1]
    counts = (5, 10, 20, 40)
    found = [crow.plan(stages(n, commits=True), "iddfs").statistics["nodes"] for n in counts]
    points = zip(counts, found, strict=True)
    slopes = {(b - a) / (n - m) for (m, a), (n, b) in pairwise(points)}
    assert len(slopes) == 1


@pytest.mark.parametrize("engine", ["iddfs", "iw", "best", "auto"])
def test_commit_loses_a_plan_and_says_so(engine: str) -> None:
    lost = crow.plan(stages(4, commits=True, is_fussy=True), engine)
    assert told(lost) == "limit: commit"
    kept = crow.plan(stages(4, commits=False, is_fussy=True), engine)
    assert isinstance(kept, crow.Plan)
    assert kept.steps[0].arguments == ("s1", "other")


def test_planning_among_many_objects_tries_no_more_than_among_few() -> None:
    tasks = [from_texts(DOMAIN, house(count)[0]) for count in (1_000, 10_000)]
    for engine in ("auto", "iddfs", "best"):
        results = [crow.plan(task, engine) for task in tasks]
        assert all(len(result.steps) == 20 for result in results)
        few, many = (result.statistics["nodes"] for result in results)
        assert many <= 2 * few


def test_stacking_is_about_as_good_as_gtpyhop_s() -> None:
    pytest.importorskip("gtpyhop")
    ours, theirs = 0, 0
    for seed in range(3):
        start, pairs = random_towers(40, seed)
        result = crow.plan(stacking(start, pairs))
        ours += sum(step.controller is not None for step in result.steps)
        blocks = names(40)
        told_ = stacked(positions(blocks, on(start)), positions(blocks, pairs), 60)
        assert not isinstance(told_, str), told_
        theirs += told_[1]
    assert ours <= 1.05 * theirs
