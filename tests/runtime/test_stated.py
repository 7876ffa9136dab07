"""Problems stated in Python: `cdlc.load`, `crow.load`, `crow.Problem` and what they refuse."""

import json
import pickle
from pathlib import Path
from typing import Any

import pytest
from support import BLOCKS

import cdlc
import crow
from crow.program import Object, Read
from crow.program.codec import encode

SUSSMAN = {"on(C, A)": True, "on_table(A)": True, "on_table(B)": True, "clear(C)": True,
           ("clear", ("B",)): True, "handempty": True}  # fmt: skip
OBJECTS = {"A": "block", "B": "block", "C": "block"}
GOAL = "on(A, B) and on(B, C)"

NUMBERS = """
domain "numbers"
typedef room
typedef kitchen: room
object_constant hall: room
feature at() -> room
feature [[min=0, max=10]] fuel(r: room) -> int64
feature pose() -> vector[float64, 2]
feature lit(r: room)
def dark(r: room) -> bool
controller switch(r: room)
behavior light(r: room):
  goal: lit(r)
  body:
    assert not dark(r)
    do switch(r)
  eff: lit[r] = True
"""


@pytest.fixture
def numbers(tmp_path: Path) -> crow.Domain:
    file = tmp_path / "numbers.cdl"
    file.write_text(NUMBERS)
    return cdlc.load(file, functions={"dark": lambda room: room == "cellar"})


def test_a_problem_in_python_is_that_of_the_file() -> None:
    domain = cdlc.load(BLOCKS / "blocks.cdl")
    stated = crow.Problem(domain, OBJECTS, SUSSMAN, GOAL)
    filed = cdlc.load_problem(BLOCKS / "sussman.cdl")
    assert dict(stated.initial.cells) == dict(filed.initial.cells)
    plan = crow.plan(stated)
    assert isinstance(plan, crow.Plan)
    assert plan.steps == crow.plan(filed).steps
    assert pickle.loads(pickle.dumps(stated)).initial == stated.initial
    assert crow.plan(pickle.loads(pickle.dumps(stated))).steps == plan.steps


def test_domains_are_picklable() -> None:
    domain = pickle.loads(pickle.dumps(cdlc.load(BLOCKS / "blocks.cdl")))
    assert isinstance(crow.plan(crow.Problem(domain, OBJECTS, SUSSMAN, GOAL)), crow.Plan)


def test_compiled_programs_need_no_compiler(tmp_path: Path) -> None:
    compiled = cdlc.compile(BLOCKS / "blocks.cdl", BLOCKS / "sussman.cdl")
    file = tmp_path / "sussman.json"
    file.write_text(json.dumps(encode(compiled.program, compiled.problem)))
    assert len(crow.plan(crow.load_problem(file)).steps) == 6
    domain = crow.load(file)
    a, b = (Object(name, crow.load_problem(file).world.objects[name]) for name in "AB")
    on = next(f for f in domain.program.features if f.name == "on")
    problem = crow.Problem(domain, OBJECTS, SUSSMAN, Read("on", (a, b), on.type))
    assert len(crow.plan(problem).steps) == 4
    with pytest.raises(crow.ProblemError, match="takes goals as expressions"):
        crow.Problem(domain, OBJECTS, SUSSMAN, GOAL)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "not a compiled program"),
        ("[1]", "no `version`"),
        ('{"version": 99}', "compiled for version 99"),
        ("[" * 100_000, "not a compiled program"),
    ],
)
def test_other_files_are_refused(text: str, message: str, tmp_path: Path) -> None:
    file = tmp_path / "broken.json"
    file.write_text(text)
    for load in (crow.load, crow.load_problem):
        with pytest.raises(crow.ProgramFormatError, match=message):
            load(file)


def test_a_program_alone_is_no_problem(tmp_path: Path) -> None:
    file = tmp_path / "blocks.json"
    file.write_text(json.dumps(encode(cdlc.compile(BLOCKS / "blocks.cdl").program)))
    with pytest.raises(crow.ProgramFormatError, match="without a problem"):
        crow.load_problem(file)


