"""The state as Python functions see it."""

import copy
from typing import Any

import pytest
from small_program import problem

from crow.views import StateError, StateView

PROBLEM = problem(None)


def view(*reads: str, cells: Any = None) -> Any:
    return StateView(
        PROBLEM.world, PROBLEM.initial.cells if cells is None else cells, set(reads), "f"
    )


def test_cells_are_read_by_name_or_by_index() -> None:
    state = view("at", "held", "count", "on")
    assert state.at("a") == state["at", "a"] == (0.0, 1.0)
    assert (state.held("a"), state.held("b")) == (False, True)
    assert state.count() == state["count"] == 0
    assert state.on("a") == "table"


def test_objects_are_names_in_order() -> None:
    assert view().objects("Box") == ("a", "b")
    assert view().objects("Thing") == ("table", "a", "b")
    assert view().objects() == ("table", "a", "b")


def test_cells_of_a_feature_are_those_with_a_value() -> None:
    state = view("held", "at", "count", "last")
    assert state.cells("held") == {("b",): True}
    assert state.cells("at") == {
        ("table",): (5.0, 5.0),
        ("a",): (0.0, 1.0),
        ("b",): (2.0, 1.0),
    }
    assert list(state.cells("at")) == [("table",), ("a",), ("b",)]
    assert state.cells("count") == {(): 0}
    assert state.cells("last") == {}


@pytest.mark.parametrize(
    ("read", "said"),
    [
        (lambda s: s.at("a"), "`f` reads `at`, and does not say so"),
        (lambda s: s["at", "a"], "does not say so"),
        (lambda s: s.cells("at"), "does not say so"),
        (lambda s: s.att("a"), "no feature `att`"),
        (lambda s: s.held(), "`held` takes 1 object, not 0"),
        (lambda s: s.held("table"), "no object `table` of type `Box`"),
        (lambda s: s.held("c"), "no object `c`"),
        (lambda s: s.last(), r"`last\(\)` has no value"),
        (lambda s: s.objects("Bix"), "no object type `Bix`"),
        (lambda s: s.objects("Spot"), "no object type `Spot`"),
    ],
)
def test_what_it_does_not_have_is_an_error(read: Any, said: str) -> None:
    with pytest.raises(StateError, match=said):
        read(view("held", "last"))


def test_nothing_can_be_written() -> None:
    state = view("held")
    with pytest.raises(AttributeError):
        state.held = 1
    with pytest.raises(TypeError):
        state["held", "a"] = True
    state.cells("held").clear()
    assert state.held("b")


def test_python_may_look_at_it() -> None:
    assert not hasattr(view(), "__deepcopy__")
    assert copy.copy(view("held")).held("b")
