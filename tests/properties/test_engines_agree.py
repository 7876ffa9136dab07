"""The oracle: the CROW engine against the reference engine, on the corpus and on random programs.

Without pruning both enumerate the same plans up to a depth; with it the answers are the same, and
every plan is one of the reference's. Every plan replays; that it is one of the emitted PDDL, too,
is tested in test_native_plans_in_pddl.py.
"""

from collections import Counter
from collections.abc import Callable

import pytest
from corpus import BLOCKS_PROGRAMS, CASES, TOWERS, blocks_problem, listings_with_behaviors
from oracle import ENGINES, MOST_NODES, OverTheCapError, compare
from programs import checked_domain, checked_problem, problem_of
from small_programs import CONSTRUCTS, small_program

from crow.search import strategies


@pytest.mark.parametrize("name", CASES)
def test_corpus(name: str) -> None:
    case = CASES[name]
    for depth in range(case.depth + 1):
        found = compare(problem_of(case.domain, case.problem), depth, most_forward=MOST_NODES)
        assert bool(found.plans) == (case.needs is not None and depth >= case.needs), depth


def test_every_plannable_listing_is_compared() -> None:
    assert listings_with_behaviors() == {n for n in CASES if n.startswith("listing ")}


@pytest.mark.parametrize("program", BLOCKS_PROGRAMS)
@pytest.mark.parametrize("tower", TOWERS)
def test_blocks(program: str, tower: str) -> None:
    problem = blocks_problem(program, tower)
    for depth in (0, 1, 2):
        try:
            compare(problem, depth, 20_000)
        except OverTheCapError:
            assert depth == 2  # much of it promotable, the reference goes on for hours


def test_binds_in_either_order_are_one_plan() -> None:
    domain = """
typedef T
object_constant home: T
feature r()
controller c()
behavior b():
  goal: r()
  body:
    unordered:
      bind v: T
      bind w: T
    do c()
  eff:
    r[...] = True
"""
    found = compare(problem_of(domain, 'problem "p"\ngoal: r()\n'), 1)
    assert len(found.plans) == 1


def compare_random(
    first: int, number: int, depth: int, engines: Callable[[int], tuple[tuple[str, str], ...]]
) -> Counter[str]:
    """Compare on so many random programs, those over the cap redrawn; count what they were like."""
    told: Counter[str] = Counter()
    seed = first
    while told["compared"] < number:
        small = small_program(seed)
        try:
            found = compare(problem_of(small.domain, small.problem), depth, engines=engines(seed))
        except OverTheCapError:
            told["over the cap"] += 1
        except AssertionError as error:
            raise AssertionError(f"seed {seed}\n{small.domain}{small.problem}") from error
        else:
            told["compared"] += 1
            told["solvable"] += bool(found.plans)
            told["long"] += any(len(plan) > 1 for plan in found.plans)
            told.update({mark for name in found.applied for mark in small.marks[name]})
            told["interesting"] += any(small.marks[name] for name in found.applied)
            told.update(name for name, words in CONSTRUCTS.items() if words.search(small.domain))
        seed += 1
    checked_domain.cache_clear()
    checked_problem.cache_clear()
    return told


def check_the_mix(told: Counter[str], record_property: Callable[[str, object], None]) -> None:
    """Most programs are compared, and they are worth it."""
    for name, number in told.items():
        record_property(name, number)
    compared = told["compared"]
    assert told["over the cap"] < 0.2 * (compared + told["over the cap"]), told
    assert told["interesting"] >= 0.25 * compared, told
    assert told["solvable"] >= 0.2 * compared, told
    for name in ("interleaving", "acting L", "established by a child", *CONSTRUCTS):
        assert told[name] >= 0.02 * compared, (name, told)


def shorten_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have both searches of `auto` at work on programs that one turn would be enough for."""
    monkeypatch.setattr(strategies, "DEEPENING_TURN", 8)
    monkeypatch.setattr(strategies, "BEST_TURN", 40)


def by_turns(seed: int) -> tuple[tuple[str, str], ...]:
    """Best-first search with one of its heuristics, alone or within `auto`."""
    return (ENGINES[1 + seed % 4],)


@pytest.mark.parametrize("part", range(20))
def test_random_programs(
    part: int,
    record_property: Callable[[str, object], None],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """2,000 programs to depth 2."""
    shorten_turns(monkeypatch)
    check_the_mix(compare_random(part * 1_000, 100, 2, by_turns), record_property)


@pytest.mark.slow
@pytest.mark.parametrize("part", range(10))
def test_many_random_programs(
    part: int,
    record_property: Callable[[str, object], None],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """5,000 programs to depth 3, with every engine."""
    shorten_turns(monkeypatch)
    told: Counter[str] = Counter()
    for block in range(5 * part, 5 * part + 5):
        told += compare_random(100_000 + block * 1_000, 100, 3, lambda _: ENGINES)
    check_the_mix(told, record_property)
