"""Commands with `--functions`: Python that reads the state, computes values and effects."""

import json
from pathlib import Path

import pytest
from support import cdlc

import cdlc as library
import crow
from crow.planning import ENGINES

DOMAIN = """
typedef Box
typedef Spot: vector[float64, 2]
typedef Way: pyobject
feature at(b: Box) -> Spot
feature held(b: Box)
feature moves() -> int32
def [[reads=held]] free() -> bool
def heavy(b: Box) -> bool
def beside(s: Spot) -> Spot
def way(a: Spot, b: Spot) -> Way
controller pick(b: Box)
controller go(w: Way)
controller place(b: Box, s: Spot)
behavior r_held(b: Box):
  goal: held(b)
  body:
    assert not heavy(b)
    achieve free()
    do go(way([0.0, 0.0], at(b)))
    do pick(b)
  eff:
    held[b] = True
    moves += 1
behavior r_free():
  goal: free()
  body:
    bind b: Box where: held(b)
    do place(b, beside(at(b)))
  eff:
    held[b] = False
    at[b] = beside(at(b))
    moves += 1
"""
PROBLEM = """
problem "p"
domain "domain.cdl"
objects:
  a, b, c: Box
init:
  at[a] = [0.0, 0.0]
  at[b] = [1.0, 0.0]
  at[c] = [2.0, 0.0]
  held[a] = True
goal: held(b) and moves == 2
"""
PYTHON = """
import numpy as np
import crow

@crow.function
def free(state):
    return not state.cells("held")

@crow.function(vectorized=True)
def heavy(b):
    return b == "c"

@crow.function("beside")
def next_to(spot):
    return np.array(spot) + [0.5, 0]

def way(a, b):
    return np.linspace(a, b, 3)
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "domain.cdl").write_text(DOMAIN)
    (tmp_path / "problem.cdl").write_text(PROBLEM)
    (tmp_path / "functions.py").write_text(PYTHON)
    return tmp_path


def with_python(folder: Path, python: str = PYTHON) -> tuple[str, Path]:
    file = folder / "functions.py"
    file.write_text(python)
    return ("--functions", file)


@pytest.mark.parametrize("engine", ENGINES)
def test_plans_are_found(folder: Path, engine: str) -> None:
    ran = cdlc("plan", folder / "problem.cdl", *with_python(folder), "--engine", engine)
    assert ran.status == 0, ran.err
    place, go, pick = ran.out.splitlines()
    assert "place(a, [0.5, 0.0])" in place
    assert "go(array([[0. , 0. ], [0.5, 0. ], [1. , 0. ]]))" in go
    assert "pick(b)" in pick


def test_opaque_values_are_marked_in_json(folder: Path) -> None:
    ran = cdlc("plan", folder / "problem.cdl", *with_python(folder), "--format", "json")
    steps = json.loads(ran.out)["steps"]
    assert steps[1]["arguments"][0].keys() == {"opaque"}


def test_plans_are_validated_and_simulated(folder: Path) -> None:
    python = with_python(folder, PYTHON.replace("np.linspace(a, b, 3)", "(a, b)"))
    plan = folder / "plan.txt"
    ran = cdlc("plan", folder / "problem.cdl", *python, "-o", plan)
    assert ran.status == 0, ran.err
    steps = ("--step", "r_free()", "--step", "r_held(b)")
    simulated = cdlc("simulate", folder / "problem.cdl", *python, *steps)
    assert simulated.status == 0, simulated.err
    assert "held(b)" in simulated.out
    assert "at(a) = [0.5, 0.0]" in simulated.out
    failed = cdlc("simulate", folder / "problem.cdl", *python, "--step", "r_held(c)")
    assert failed.status == 1
    assert "not heavy(b)" in failed.err


def test_what_python_raises_is_told_with_place_and_traceback(folder: Path) -> None:
    python = with_python(folder, PYTHON.replace("not state.cells", "not state.cels"))
    for command in (("plan",), ("simulate", "--step", "r_held(b)")):
        ran = cdlc(command[0], folder / "problem.cdl", *command[1:], *python)
        assert (ran.status, ran.out) == (1, "")
        assert "error[function-failed]: `free()` raised StateError: there is no feature `cels`" in (
            ran.err
        )
        assert "domain.cdl:19:13" in ran.err
        assert "functions.py" in ran.err
        assert "externals.py" not in ran.err
        assert "calls.py" not in ran.err


def test_what_was_not_declared_to_be_read_is_an_error(folder: Path) -> None:
    python = with_python(folder, PYTHON.replace('cells("held")', 'cells("at")'))
    ran = cdlc("plan", folder / "problem.cdl", *python)
    assert ran.status == 1
    assert "`free` reads `at`, and does not say so: `[[reads=at]]`" in ran.err


def test_what_does_not_fit_is_told_before_anything_is_run(folder: Path) -> None:
    wrong = PYTHON.replace("def free(state)", "def fre(state)").replace(
        "def heavy(b)", "def heavy()"
    )
    ran = cdlc("plan", folder / "problem.cdl", *with_python(folder, wrong))
    assert ran.status == 1
    assert "error[wrong-function]: `heavy` is called with 1 value" in ran.err
    assert "error[wrong-function]: the program has no external function `fre`" in ran.err
    assert "functions.py:" in ran.err
    assert "help: did you mean `free`?" in ran.err
    assert ran.err.count("error[") == 2


def test_what_is_not_given_is_named(folder: Path) -> None:
    python = with_python(folder, PYTHON.replace("def way", "def _way"))
    ran = cdlc("plan", folder / "problem.cdl", *python)
    assert ran.status == 1
    assert "error[missing-function]: the external function `way` has no Python" in ran.err
    assert "domain.cdl:20:11" in ran.err


EFFECT = """
@crow.effect("place")
def simulated(state, b, s):
    return {("held", b): False, ("at", b): s, "moves": state.moves() + 1}
