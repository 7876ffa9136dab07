"""Emitted tasks and methods: their text, that unified-planning reads it, what it requires."""

import hashlib
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from hddl_tasks import stated
from support import EXAMPLES

from cdlc.backends.engines import installed
from cdlc.driver import Compilation

HERE = Path(__file__).parent
FROM_EXAMPLES = {
    "blocks": "blocks/sussman.cdl",
    "briefcase": "briefcase/payday.cdl",
    "cupboard": "cupboard/dishes.cdl",
    "gripper": "gripper/four.cdl",
    "kitchen": "kitchen/tidy.cdl",
    "logistics": "logistics/parcel.cdl",
    "rooms": "tutorial/swap.cdl",
}
OWN = sorted(path.stem for path in (HERE / "golden").glob("*.cdl"))
CASES = [*OWN, *FROM_EXAMPLES]
needs_planner = pytest.mark.skipif("fast-downward" not in installed(), reason="needs `planners`")


def texts_of(case: str) -> tuple[str, str]:
    """The domain and the problem. Own files hold a domain, then, from `problem "…"`, a problem."""
    if case in FROM_EXAMPLES:
        task = Compilation(None, str(EXAMPLES / FROM_EXAMPLES[case])).hddl
        assert task.problem is not None
        return task.domain, task.problem
    text = (HERE / "golden" / f"{case}.cdl").read_text()
    return stated(*re.split(r"^(?=problem )", text, flags=re.MULTILINE)).texts


@pytest.mark.parametrize("case", CASES)
def test_golden(case: str, golden: Callable[[Path, str], None]) -> None:
    golden(HERE / "golden" / f"{case}.hddl", "\n".join(texts_of(case)))


@needs_planner
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
@pytest.mark.parametrize("case", CASES)
def test_unified_planning_reads_it(case: str) -> None:
    from unified_planning.io import PDDLReader

    domain, stated_ = texts_of(case)
    problem = PDDLReader().parse_problem_string(domain, stated_)
    for kind, found in (
        ("task", problem.tasks),
        ("method", problem.methods),
        ("action", problem.actions),
    ):
        written = re.findall(rf"\(:{kind} (\S+)", domain)
        assert [part.name for part in found] == [name.lower() for name in written]
    assert len(problem.task_network.subtasks) >= 1
    # Every task can be done, and is asked for or a goal of the program.
    assert {method.achieved_task.task.name for method in problem.methods} == {
        task.name for task in problem.tasks
    }


@pytest.mark.parametrize("case", FROM_EXAMPLES)
def test_the_actions_are_those_of_pddl(case: str) -> None:
    compiled = Compilation(None, str(EXAMPLES / FROM_EXAMPLES[case]))
    actions = compiled.pddl.domain.partition("(:action")[2]
    assert compiled.hddl.domain.partition("(:action")[2] == actions


@pytest.mark.parametrize("case", CASES)
def test_requirements_are_those_used(case: str) -> None:
    domain, problem = (re.sub(r";.*", "", text) for text in texts_of(case))
    (declared,) = re.findall(r":requirements ([^)]*)", domain)
    methods = domain.partition("(:method")[2].partition("(:action")[0]
    assert ":hierarchy" in declared
    assert (":method-preconditions" in declared) is (":precondition" in methods)
    conditions = re.findall(r":precondition(.*?)(?::effect|subtasks|\n  \()", domain, re.DOTALL)
    text = " ".join(conditions) + problem.partition("(:goal")[2]
    for requirement, word in (
        (":negative-preconditions", "(not "),
        (":existential-preconditions", "(exists "),
        (":universal-preconditions", "(forall "),
    ):
        assert (requirement in declared) is (word in text), requirement
    assert (":equality" in declared) is ("(= ?" in domain)  # in guards of effects, too


def digest() -> str:
    texts = "".join(text for case in CASES for text in texts_of(case))
    return hashlib.sha256(texts.encode()).hexdigest()


def test_the_text_is_the_same_in_every_process() -> None:
    script = "import test_hddl_golden; print(test_hddl_golden.digest())"
    folders = (HERE, HERE.parents[1], HERE.parents[2])
    for seed in ("1", "77"):
        environment = {
            **os.environ,
            "PYTHONHASHSEED": seed,
            "PYTHONPATH": os.pathsep.join([*map(str, folders), *sys.path]),
        }
        done = subprocess.run(
            [sys.executable, "-c", script],
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        )
        assert done.stdout.strip() == digest()
