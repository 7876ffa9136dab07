"""Maps with layers are maps: the same as dictionaries, whatever is done to them."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from crow.constraints.layered import GONE, Draft, Layered

Changes = st.dictionaries(st.integers(0, 60), st.integers() | st.just(GONE), max_size=30)


@given(st.lists(Changes, max_size=30))
def test_it_does_what_a_dictionary_does_and_leaves_earlier_ones_alone(
    steps: list[dict[int, int]],
) -> None:
    layered: Layered[int, int] = Layered()
    plain: dict[int, int] = {}
    before = []
    for changes in steps:
        before.append((layered, dict(plain)))
        layered = layered.changed(changes)
        plain = {k: v for k, v in {**plain, **changes}.items() if v is not GONE}
    for one, expected in (*before, (layered, plain)):
        assert dict(one) == expected
        assert len(one) == len(expected)
        assert (one.first() is None) == (not expected)
        assert all((key in one) == (key in expected) for key in range(61))


def test_a_draft_shows_its_changes() -> None:
    draft = Draft(Layered({"a": 1, "b": 2}))
    draft["c"] = 3
    draft.drop("a")
    draft.drop("never there")
    assert "a" not in draft
    assert (draft.get("b"), draft.get("c"), draft.get("a")) == (2, 3, None)
    assert dict(draft.made()) == {"b": 2, "c": 3}


def test_what_is_not_there_has_no_value() -> None:
    with pytest.raises(KeyError):
        Layered({1: 2}).changed({1: GONE})[1]


def test_many_small_changes_do_not_copy_everything_each_time() -> None:
    layered: Layered[int, int] = Layered(dict.fromkeys(range(10_000), 0))
    copies = 0
    for number in range(1_000):
        after = layered.changed({number: 1})
        copies += after._below is not layered._below
        layered = after
    assert copies <= 12
    assert sum(layered.values()) == 1_000
