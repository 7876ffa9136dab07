"""Problems as bytes: what comes out is what went in, and a program travels once."""

from importlib import import_module
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from many_tasks import sussman
from support import EXAMPLES
from towers_in_python import OUTSIDE, PYTHON, towers

import cdlc
import crow
from crow.many.packing import NotSent, Packer, Recent, Unpacker
from crow.many.tasks import Task
from crow.problem import Problem

PROBLEMS = sorted(
    path for path in EXAMPLES.rglob("*.cdl") if 'problem "' in path.read_text("utf-8")
)


def through(problem: Problem) -> Problem:
    packed = Packer().pack(Task(problem))
    return Unpacker().problem(packed.parts, packed.body)


@pytest.mark.parametrize("file", PROBLEMS, ids=lambda path: path.stem)
def test_examples_come_through(file: Path) -> None:
    python = file.with_name("world.py")
    # Packages of examples are imported by their names, as functions that are sent have to be.
    name = f"examples.{file.parent.name}.world"
    functions = import_module(name) if python.is_file() else None
    problem = cdlc.load_problem(file, functions=functions)
    assert through(problem) == problem
    assert through(problem).world.program.behaviors[0].location is not None


def test_functions_of_modules_come_through() -> None:
    problem = towers(OUTSIDE, "on[A, B] = True", "on(B, A)", PYTHON)
    assert through(problem) == problem
    assert through(problem).world.registered == problem.world.registered


def test_simulated_effects_come_through(tmp_path: Path) -> None:
    (tmp_path / "push.cdl").write_text(
        "typedef t\nfeature x(a: t) -> int32\ncontroller push(a: t)\n"
        "behavior move(a: t):\n  goal: x(a) == 3\n  body:\n    do push(a)\n"
    )
    python = tmp_path / "push_simulated.py"
    python.write_text(
        'import crow\n\n@crow.effect\ndef push(state, a):\n    return {("x", a): state.x(a) + 3}\n'
    )
    domain = cdlc.load(tmp_path / "push.cdl", functions=str(python))
    problem = crow.Problem(domain, objects={"a": "t"}, goal="x(a) == 3")
    sent = through(problem)
    assert sent.world.program == problem.world.program
    assert crow.plan(sent).status == crow.plan(problem).status == "plan"


def test_a_program_is_packed_once() -> None:
    packer, unpacker = Packer(), Unpacker()
    problem = sussman()
    problems = [problem, problem.changed(goal=sussman("on(B, A)").goal)]
    packed = [packer.pack(Task(problem)) for problem in problems]
    (first,), (second,) = (list(one.parts.items()) for one in packed)
    assert first[0] == second[0]
    assert first[1] is second[1]
    assert len(packed[1].body) < len(first[1]) / 5
    worlds = [unpacker.problem(packed[0].parts, packed[0].body).world]
    worlds.append(unpacker.problem({}, packed[1].body).world)
    assert worlds[0] is worlds[1]


class Unwilling:
    """A value that does not pickle."""

    def __reduce__(self) -> str:
        raise TypeError("not this one")


def test_what_does_not_pickle_is_told() -> None:
    spoilt = sussman().changed(initial=crow.State({("on", ("A", "B")): Unwilling()}))
    with pytest.raises(NotSent, match="TypeError: not this one"):
        Packer().pack(Task(spoilt))


def test_python_of_no_module_is_told() -> None:
    problem = towers(OUTSIDE, "pass", "on(B, A)", {**PYTHON, "price": lambda x: 1})
    with pytest.raises(NotSent, match="the Python of `price` cannot travel to another process"):
        Packer().pack(Task(problem))


@given(st.lists(st.tuples(st.integers(0, 6), st.booleans()), max_size=60))
def test_two_that_are_used_alike_keep_the_same(uses: list[tuple[int, bool]]) -> None:
    """The driver knows without asking what its workers have."""
    here: Recent[bool] = Recent(3)
    there: Recent[str] = Recent(3)
    for key, _ in uses:
        known = here.get(key) is not None
        if not known:
            here.put(key, value=True)
        assert (there.get(key) is not None) == known
        if not known:
            there.put(key, "part")
