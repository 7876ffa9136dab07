"""Programs with functions in Python plan as those with the same functions in CDL."""

import pytest
from oracle import ENGINES, answer, compare
from towers_in_python import IN_CDL, OUTSIDE, PYTHON, READING_ALL, towers

import crow
from crow.planning import NotPlannable
from crow.replay import replay_to_goal

CASES = {
    "one upon another": ("pass", "on(A, B)", 3),
    "turned over": ("on[C, A] = True", "on(A, C)", 4),
    "too dear": ("on[C, A] = True", "on(A, B) and price(A) < 2", 3),
    "uncovered": ("on[A, B] = True", "clear(B)", 3),
    "uncovered from the top": ("on[A, B] = True\n  on[B, C] = True", "clear(C)", 4),
    "two of them": ("on[A, B] = True", "clear(B) and spent == 2", 1),
    "in the hand": ("holding[C] = True", "handempty() and spent == 0", 1),
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("outside", [OUTSIDE, READING_ALL], ids=["reads", "reads all"])
def test_all_engines_find_the_same_plans(case: str, outside: str) -> None:
    init, goal, depth = CASES[case]
    in_cdl, in_python = towers(IN_CDL, init, goal), towers(outside, init, goal, PYTHON)
    for most in range(depth + 1):
        expected = compare(in_cdl, most)
        found = compare(in_python, most)
        assert found.plans == expected.plans
        assert found.is_cut == expected.is_cut


@pytest.mark.parametrize(("engine", "heuristic"), ENGINES)
def test_longer_plans_replay(engine: str, heuristic: str) -> None:
    init, goal = "on[A, B] = True\n  on[B, C] = True", "on(C, B) and on(B, A)"
    problem = towers(OUTSIDE, init, goal, PYTHON)
    result = answer(problem, engine, heuristic, 6)
    assert isinstance(result, crow.Plan)
    assert replay_to_goal(problem, result.trace).is_sound
    (first, *_) = result.steps
    assert first.controller == "pick"
    assert first.arguments == ("A", 2)


def test_what_is_not_given_is_named_before_the_search() -> None:
    given = {name: python for name, python in PYTHON.items() if name != "beside"}
    problem = towers(OUTSIDE, "pass", "on(A, B)", given)
    with pytest.raises(NotPlannable, match="the external function `beside`, whose Python is not"):
        crow.plan(problem)


@pytest.mark.parametrize("engine", ["auto", "best", "iddfs", "iw", "reference"])
def test_what_python_raises_ends_the_search(engine: str) -> None:
    def clear(state: object, x: str) -> bool:
        raise KeyError(x)

    problem = towers(OUTSIDE, "pass", "on(A, B)", {**PYTHON, "clear": clear})
    with pytest.raises(crow.FunctionError) as raised:
        crow.plan(problem, engine, depth_limit=3)
    error = raised.value
    assert (error.name, error.reason) == ("clear", f"raised KeyError: {error.call[6:7]!r}")
    assert error.location is not None
    assert "raise KeyError(x)" in error.traceback
    assert "externals.py" not in error.traceback
