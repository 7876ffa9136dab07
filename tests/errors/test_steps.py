"""The diagnostics of steps and plans, which need a command with more than a file."""

import json
from pathlib import Path

import pytest
from support import BLOCKS, cdlc

DOMAIN, SUSSMAN = BLOCKS / "blocks.cdl", BLOCKS / "sussman.cdl"
TWO_ON_ONE = f"""problem "two on one"
domain "{DOMAIN}"
objects:
  a, b, c: block
init:
  on[b, a] = True
  on[c, a] = True
  clear[b] = True
  clear[c] = True
  handempty[...] = True
goal: clear(a)
"""


@pytest.mark.parametrize(
    ("code", "step"),
    [
        ("bad-step", "r_clear("),
        ("bad-step", "nothing(A)"),
        ("bad-step", "r_on(A)"),
        ("bad-step", "r_on(A, Q)"),
        ("step-failed", "r_on(A, B)"),
    ],
)
def test_steps_of_simulate(code: str, step: str) -> None:
    ran = cdlc("simulate", DOMAIN, SUSSMAN, "--step", step)
    assert ran.status == 1
    assert f"error[{code}]" in ran.err


def test_a_step_with_a_choice(tmp_path: Path) -> None:
    problem = tmp_path / "problem.cdl"
    problem.write_text(TWO_ON_ONE)
    code = "open-choice"
    ran = cdlc("simulate", DOMAIN, problem, "--step", "r_clear(a)")
    assert ran.status == 1
    assert f"error[{code}]: `y` can be `b` or `c`" in ran.err
    assert cdlc("simulate", DOMAIN, problem, "--step", "r_clear(a, y=c)").status == 0


@pytest.mark.parametrize(
    ("code", "plan"),
    [
        ("bad-step", "make it so\n"),
        ("goal-not-reached", "(unstack C A)\n"),
        ("other-calls", "1. place_table(C)   by r_holding_from_stack(C, y=A)\n"),
    ],
)
def test_plans_of_validate(code: str, plan: str, tmp_path: Path) -> None:
    file = tmp_path / "plan.txt"
    file.write_text(plan)
    ran = cdlc("validate", DOMAIN, SUSSMAN, file)
    assert ran.status == 1, ran
    assert f"error[{code}]" in ran.err


def test_a_plan_whose_trace_makes_other_calls(tmp_path: Path) -> None:
    ran = cdlc("plan", DOMAIN, SUSSMAN, "--format", "json")
    plan = json.loads(ran.out)
    plan["steps"].pop()
    file = tmp_path / "plan.json"
    file.write_text(json.dumps(plan))
    code = "bad-plan"
    assert f"error[{code}]" in cdlc("validate", DOMAIN, SUSSMAN, file).err
