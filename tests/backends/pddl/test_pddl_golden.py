"""Emitted tasks: their text, that planners read it, and that it is the same in every process."""

import hashlib
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from programs import task_of

from benchmarks.translator import task_size
from cdlc.backends.engines import installed
from cdlc.backends.pddl import PddlTask

HERE = Path(__file__).parent
CASES = sorted(path.stem for path in (HERE / "golden").glob("*.cdl"))
# What Fast Downward does not take.
NUMERIC = ["numbers"]
needs_planner = pytest.mark.skipif("fast-downward" not in installed(), reason="needs `planners`")


def texts_of(case: str) -> tuple[str, str]:
    """A file holds a domain and, from the line `problem "…"` on, a problem."""
    text = (HERE / "golden" / f"{case}.cdl").read_text()
    domain, problem = re.split(r"^(?=problem )", text, flags=re.MULTILINE)
    return domain, problem


def golden_task(case: str) -> PddlTask:
    task = task_of(*texts_of(case))
    assert task.problem is not None
    return task


@pytest.mark.parametrize("case", CASES)
def test_golden(case: str, golden: Callable[[Path, str], None]) -> None:
    task = golden_task(case)
    golden(HERE / "golden" / f"{case}.pddl", f"{task.domain}\n{task.problem}")


@needs_planner
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
@pytest.mark.parametrize("case", CASES)
def test_unified_planning_reads_it(case: str) -> None:
    from unified_planning.io import PDDLReader

    task = golden_task(case)
    problem = PDDLReader().parse_problem_string(task.domain, task.problem)
    assert [a.name for a in problem.actions] == [a.name.lower() for a in task.actions]
    assert [len(a.parameters) for a in problem.actions] == [len(a.parameters) for a in task.actions]
    declared = re.findall(r"^    \((\S+?)[ )]", task.domain.partition("(:action")[0], re.MULTILINE)
    assert len(problem.fluents) == len([name for name in declared if name != "total-cost"])


@needs_planner
@pytest.mark.parametrize("case", [case for case in CASES if case not in NUMERIC])
def test_fast_downwards_translator_reads_it(case: str) -> None:
    task = golden_task(case)
    assert task.problem is not None
    assert task_size(task.domain, task.problem).facts > 0


@pytest.mark.parametrize("case", CASES)
def test_kairos_reads_it(case: str) -> None:
    kairos = pytest.importorskip("kairos")
    task = golden_task(case)
    domain = kairos.parse_domain(task.domain, "domain.pddl")
    kairos.parse_problem(task.problem, domain, "problem.pddl")


def digest() -> str:
    texts = (f"{task.domain}{task.problem}" for task in map(golden_task, CASES))
    return hashlib.sha256("".join(texts).encode()).hexdigest()


def test_the_text_is_the_same_in_every_process() -> None:
    script = "import test_pddl_golden; print(test_pddl_golden.digest())"
    folders = (HERE, HERE.parents[1], HERE.parents[2])
    for seed in ("1", "77"):
        environment = {
            **os.environ,
            "PYTHONHASHSEED": seed,
            "PYTHONPATH": os.pathsep.join(map(str, folders)),
        }
        done = subprocess.run(
            [sys.executable, "-c", script],
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        )
        assert done.stdout.strip() == digest()


@pytest.mark.parametrize("case", CASES)
def test_requirements_are_those_used(case: str) -> None:
    task = golden_task(case)
    text = re.sub(r";.*", "", task.domain + str(task.problem))
    (declared,) = re.findall(r":requirements ([^)]*)", text)
    words = set(re.findall(r"\((not|or|exists|when) ", text))
    before_effects = re.findall(r":precondition(.*?):effect", text, re.DOTALL)
    effects = "".join(re.findall(r":effect(.*?)(?=:action|\(:domain)", text, re.DOTALL))
    goal = text.partition("(:goal")[2]
    guards = re.findall(r"\(when (.*)", text)
    conditions = " ".join([*before_effects, goal, *guards])
    assert (":typing" in declared) is ("(:types" in text)
    assert (":equality" in declared) is bool(re.search(r"\(= (\?\S+ \S+|\S+ \?\S+)\)", conditions))
    assert (":existential-preconditions" in declared) is ("exists" in words)
    assert (":universal-preconditions" in declared) is ("(forall " in conditions)
    assert (":conditional-effects" in declared) is bool(guards or "\n      (forall" in effects)
    functions = set(
        re.findall(r"\((\S+)", text.partition("(:functions")[2].partition("(:action")[0])
    )
    costs = {"total-cost)", *re.findall(r"\(increase \(total-cost\) \((\S+)", text)}
    assert (":action-costs" in declared) is ("(:metric" in text)
    assert (":numeric-fluents" in declared) is bool(functions - costs)
    assert ":disjunctive-preconditions" in declared or "or" not in words


def test_every_part_of_the_emitter_is_in_some_golden_file() -> None:
    used = " ".join(
        re.findall(
            r":requirements ([^)]*)",
            "".join((HERE / "golden" / f"{case}.pddl").read_text() for case in CASES),
        )
    )
    assert set(used.split()) == {
        ":strips", ":typing", ":negative-preconditions", ":disjunctive-preconditions",
        ":equality", ":existential-preconditions", ":universal-preconditions",
        ":conditional-effects", ":numeric-fluents", ":action-costs",
    }  # fmt: skip
