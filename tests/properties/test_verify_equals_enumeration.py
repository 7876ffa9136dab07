"""Verdicts about random behaviors against every small state, run by the interpreter alone."""

import pytest
from hypothesis import HealthCheck, Phase, event, given, settings
from programs import program_of
from small_claims import claims, outcomes

from cdlc.verify.run import verify
from crow.transition import apply

SETTINGS = settings(
    deadline=None,
    max_examples=30,
    suppress_health_check=list(HealthCheck),
    phases=[Phase.explicit, Phase.reuse, Phase.generate],
)


def compare(text: str) -> None:
    program = program_of(text)
    (verified,) = verify("d", program, 10).behaviors
    checks = {check.name: check for check in verified.checks}
    if "model" in checks:
        event("no model")
        return
    small = outcomes(program)
    for name, expected in (
        ("goal", "refuted" if small.fails_its_goal else None),
        ("applicable", "proved" if small.is_applicable else None),
        ("writes", "refuted" if small.has_conflict else None),
    ):
        if name not in checks:
            assert expected is None, (name, text)
            continue
        verdict = str(checks[name].verdict)
        event(f"{name} {verdict}")
        if checks[name].reason.endswith(")") and "has no formula" in checks[name].reason:
            continue
        if expected is not None:
            # What happens in a small state is found, and nothing else is ever claimed.
            assert verdict == expected, (name, checks[name].reason, text)
        elif name == "applicable" and verdict == "proved":
            event("applicable in larger states only")
    example = checks["goal"].example if "goal" in checks else None
    if example is not None:
        situation = example.situation
        ran = apply(
            situation.world,
            situation.state,
            situation.way.behavior,
            situation.arguments,
            situation.bindings,
        )
        assert ran.problem is None


@given(claims())
@SETTINGS
def test_verdicts_are_what_enumeration_says(text: str) -> None:
    compare(text)


@pytest.mark.slow
@given(claims())
@settings(SETTINGS, max_examples=1_000)
def test_many_verdicts_are_what_enumeration_says(text: str) -> None:
    compare(text)
