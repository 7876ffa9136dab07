"""A program for each outcome, planned by real planners; faults are put in where there are none."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from crossing import (
    ACHIEVES,
    ASSERTS,
    DEFAULT,
    SILENT,
    VALUES,
    WITH_KEY,
    WITHOUT_KEY,
    compared,
    written,
)
from support import BLOCKS, EXAMPLES

from cdlc.backends.engines import EngineFailed, EngineResult, EngineStatus, PddlStep, installed
from cdlc.crosscheck import Comparison, Outcome, Settings, sides
from crow.plan import Result

if "fast-downward" not in installed():
    pytest.skip("needs the extra `planners`", allow_module_level=True)


def one(*files: Path, settings: Settings = DEFAULT) -> Comparison:
    (comparison,) = compared(*files, settings=settings)
    return comparison


def test_both_plan() -> None:
    found = one(BLOCKS / "blocks.cdl", BLOCKS / "sussman.cdl")
    assert found.outcome is Outcome.AGREE_PLAN
    assert found.planner is not None
    assert found.program is not None
    for side in (found.planner, found.program):
        assert (len(side.result.steps), len(side.pddl), side.result.cost) == (6, 6, 6)
    assert found.planner.result.engine == "fast-downward"


def test_both_prove_that_there_is_none(tmp_path: Path) -> None:
    found = one(written(tmp_path, ACHIEVES, WITHOUT_KEY))
    assert (found.outcome, found.reason) == (Outcome.AGREE_NONE, "")


def test_a_goal_that_is_never_true_agrees(tmp_path: Path) -> None:
    hopeless = WITH_KEY.replace("open(front)", "open(front) and not open(front)")
    assert one(written(tmp_path, ACHIEVES, hopeless)).outcome is Outcome.AGREE_NONE


def test_a_goal_that_holds_agrees(tmp_path: Path) -> None:
    done = WITH_KEY.replace("open(front)", "locked(front)")
    found = one(written(tmp_path, ACHIEVES, done))
    assert found.outcome is Outcome.AGREE_PLAN
    assert found.program is not None
    assert (found.program.result.steps, found.program.pddl) == ((), ())


def test_a_plan_outside_the_plan_space_is_shown_step_by_step(tmp_path: Path) -> None:
    found = one(written(tmp_path, ASSERTS, WITH_KEY))
    assert found.outcome is Outcome.OUTSIDE
    assert "outside the program's plan space" in found.reason
    assert "both engines" in found.reason
    assert [(e.step.controller, e.remark) for e in found.excluded] == [
        ("unlock", "nothing on the way to the goal asks for `not locked(d)`"),
        ("push", ""),
    ]
    assert one(written(tmp_path, ACHIEVES, WITH_KEY)).outcome is Outcome.AGREE_PLAN


@pytest.mark.parametrize(
    ("settings", "reason"),
    [
        (Settings(node_limit=5), "the program's search stopped at the node limit of 5"),
        (
            Settings(engine="kairos", time_limit=0.05),
            "kairos stopped at the time limit of 0.05 s",
        ),
    ],
)
def test_a_side_that_stopped_is_named_with_its_limit(settings: Settings, reason: str) -> None:
    found = one(BLOCKS / "sussman.cdl", settings=settings)
    assert found.outcome is Outcome.INCONCLUSIVE
    assert reason in found.reason


@pytest.mark.parametrize(
    ("domain", "reason"),
    [
        (SILENT, "`knock`, which `greet` runs and no effect describes, has no PDDL ("),
        (VALUES, "a `bind` of type `int64` has no Hoare model in this version ("),
    ],
)
def test_what_one_side_has_no_form_for_is_not_comparable(
    domain: str, reason: str, tmp_path: Path
) -> None:
    found = one(written(tmp_path, domain, WITH_KEY))
    assert found.outcome is Outcome.NOT_COMPARABLE
    assert found.reason.startswith(reason)
    assert "door.cdl:" in found.reason
    assert found.planner is None


def test_an_engine_that_does_not_take_the_task_is_not_compared() -> None:
    found = one(EXAMPLES / "jugs" / "four.cdl", settings=Settings(engine="fast-downward"))
    assert found.outcome is Outcome.NOT_COMPARABLE
    assert found.reason == "engine `fast-downward` does not take numbers; see `cdlc engines`"


def test_a_problem_with_errors_leaves_the_others_alone(tmp_path: Path) -> None:
    good = written(tmp_path, ACHIEVES, WITH_KEY)
    bad = tmp_path / "bad.cdl"
    bad.write_text(WITH_KEY.replace("open(front)", "opened(front)"))
    first, second = compared(bad, good)
    assert (first.outcome, second.outcome) == (Outcome.ERROR, Outcome.AGREE_PLAN)
    assert [d.code for d in first.diagnostics] == ["unknown-feature"]


# ----------------------------------------------------------------------------------------- faults

Change = Callable[[EngineResult], EngineResult]


def without_last(solved: EngineResult) -> EngineResult:
    return replace(solved, steps=solved.steps[:-1])


def unsolvable(solved: EngineResult) -> EngineResult:
    return replace(solved, status=EngineStatus.UNSOLVABLE, steps=())


def of_nobody(solved: EngineResult) -> EngineResult:
    return replace(solved, steps=(PddlStep("fly", ("front",)), *solved.steps))


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (without_last, "the plan of fast-downward does not replay: `open(front)`: it is false"),
        (of_nobody, "the plan of fast-downward does not replay: step 1: no action `fly`"),
        (unsolvable, "fast-downward proves that there is no plan, the program has one"),
    ],
)
def test_a_wrong_engine_is_a_mismatch(
    change: Change, reason: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    solve = sides.solve

    def wrong(*arguments: str, **named: Any) -> EngineResult:
        return change(solve(*arguments, **named))

    monkeypatch.setattr(sides, "solve", wrong)
    found = one(written(tmp_path, ACHIEVES, WITH_KEY))
    assert found.outcome is Outcome.MISMATCH
    assert found.reason.startswith(reason)


def test_an_engine_s_plan_that_is_none_of_the_pddl_is_a_mismatch(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def wrong(*_: str, **__: Any) -> EngineResult:
        steps = (PddlStep("push", ("front",)),)
        raise EngineFailed("fast-downward", "it returned an invalid plan: locked", "", steps)

    monkeypatch.setattr(sides, "solve", wrong)
    found = one(written(tmp_path, ACHIEVES, WITH_KEY))
    assert found.outcome is Outcome.MISMATCH
    assert "none of the emitted PDDL: it returned an invalid plan: locked" in found.reason


def test_an_engine_that_crashes_is_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def crash(*_: str, **__: Any) -> EngineResult:
        raise EngineFailed("fast-downward", "its process ended with status -11", "log")

    monkeypatch.setattr(sides, "solve", crash)
    found = one(written(tmp_path, ACHIEVES, WITH_KEY))
    assert found.outcome is Outcome.ERROR
    assert found.reason == "engine `fast-downward` failed: its process ended with status -11"


def test_a_program_s_plan_that_is_none_of_the_pddl_is_a_mismatch(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mapped = sides.to_pddl_plan
    monkeypatch.setattr(sides, "to_pddl_plan", lambda *given: mapped(*given)[1:])
    found = one(written(tmp_path, ACHIEVES, WITH_KEY))
    assert found.outcome is Outcome.MISMATCH
    assert "the program's plan is none of the emitted PDDL, by unified-planning: " in found.reason


def test_a_wrong_proof_of_the_runtime_is_found_by_its_other_engine(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Blind(sides.Planning):
        def first(self) -> Result:
            return self._unsolvable() if self.name == "auto" else super().first()

    monkeypatch.setattr(sides, "Planning", Blind)
    found = one(written(tmp_path, ACHIEVES, WITH_KEY))
    assert found.outcome is Outcome.MISMATCH
    assert "its reference engine finds one" in found.reason
    assert found.second is not None
    assert len(found.second.steps) == 2


def test_a_plan_of_the_runtime_that_does_not_replay_is_a_mismatch(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Wrong(sides.Planning):
        def _plan(self, steps: Any, trace: Any) -> Any:
            return super()._plan(steps, trace[:-1][::-1])

    monkeypatch.setattr(sides, "Planning", Wrong)
    found = one(written(tmp_path, ACHIEVES, WITH_KEY))
    assert found.outcome is Outcome.MISMATCH
    assert found.reason.startswith("the runtime fails: no plan: ")
