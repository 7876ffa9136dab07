"""Members of M that are the same are one choice where M is chosen from the end."""

from typing import Any

from crow.search.frames import Open, Shared
from crow.search.tailward import _last

SHARED = Shared()
ABOVE = SHARED.application(None, (), 0, ())


def member(what: Any) -> Open:
    return SHARED.open(what, (), ABOVE, 0)


def test_equal_chains_of_a_group_are_one() -> None:
    one, other = member("p"), member("q")
    group = ((one,), (other, one), (one,), (other, one), (other,))
    paths = [path for path, _ in _last(group, merges=True)]
    assert paths == [((0, 0),), ((1, 1),), ((4, 0),)]
    assert len(list(_last(group, merges=False))) == 5


def test_equal_chains_of_different_groups_are_not() -> None:
    inner = SHARED.nested(((member("p"),), (member("p"),)))
    paths = [path for path, _ in _last(((member("p"),), (inner,)), merges=True)]
    assert paths == [((0, 0),), ((1, 0), (0, 0))]
