"""Programs with functions in Python plan as those with the same functions in CDL."""

from collections.abc import Callable
from dataclasses import fields, replace
from itertools import count
from typing import Any

import pytest
from oracle import ENGINES, OverTheCapError, answer, compare
from programs import problem_of
from small_programs import small_program
from towers_in_python import IN_CDL, OUTSIDE, PYTHON, READING_ALL, towers

import crow
from crow.planning import NotPlannable
from crow.problem import Problem
from crow.program import Achieve, Annotation, Apply, Function, Node, Read
from crow.registration import registered
from crow.replay import replay_to_goal

CASES = {
    "one upon another": ("pass", "on(A, B)", 3),
    "turned over": ("on[C, A] = True", "on(A, C)", 4),
    "too dear": ("on[C, A] = True", "on(A, B) and price(A) < 2", 3),
    "uncovered": ("on[A, B] = True", "clear(B)", 3),
    "uncovered from the top": ("on[A, B] = True\n  on[B, C] = True", "clear(C)", 4),
    "two of them": ("on[A, B] = True", "clear(B) and spent == 2", 1),
    "in the hand": ("holding[C] = True", "handempty() and spent == 0", 1),
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("outside", [OUTSIDE, READING_ALL], ids=["reads", "reads all"])
def test_all_engines_find_the_same_plans(case: str, outside: str) -> None:
    init, goal, depth = CASES[case]
    in_cdl, in_python = towers(IN_CDL, init, goal), towers(outside, init, goal, PYTHON)
    for most in range(depth + 1):
        expected = compare(in_cdl, most)
        found = compare(in_python, most)
        assert found.plans == expected.plans
        assert found.is_cut == expected.is_cut


@pytest.mark.parametrize(("engine", "heuristic"), ENGINES)
def test_longer_plans_replay(engine: str, heuristic: str) -> None:
    init, goal = "on[A, B] = True\n  on[B, C] = True", "on(C, B) and on(B, A)"
    problem = towers(OUTSIDE, init, goal, PYTHON)
    result = answer(problem, engine, heuristic, 6)
    assert isinstance(result, crow.Plan)
    assert replay_to_goal(problem, result.trace).is_sound
    (first, *_) = result.steps
    assert first.controller == "pick"
    assert first.arguments == ("A", 2)


def test_what_is_not_given_is_named_before_the_search() -> None:
    given = {name: python for name, python in PYTHON.items() if name != "beside"}
    problem = towers(OUTSIDE, "pass", "on(A, B)", given)
    with pytest.raises(NotPlannable, match="the external function `beside`, whose Python is not"):
        crow.plan(problem)


@pytest.mark.parametrize("engine", ["auto", "best", "iddfs", "iw", "reference"])
def test_what_python_raises_ends_the_search(engine: str) -> None:
    def clear(state: object, x: str) -> bool:
        raise KeyError(x)

    problem = towers(OUTSIDE, "pass", "on(A, B)", {**PYTHON, "clear": clear})
    with pytest.raises(crow.FunctionError) as raised:
        crow.plan(problem, engine, depth_limit=3)
    error = raised.value
    assert (error.name, error.reason) == ("clear", f"raised KeyError: {error.call[6:7]!r}")
    assert error.location is not None
    assert "raise KeyError(x)" in error.traceback
    assert "externals.py" not in error.traceback


# ------------------------------------------------------------------------------ random programs


def through_functions(problem: Problem, *, says_which: bool) -> Problem:
    """The problem with each read of what is no goal as a call of Python that reads the state.

    Such a function `says_which` feature it reads, or that it reads all.
    """
    program = problem.world.program
    functions = tuple(
        Function(
            f"read_{f.name}", f.parameters, f.type, None,
            annotations=(Annotation("reads", (f.name if says_which else "all",)),),
        )
        for f in program.features
    )  # fmt: skip
    changed = replace(
        program,
        functions=(*program.functions, *functions),
        behaviors=tuple(map(_read_through, program.behaviors)),
        controllers=tuple(map(_read_through, program.controllers)),
    )
    python = {f"read_{f.name}": _reader(f.name) for f in program.features}
    world = replace(problem.world, program=changed, registered=registered(changed, python))
    return problem.changed(world=world)


def _reader(feature: str) -> Callable[..., Any]:
    return lambda state, *objects: state[feature, *objects]


def _read_through(node: Any) -> Any:
    if isinstance(node, tuple):
        return tuple(map(_read_through, node))
    if isinstance(node, Achieve) or not isinstance(node, Node):
        return node
    parts = {f.name: getattr(node, f.name) for f in fields(node) if f.name != "goal"}
    made = replace(node, **{name: _read_through(part) for name, part in parts.items()})
    if isinstance(made, Read):
        return Apply(f"read_{made.feature}", made.arguments, made.type, location=made.location)
    return made


@pytest.mark.parametrize("part", range(3))
def test_random_programs_that_read_through_python(part: int) -> None:
    """150 programs to depth 2, with equal plans whichever way they read."""
    solvable = compared = 0
    for seed in count(700_000 + 1_000 * part):
        small = small_program(seed)
        problem = problem_of(small.domain, small.problem)
        through = through_functions(problem, says_which=bool(seed % 2))
        try:
            expected = compare(problem, 2, engines=())
            found = compare(through, 2, engines=(ENGINES[seed % len(ENGINES)],))
        except OverTheCapError:
            continue
        assert found.plans == expected.plans, f"seed {seed}\n{small.domain}{small.problem}"
        solvable += bool(found.plans)
        compared += 1
        if compared == 50:
            break
    assert solvable > 10
