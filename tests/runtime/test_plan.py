"""Plans as text and as JSON."""

import json

import pytest
from support import BLOCKS

import cdlc
import crow
from crow.plan import Result, Step, call_text, plan_text
from crow.trace import DoItem

STEPS = (
    Step("r_clear", ("b1",), {"y": "c"}, "unstack", ("c", "b1"), ("r_holding",)),
    Step("r_rest", (), {}, None),
)


def test_a_plan_is_a_step_a_line() -> None:
    assert (
        plan_text(STEPS)
        == "1. unstack(c, b1)  by r_clear(b1, y=c)\n2. -               by r_rest()\n"
    )
    assert plan_text(()) == ""


def test_numbers_are_aligned() -> None:
    lines = plan_text(STEPS * 5).splitlines()
    assert lines[0].startswith(" 1. ")
    assert lines[9].startswith("10. ")


@pytest.mark.parametrize(
    ("value", "text"),
    [("a", "a"), (1, "1"), (1.5, "1.5"), (True, "True"), ((1.0, -2.5), "[1.0, -2.5]")],
)
def test_values_are_written_as_calls_are_read(value: object, text: str) -> None:
    assert call_text("go", (value,), {"p": value}) == f"go({text}, p={text})"


def test_json() -> None:
    result = Result("plan", "some-engine", STEPS, (DoItem("unstack", ("c", "b1")),), 2.0)
    document = json.loads(json.dumps(result.json()))
    assert document["steps"] == [
        {
            "behavior": "r_clear",
            "behavior_arguments": ["b1"],
            "bindings": {"y": "c"},
            "controller": "unstack",
            "arguments": ["c", "b1"],
            "also": ["r_holding"],
        },
        {
            "behavior": "r_rest",
            "behavior_arguments": [],
            "bindings": {},
            "controller": None,
            "arguments": [],
        },
    ]
    assert document["trace"] == [{"do": "unstack", "arguments": ["c", "b1"]}]
    assert (document["version"], document["cost"], "explanation" in document) == (1, 2.0, False)
    assert Result("limit", "e", explanation="why").json()["explanation"] == "why"


@pytest.mark.parametrize(
    ("result", "summary"),
    [
        (Result("plan", "e", STEPS[:1]), "plan of 1 step, replayed to the goal (e)"),
        (
            Result("plan", "e", STEPS, statistics={"seconds": 1.234}),
            "plan of 2 steps, replayed to the goal (e in 1.23 s)",
        ),
        (Result("unsolvable", "e"), "no plan exists (e)"),
        (Result("limit", "e"), "no plan found: the search stopped at a limit of its own (e)"),
        (Result("timeout", "e"), "no plan found within the time limit (e)"),
        (Result("memory", "e"), "no plan found within the memory limit (e)"),
    ],
)
def test_summaries(result: Result, summary: str) -> None:
    assert result.summary() == summary


def test_a_plan_has_its_projected_states() -> None:
    problem = cdlc.load_problem(BLOCKS / "sussman.cdl")
    result = crow.plan(problem)
    assert isinstance(result, crow.Plan)
    states = result.states(problem)
    assert len(states) == len(result.trace) + 1
    assert states[0] == problem.initial
    assert states[-1].cells["on", ("A", "B")]
    holding = [cell for state in states for cell in state.cells if cell[0] == "holding"]
    assert list(dict.fromkeys(holding)) == [("holding", (name,)) for name in "CBA"]
