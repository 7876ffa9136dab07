"""Plans judged by the validators of others, in a process of their own."""

import pytest

from cdlc.backends.engines import (
    EngineFailed,
    EngineMissing,
    PddlStep,
    catalogue,
    installed,
    validate,
)

if "kairos" not in installed():
    pytest.skip("needs the extra `planners`", allow_module_level=True)

DOMAIN = """
(define (domain Door) (:requirements :strips)
  (:predicates (Open ?d) (locked ?d))
  (:action Unlock :parameters (?d) :precondition (locked ?d) :effect (not (locked ?d)))
  (:action push :parameters (?d) :precondition (and (not (locked ?d))) :effect (Open ?d)))
"""
PROBLEM = """(define (problem P) (:domain Door) (:objects Front) (:init (locked Front))
  (:goal (Open Front)))"""
DERIVED = DOMAIN.replace(
    "(locked ?d))\n", "(locked ?d) (way ?d))\n  (:derived (way ?d) (Open ?d))\n"
)
BY_AXIOM = PROBLEM.replace("(:goal (Open", "(:goal (way")
UNLOCK, PUSH = PddlStep("Unlock", ("Front",)), PddlStep("push", ("Front",))


@pytest.mark.parametrize(
    ("domain", "problem", "by"),
    [(DOMAIN, PROBLEM, "unified-planning"), (DERIVED, BY_AXIOM, "kairos")],
)
def test_plans_are_judged(domain: str, problem: str, by: str) -> None:
    verdict = validate(domain, problem, [UNLOCK, PUSH])
    assert verdict is not None
    assert (verdict.by, verdict.is_valid, verdict.reason) == (by, True, "")
    for wrong in ([PUSH], [UNLOCK], [], [UNLOCK, PUSH, PddlStep("fly", ("Front",))]):
        verdict = validate(domain, problem, wrong)
        assert verdict is not None
        assert (verdict.by, verdict.is_valid) == (by, False)
        assert verdict.reason


def test_a_time_limit_gives_no_verdict() -> None:
    assert validate(DOMAIN, PROBLEM, [UNLOCK, PUSH], time_limit=0.01) is None


def test_text_that_is_no_pddl_is_an_error() -> None:
    with pytest.raises(EngineFailed, match="cannot read the PDDL"):
        validate("(define", PROBLEM, [])


def test_without_a_validator_the_cure_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(catalogue, "find_spec", lambda _: None)
    with pytest.raises(EngineMissing, match=r"cdlc\[planners\]"):
        validate(DOMAIN, PROBLEM, [])
