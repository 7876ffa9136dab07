"""External functions whose Python is given: tables in PDDL, in the interpreter and the replayer."""

from pathlib import Path

import pytest
from support import cdlc

import cdlc as library
from cdlc.backends.engines import installed

PDDL = ("--engine", "fast-downward")
needs_planner = pytest.mark.skipif("fast-downward" not in installed(), reason="needs `planners`")

DOMAIN = """
domain "walks"
typedef place
feature at() -> place
def near(a: place, b: place) -> bool
def far(a: place) -> bool
controller walk(to: place)
behavior r_at(to: place):
  goal: at() == to
  body:
    assert near(at(), to)
    do walk(to)
  eff:
    at[...] = to
"""
PROBLEM = """
problem "p"
domain "domain.cdl"
objects:
  a1, a2, a3: place
init: at = a1
goal: at() == a3
"""
PYTHON = "def near(a, b):\n    return int(b[1]) == int(a[1]) + 1\n"


@pytest.fixture
def problem(tmp_path: Path) -> Path:
    (tmp_path / "domain.cdl").write_text(DOMAIN)
    (tmp_path / "problem.cdl").write_text(PROBLEM)
    (tmp_path / "functions.py").write_text(PYTHON)
    return tmp_path / "problem.cdl"


def test_without_its_python_a_function_is_refused(problem: Path) -> None:
    ran = cdlc("compile", problem, "--emit", "pddl")
    assert ran.status == 1
    assert "the external function `near` has no PDDL" in ran.err
    assert "--functions FILE.py" in ran.err


def test_a_function_becomes_static_facts(problem: Path) -> None:
    compiled = library.compile(problem, functions={"near": lambda a, b: (a, b) == ("a1", "a3")})
    task = compiled.pddl()
    assert "(near ?a ?b - place)" in task.domain
    assert task.problem is not None
    assert "(near a1 a3)" in task.problem
    assert "(near a1 a2)" not in task.problem


@needs_planner
def test_plans_are_found_and_replayed_with_it(problem: Path) -> None:
    functions = ("--functions", problem.parent / "functions.py")
    plan = problem.parent / "plan.json"
    ran = cdlc("plan", problem, *functions, *PDDL, "--format", "json", "-o", plan)
    assert ran.status == 0, ran.err
    validated = cdlc("validate", problem, plan, *functions)
    assert validated.status == 0, validated.err
    step = ("--step", "r_at(a3)")
    simulated = cdlc("simulate", problem, *functions, *step)
    assert "near(at(), to)" in simulated.err


@pytest.mark.parametrize(
    ("python", "reason"),
    [
        ("def near(a, b): return 1 / 0", "raised ZeroDivisionError: division by zero"),
        ("def near(a, b): return 3", "gave what does not fit: `3` is no value of type `bool`"),
    ],
)
def test_a_function_that_fails_is_reported_where_it_is_declared(
    problem: Path, python: str, reason: str
) -> None:
    (problem.parent / "functions.py").write_text(python)
    ran = cdlc("compile", problem, "--emit", "pddl", "--functions", problem.parent / "functions.py")
    assert ran.status == 1
    assert f'error["function-failed"]: `near(a1, a1)` {reason}'.replace('"', "") in ran.err
    assert "domain.cdl:5:5" in ran.err


@pytest.mark.parametrize(
    ("python", "said"),
    [(None, "No such file"), ("def", "SyntaxError"), ("1 / 0", "ZeroDivisionError")],
)
def test_a_file_that_cannot_be_run_is_an_error(
    problem: Path, python: str | None, said: str
) -> None:
    file = problem.parent / "other.py"
    if python is not None:
        file.write_text(python)
    ran = cdlc("compile", problem, "--emit", "pddl", "--functions", file)
    assert (ran.status, ran.out) == (1, "")
    assert "error[cannot-run-functions]" in ran.err
    assert said in ran.err


def test_every_function_that_does_not_fit_is_reported(problem: Path) -> None:
    code = "wrong-function"
    with pytest.raises(library.CompileError) as raised:
        library.load(
            problem.parent / "domain.cdl",
            functions={"near": lambda a: True, "fat": lambda a: True, "walk": print},
        )
    found = raised.value.diagnostics
    assert [d.code for d in found] == [code] * 3
    assert "`near` is called with 2 values" in str(raised.value)
    assert "did you mean `far`?" in str(raised.value)
    assert "`walk` is a controller" in str(raised.value)
    assert "domain.cdl:5:5" in str(raised.value)
