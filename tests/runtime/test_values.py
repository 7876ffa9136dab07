"""Values as CDL writes them."""

import pytest

from crow.program import BOOL, FLOAT64, INT64, STRING, NamedType, ObjectType, Type, VectorType
from crow.values import Value, shown

ROWS = NamedType("Rows", VectorType(STRING, None))


@pytest.mark.parametrize(
    ("value", "type_", "text"),
    [
        (True, BOOL, "True"),
        (-3, INT64, "-3"),
        (0.5, FLOAT64, "0.5"),
        ("a", ObjectType("T"), "a"),
        ('say "a"\n', STRING, '"say \\"a\\"\\n"'),
        ((1, 2), VectorType(INT64, 2), "[1, 2]"),
        (("##", "# "), ROWS, '["##", "# "]'),
        (((1.0,), (2.5,)), VectorType(VectorType(FLOAT64, 1), 2), "[[1.0], [2.5]]"),
        (("a", "b"), VectorType(ObjectType("T"), 2), "[a, b]"),
    ],
)
def test_shown(value: Value, type_: Type, text: str) -> None:
    assert shown(value, type_) == text
