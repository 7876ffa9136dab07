"""Worlds: objects with their types, cells, and states that keep what differs from its default."""

import pytest
from programs import problem_of, program_of, start, statement_of

from crow.evaluate import EvaluationError
from crow.problem import Problem, State
from crow.program import ObjectType

DOMAIN = """
typedef place
typedef vehicle
typedef truck: vehicle
typedef big_truck: truck
object_constant depot: place
object_constant spare: truck
feature at(v: vehicle, p: place)
feature fuel(t: truck) -> int64
feature running() -> bool
feature weight(v: object) -> float32
"""
OBJECTS = "t1: truck; b1: big_truck; v1: vehicle; p1: place"


def test_objects_are_the_constants_and_then_those_of_the_problem() -> None:
    world, _ = start(DOMAIN, OBJECTS)
    assert list(world.objects) == ["depot", "spare", "t1", "b1", "v1", "p1"]


@pytest.mark.parametrize(
    ("type_", "expected"),
    [
        ("place", ("depot", "p1")),
        ("vehicle", ("spare", "t1", "b1", "v1")),
        ("truck", ("spare", "t1", "b1")),
        ("big_truck", ("b1",)),
        ("object", ("depot", "spare", "t1", "b1", "v1", "p1")),
        ("unknown", ()),
    ],
)
def test_a_type_has_the_objects_of_its_subtypes(type_: str, expected: tuple[str, ...]) -> None:
    world, _ = start(DOMAIN, OBJECTS)
    assert world.objects_of(ObjectType(type_)) == expected
    for name in world.objects:
        assert world.is_of(name, ObjectType(type_)) == (name in expected)


@pytest.mark.parametrize("name", ["ghost", "", None, 3, ["t1"]])
def test_what_is_no_object_is_of_no_type(name: object) -> None:
    world, _ = start(DOMAIN, OBJECTS)
    assert not world.is_of(name, ObjectType("object"))


def test_cells_of_a_feature() -> None:
    world, _ = start(DOMAIN, OBJECTS)
    assert list(world.cells(world.features["fuel"])) == [("spare",), ("t1",), ("b1",)]
    assert list(world.cells(world.features["running"])) == [()]
    assert len(list(world.cells(world.features["at"]))) == 8


def test_a_state_keeps_what_differs_from_its_default() -> None:
    _, state = start(
        DOMAIN,
        OBJECTS,
        "at[t1, p1] = True; at[b1, p1] = False; fuel[t1] = 0; running = True; running = False",
    )
    assert state == State({("at", ("t1", "p1")): True})


def test_an_initial_state_without_value_has_a_place() -> None:
    text = "typedef t\nfeature f(x: t) -> int64\n"
    with pytest.raises(EvaluationError, match="division by zero") as raised:
        problem_of(text, 'problem "p"\nobjects:\n  a: t\ninit: f[a] = 1 // f(a)\ngoal: True\n')
    assert raised.value.location is not None
    assert raised.value.location.line == 4


def test_a_problem_holds_what_its_file_states() -> None:
    stated = statement_of(
        DOMAIN,
        'problem "away"\nobjects:\n  t1: truck\ngoal: at(t1, depot)\nminimize: fuel(t1)\n',
    )
    problem = Problem.of(*stated)
    assert (problem.name, problem.initial) == ("away", State())
    assert problem.minimize is not None
    assert problem.world.program == program_of(DOMAIN)
