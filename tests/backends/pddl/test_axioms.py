"""Derived functions as `:derived` predicates."""

import re
from pathlib import Path

import pytest
from programs import program_of, statement_of
from support import EXAMPLES, cdlc

from cdlc.backends.engines import describe, installed
from cdlc.backends.pddl import Emission, PddlTask, to_pddl
from cdlc.backends.up import to_up
from cdlc.diagnostics import Collector
from cdlc.driver import Compilation
from cdlc.ir.hoare import Model
from crow.problem import Problem

needs_planner = pytest.mark.skipif("fast-downward" not in installed(), reason="needs `planners`")
GOLDEN = Path(__file__).parent / "golden"

HEAD = """
typedef T
feature p(x: T)
feature q(x: T)
controller go(x: T)
def both(x: T):
  return p(x) and q(x)
def some(x: T):
  return both(x) or exists y: T: p(y)
def spare(x: T):
  return q(x)
"""


def task_of(domain: str, problem: str | None = None, *, axioms: bool = True) -> PddlTask:
    found, stated = Collector(), None
    program = program_of(domain)
    if problem is not None:
        program, statement = statement_of(domain, problem)
        stated = Problem.of(program, statement)
    model = Model(program)
    task = to_pddl(model, stated, found, Emission(axioms=axioms))
    assert task is not None, [d.message() for d in found]
    return task


def test_golden(golden: object) -> None:
    assert callable(golden)
    text = (GOLDEN / "derived.cdl").read_text()
    domain, problem = re.split(r"^(?=problem )", text, flags=re.MULTILINE)
    task = task_of(domain, problem)
    golden(GOLDEN / "axioms.pddl", f"{task.domain}\n{task.problem}")


def test_only_predicates_that_are_used_are_derived() -> None:
    task = task_of(HEAD + "behavior act(x: T):\n  body: assert some(x)\n  eff: p[x] = True\n")
    assert re.findall(r"\(:derived \((\w+)", task.domain) == ["both", "some"]
    assert ":derived-predicates" in task.domain
    assert "(some ?x)" in task.domain.split(":precondition")[1]
    assert task.has_axioms
    plain = task_of(HEAD + "behavior act(x: T):\n  eff: p[x] = True\n")
    assert not plain.has_axioms
    assert "derived" not in plain.domain


def test_what_a_behavior_reads_of_its_own_writes_is_unfolded() -> None:
    task = task_of(HEAD + "behavior act(x: T):\n  eff:\n    p[x] = True\n    q[x] = both(x)\n")
    assert not task.has_axioms
    assert "both" not in task.domain


DEEP = "feature r()\n" + HEAD + "def d0():\n  return r()\n" + "".join(
    f"def d{i}():\n  return d{i - 1}() ^ (exists x: T: d{i - 1}() ^ p(x))\n" for i in range(1, 16)
)  # fmt: skip


def test_unfolding_without_end_falls_back_to_axioms() -> None:
    behavior = "behavior act(x: T):\n  body: assert d15()\n  eff: p[x] = True\n"
    task = task_of(DEEP + behavior, axioms=False)
    assert task.has_axioms
    assert len(task.domain) < 10_000
    assert not task_of(DEEP + behavior.replace("d15", "d2"), axioms=False).has_axioms


@needs_planner
@pytest.mark.parametrize(
    "engine", ["fast-downward", pytest.param("kairos", marks=pytest.mark.slow)]
)
def test_engines_plan_with_axioms(engine: str) -> None:
    pytest.importorskip("up_kairos")
    file = EXAMPLES / "cupboard" / "dishes.cdl"
    ran = cdlc("plan", file, "--derived", "axioms", "--engine", engine)
    assert (ran.status, len(ran.out.splitlines())) == (0, 8), ran.err


@needs_planner
def test_unified_planning_is_told_apart() -> None:
    compilation = Compilation(None, str(EXAMPLES / "cupboard" / "dishes.cdl"), axioms=True)
    task = compilation.pddl
    with pytest.raises(ValueError, match="no derived predicates"):
        to_up(task)
    assert {e.name: e.lacks for e in describe(task.domain, task.problem)}["fast-downward"] == ()
