"""Plans with values that were drawn, read back and replayed."""

import json
from pathlib import Path
from typing import Any

import pytest
from support import EXAMPLES, cdlc

EASY = EXAMPLES / "namo" / "easy.cdl"
WORLD = EXAMPLES / "namo" / "world.py"


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    file = tmp_path_factory.mktemp("plan") / "plan.json"
    ran = cdlc("plan", EASY, "--functions", WORLD, "--format", "json", "-o", file)
    assert ran.status == 0
    found: dict[str, Any] = json.loads(file.read_text("utf-8"))
    return found


def validated(plan: dict[str, Any], folder: Path) -> Any:
    file = folder / "plan.json"
    file.write_text(json.dumps(plan))
    return cdlc("validate", EASY, file, "--functions", WORLD)


def test_a_plan_is_replayed_item_by_item(plan: dict[str, Any], tmp_path: Path) -> None:
    ran = validated(plan, tmp_path)
    assert ran.status == 0
    assert f"{len(plan['trace'])} trace items; the goal holds" in ran.out


def test_an_agent_that_forgets_the_obstacle_is_told(plan: dict[str, Any], tmp_path: Path) -> None:
    """Without `attach`, the way with the obstacle is none."""
    trace = [i for i in plan["trace"] if "attach" not in (i.get("do"), i.get("eff"))]
    steps = [step for step in plan["steps"] if step["controller"] != "attach"]
    ran = validated({**plan, "trace": trace, "steps": steps}, tmp_path)
    assert ran.status == 1
    assert "error[bad-plan]: item" in ran.err


def test_a_plan_that_stops_early_does_not_reach_the_goal(
    plan: dict[str, Any], tmp_path: Path
) -> None:
    ends = max(n for n, item in enumerate(plan["trace"]) if "do" in item)
    cut = {**plan, "trace": plan["trace"][:ends], "steps": plan["steps"][:-1]}
    ran = validated(cut, tmp_path)
    assert ran.status == 1
    assert "goal" in ran.err
