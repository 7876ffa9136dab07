"""The blocks programs: as PDDL they are what a person writes, and ground to no more."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from programs import task_of
from support import BLOCKS, ROOT

from benchmarks.translator import TaskSize, TranslatorError, task_size
from cdlc.backends.engines import installed
from cdlc.backends.pddl import PddlTask

HERE = Path(__file__).parent
PROGRAMS = ["blocks", "blocks_as_printed", "blocks_strips"]
PROBLEMS = ["sussman", "reverse5", "towers12"]
SOURCES = {
    "pickup_table": "r_holding_from_table",
    "unstack": "r_holding_from_stack, r_clear",
    "place_table": "r_clear_from_holding, r_handempty, r_on_table",
    "stack": "r_on",
}
needs_planner = pytest.mark.skipif("fast-downward" not in installed(), reason="needs `planners`")


def blocks(program: str, problem: str) -> PddlTask:
    text = (BLOCKS / f"{program}.cdl").read_text()
    if program == "blocks_as_printed":
        misprint = "    holding[y] = True\n    clear[y] = True\n"
        assert text.count(misprint) == 1
        text = text.replace(misprint, misprint.replace("holding[y]", "holding[x]"))
    task = task_of(text, (BLOCKS / f"{problem}.cdl").read_text())
    assert task.problem is not None
    return task


@pytest.mark.parametrize("program", PROGRAMS)
def test_golden(program: str, golden: Callable[[Path, str], None]) -> None:
    task = blocks(program, "sussman")
    golden(HERE / "golden" / f"{program}.pddl", f"{task.domain}\n{task.problem}")


@pytest.mark.parametrize("program", PROGRAMS)
def test_there_is_one_action_a_controller_with_plain_effects(program: str) -> None:
    task = blocks(program, "sussman")
    found = {a.name: ", ".join(s.behavior for s in a.sources) for a in task.actions}
    assert found == SOURCES
    assert not re.search(r"\((when|forall|=|or) ", task.domain)
    assert "(:requirements :strips :typing)" in task.domain


def test_the_misprint_is_not_merged_away() -> None:
    task = task_of((BLOCKS / "blocks_as_printed.cdl").read_text())
    assert [a.name for a in task.actions] == [
        "pickup_table", "unstack", "r_clear", "place_table", "stack",
    ]  # fmt: skip


@needs_planner
@pytest.mark.parametrize("problem", PROBLEMS)
def test_the_task_is_no_larger_than_one_written_by_hand(problem: str) -> None:
    by_hand = (ROOT / "benchmarks" / "handwritten" / "blocks.pddl").read_text()
    tasks = {program: blocks(program, problem) for program in PROGRAMS}
    # The three emit the same problem, but for the comment and the domain's name.
    text = re.sub(r"\(:domain [^)]*\)", "(:domain blocks)", tasks["blocks"].problem or "")
    expected = task_size(by_hand, text)
    if problem == "sussman":
        assert expected == TaskSize(facts=expected.facts, operators=18, axioms=0)
    sizes = {name: task_size(task.domain, task.problem or "") for name, task in tasks.items()}
    assert sizes == dict.fromkeys(PROGRAMS, expected)


@needs_planner
def test_a_task_that_the_translator_refuses_is_an_error() -> None:
    with pytest.raises(TranslatorError, match="Parsing"):
        task_size("(define (domain d) (:predicates (p))", "(define (problem p))")
