"""Verdicts about random behaviors against every small state, run by the interpreter alone."""

import pytest
from hypothesis import HealthCheck, Phase, event, given, settings
from programs import program_of
from small_claims import claims, outcomes

from cdlc.verify.run import verify
from crow.evaluate import holds
from crow.transition import apply

SETTINGS = settings(
    deadline=None,
    max_examples=30,
    suppress_health_check=list(HealthCheck),
    phases=[Phase.explicit, Phase.reuse, Phase.generate],
)


def is_excused(reason: str) -> bool:
    """Whether a check may be undecided: the model says less than the interpreter does.

    It leaves out a division whose result makes no difference, the `if` around a `foreach`, and what
    is read from cells that a `foreach` computes.
    """
    return any(
        text in reason
        for text in ("division by zero", "the iterations agree when it is run", "has no formula")
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
        if verdict == "unknown" and is_excused(checks[name].reason):
            event(f"{name}: {checks[name].reason[:60]}")
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
        goal = situation.way.behavior.goal
        assert goal is not None
        names = [p.name for p in situation.way.behavior.parameters]
        values = dict(zip(names, situation.arguments, strict=True))
        assert not holds(situation.world, ran.state, goal, values)
        assert 0 <= situation.state.cells.get(("n", ()), 0) <= 3  # type: ignore[operator]


@given(claims())
@SETTINGS
def test_verdicts_are_what_enumeration_says(text: str) -> None:
    compare(text)


@pytest.mark.slow
@given(claims())
@settings(SETTINGS, max_examples=1_000)
def test_many_verdicts_are_what_enumeration_says(text: str) -> None:
    compare(text)