"""
METHOD = DOMAIN.replace(
    """    do place(b, beside(at(b)))
  eff:
    held[b] = False
    at[b] = beside(at(b))
    moves += 1
""",
    """    do place(b, beside(at(b)))
""",
)


@pytest.mark.parametrize("engine", ENGINES)
def test_effects_of_controllers_are_simulated(folder: Path, engine: str) -> None:
    (folder / "domain.cdl").write_text(METHOD)
    python = with_python(folder, PYTHON + EFFECT)
    ran = cdlc("plan", folder / "problem.cdl", *python, "--engine", engine)
    assert ran.status == 0, ran.err
    assert "place(a, [0.5, 0.0])" in ran.out.splitlines()[0]
    step = ("--step", "r_free()")
    simulated = cdlc("simulate", folder / "problem.cdl", *python, *step)
    assert "at(a) = [0.5, 0.0]" in simulated.out
    assert "held(a)" not in simulated.out


def test_pddl_refuses_effects_in_python_by_name(tmp_path: Path) -> None:
    (tmp_path / "domain.cdl").write_text(
        "typedef T\nfeature p(x: T)\ncontroller c(x: T)\n"
        "behavior b(x: T):\n  goal: p(x)\n  body:\n    do c(x)\n"
    )
    (tmp_path / "problem.cdl").write_text(
        'problem "p"\ndomain "domain.cdl"\nobjects:\n  a: T\ngoal: p(a)\n'
    )
    python = "import crow\n@crow.effect\ndef c(state, x):\n    return {('p', x): True}\n"
    given = with_python(tmp_path, python)
    planned = cdlc("plan", tmp_path / "problem.cdl", *given)
    assert (planned.status, planned.out) == (0, "1. c(a)  by b(a)\n"), planned.err
    for command in (
        ("compile", "--emit", "pddl"),
        ("compile", "--emit", "hddl"),
        ("plan", "--engine", "fast-downward"),
    ):
        ran = cdlc(command[0], tmp_path / "problem.cdl", *command[1:], *given)
        assert (ran.status, ran.out) == (1, "")
        assert "the effect of `c`, which Python computes, has no PDDL" in ran.err
        assert "domain.cdl:3:12" in ran.err
    checked = cdlc("crosscheck", tmp_path / "problem.cdl", *given, "--out", tmp_path)
    assert checked.status == 4
    assert "the effect of `c`" in checked.out


def test_functions_are_given_to_the_library(folder: Path) -> None:
    domain = library.load(folder / "domain.cdl", functions=folder / "functions.py")
    assert domain.functions.functions.keys() == {"free", "heavy", "beside", "way"}
    spots = {f"at({name})": (0, 0) for name in "ab"}
    problem = crow.Problem(
        domain, {"a": "Box", "b": "Box"}, {**spots, "held(a)": True}, "held(b) and free() == False"
    )
    plan = crow.plan(problem)
    assert isinstance(plan, crow.Plan)
    assert [step.controller for step in plan.steps] == ["place", "go", "pick"]
    assert plan.steps[1].arguments[0].shape == (3, 2)
    assert isinstance(
        crow.plan(library.load_problem(folder / "problem.cdl", folder / "functions.py")), crow.Plan
    )


def test_functions_are_given_with_compiled_programs(folder: Path) -> None:
    compiled = folder / "program.json"
    ran = cdlc("compile", folder / "problem.cdl", "--emit", "ir", "-o", folder)
    assert ran.status == 0, ran.err
    problem = crow.load_problem(compiled, functions=folder / "functions.py")
    assert isinstance(crow.plan(problem), crow.Plan)
    assert crow.load(compiled, functions=folder / "functions.py").functions.functions
    with pytest.raises(crow.FunctionsError, match="is called with 1 value"):
        crow.load(compiled, functions={"heavy": lambda: True})
