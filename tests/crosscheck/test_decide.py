"""Two answers to one outcome, every pair of them."""

import itertools

import pytest

from cdlc.crosscheck.decide import decide
from cdlc.crosscheck.results import Comparison, Outcome, Side, outcome_of_all
from crow.plan import Result

STOPS = {"limit": "l", "timeout": "t", "memory": "m"}


def side(status: str, fault: str = "", unchecked: str = "") -> Side:
    stop = STOPS.get(status, "")
    return Side(Result(status, "engine"), fault=fault, unchecked=unchecked, stop=stop)


DECIDED = {
    ("plan", "plan"): Outcome.AGREE_PLAN,
    ("unsolvable", "unsolvable"): Outcome.AGREE_NONE,
    ("plan", "unsolvable"): Outcome.OUTSIDE,
    ("unsolvable", "plan"): Outcome.MISMATCH,
}


@pytest.mark.parametrize(
    ("planner", "program"), [*itertools.product(["plan", "unsolvable", *STOPS], repeat=2)]
)
def test_every_pair_of_answers_has_one_outcome(planner: str, program: str) -> None:
    outcome, reason = decide(side(planner), side(program))
    assert outcome is DECIDED.get((planner, program), Outcome.INCONCLUSIVE)
    if outcome is Outcome.INCONCLUSIVE:
        stops = [STOPS[status] for status in (planner, program) if status in STOPS]
        assert reason == "; ".join(stops)
    assert bool(reason) is (outcome not in (Outcome.AGREE_PLAN, Outcome.AGREE_NONE))


@pytest.mark.parametrize("other", ["plan", "unsolvable", *STOPS])
def test_a_plan_that_the_other_side_does_not_take_is_a_mismatch_whatever_else(other: str) -> None:
    wrong = side("plan", "it does not replay")
    assert decide(wrong, side(other)) == (Outcome.MISMATCH, "it does not replay")
    assert decide(side(other), wrong) == (Outcome.MISMATCH, "it does not replay")


def test_a_plan_that_could_not_be_checked_does_not_agree() -> None:
    outcome, reason = decide(side("plan"), side("plan", unchecked="no time"))
    assert (outcome, reason) == (Outcome.INCONCLUSIVE, "no time")


def test_what_is_wrong_weighs_more_than_what_is_open() -> None:
    def worst(*outcomes: Outcome) -> Outcome:
        return outcome_of_all(Comparison("p", outcome) for outcome in outcomes)

    assert worst() is Outcome.AGREE_PLAN
    assert worst(Outcome.AGREE_NONE) is Outcome.AGREE_PLAN
    assert worst(Outcome.NOT_COMPARABLE, Outcome.OUTSIDE, Outcome.AGREE_PLAN) is Outcome.OUTSIDE
    assert worst(Outcome.INCONCLUSIVE, Outcome.ERROR, Outcome.OUTSIDE) is Outcome.ERROR
    assert worst(Outcome.ERROR, Outcome.MISMATCH) is Outcome.MISMATCH