def test_values_functions_and_what_to_minimize(numbers: crow.Domain) -> None:
    init = {"at": "hall", "fuel(hall)": 3, "pose": (1, 2.5)}
    problem = crow.Problem(
        numbers, {"cellar": "room", "cook": "kitchen"}, init, "lit(cook) and fuel(hall) >= least",
        values={"least": 2, "price": 5}, minimize="fuel(hall) * price", name="light",
    )  # fmt: skip
    assert problem.initial.cells["pose", ()] == (1.0, 2.5)
    assert problem.name == "light"
    plan = crow.plan(problem)
    assert isinstance(plan, crow.Plan)
    assert [step.arguments for step in plan.steps] == [("cook",)]


@pytest.mark.parametrize(("pose", "holds"), [((1, 2), True), ([1.0, 2], True), ((1, 2.5), False)])
def test_goals_may_use_vectors_of_either_kind_of_number(
    tmp_path: Path, pose: Any, holds: bool
) -> None:
    file = tmp_path / "poses.cdl"
    file.write_text(
        "feature cell() -> vector[int64, 2]\nfeature pose() -> vector[float64, 2]\n"
        "def is_at(p: vector[float64, 2]) -> bool:\n  return pose == p\n"
    )
    domain = cdlc.load(file)
    init = {"cell": (1, 2), "pose": (1, 2)}
    problem = crow.Problem(domain, {}, init, "is_at(p)", values={"p": pose})
    assert isinstance(crow.plan(problem), crow.Plan) == holds
    problem = crow.Problem(domain, {}, init, "cell == p", values={"p": (1, 2)})
    assert isinstance(crow.plan(problem), crow.Plan)


def test_functions_in_python_are_asked(numbers: crow.Domain) -> None:
    problem = crow.Problem(numbers, {"cellar": "room"}, {"at": "hall"}, "lit(cellar)")
    assert isinstance(crow.plan(problem), crow.Unsolvable)


@pytest.mark.parametrize(
    ("stated", "message"),
    [
        ({"objects": {"a": "rom"}}, "object `a`: no object type `rom`; did you mean `room`?"),
        ({"objects": {"a b": "room"}}, "`a b` is no name for an object"),
        ({"objects": {"hall": "room"}}, "object `hall` is a constant of the domain already"),
        ({"init": {"feul(hall)": 1}}, "no feature `feul`; did you mean `fuel`?"),
        ({"init": {"fuel(": 1}}, r"`fuel\(` is no cell, such as `on\(a, b\)`"),
        ({"init": {"fuel(hall, hall)": 1}}, "`fuel` takes 1 objects, not 2"),
        ({"init": {"fuel(hal)": 1}}, r"`fuel\(hal\)`: no object `hal`; did you mean `hall`?"),
        ({"init": {"fuel(hall)": 11}}, "would be 11, and may be 0 to 10"),
        ({"init": {"fuel(hall)": 1.5}}, "does not fit into `int64`"),
        ({"init": {"fuel(hall)": True}}, "`True` is no value of type `int64`"),
        ({"init": {"at": "cook"}}, "no object `cook`"),
        ({"init": {"pose": (1.0,)}}, "a vector of 1 elements"),
        ({"goal": "lit(hall"}, "is no condition"),
        ({"goal": "lit(kitchn)"}, "kitchn"),
        ({"goal": "fuel(hall)"}, "fuel"),
        ({"goal": "lit(hall)", "minimize": "lit(hall)"}, "lit"),
        ({"goal": "fuel(hall) == x", "values": {"x": {}}}, "`x` has no value of CDL"),
    ],
)
def test_what_does_not_fit_is_told(
    stated: dict[str, Any], message: str, numbers: crow.Domain
) -> None:
    with pytest.raises(crow.ProblemError, match=message):
        crow.Problem(numbers, **stated)


def test_mistakes_in_files_are_diagnostics(tmp_path: Path) -> None:
    file = tmp_path / "broken.cdl"
    file.write_text("feature f(x: nowhere)\n")
    for load in (cdlc.load, cdlc.load_problem):
        with pytest.raises(cdlc.CompileError, match="nowhere"):
            load(file)
    with pytest.raises(cdlc.CompileError):
        cdlc.load_problem(BLOCKS / "blocks.cdl")
