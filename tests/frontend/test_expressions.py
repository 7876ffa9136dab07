"""Expressions: which types fit where (language.md §4)."""

import pytest
from cases import condition, value

ACCEPTED_VALUES = [
    # numbers promote from int to float
    "1 + 1",
    "1 + 1.5",
    "size(x) + 1",
    "level(x) + count",
    "count() - count[...]",
    "-size(x) * 2 ** 3",
    "7 // 2 % 3",
    "1 / 2",
    "min(1, 2.5, size(x))",
    "max(level(x), 0)",
    "abs(-1)",
    "-9223372036854775808",
    # a value typedef and its base convert
    "width(x) + 1.0",
    "width(x) + size(x)",
    "width(x) * mass(x)",
    "width(x) / mass(x)",
    # vectors
    "position(x) + position(y)",
    "position(x) + [1, 2]",
    "[1, 2] + position(x)",
    "2 * position(x)",
    "position(x) / 2",
    "-position(x)",
    "[1, 2.5]",
    "[x, b]",
    '["a", "b"]',
    "[True, False]",
    # conditionals and quantifiers
    "1 if clear(x) else 2.5",
    "x if clear(x) else b",
    "at(x)",
    "table",
    "forall z: block: clear(z)",
    '"text"',
    "middle(position(x), position(y))",
    "middle(position(x), [0, 0])",
]
REJECTED_VALUES = [
    ("True + 1", ["wrong-type"]),
    ("-True", ["wrong-type"]),
    ("clear(x) + 1", ["wrong-type"]),
    ("x + 1", ["wrong-type"]),
    ('"a" + "b"', ["wrong-type"]),
    ("min(True, 1)", ["wrong-type"]),
    ("min(1)", ["wrong-argument-count"]),
    ("abs(1, 2)", ["wrong-argument-count"]),
    ("width(x) + mass(x)", ["wrong-type"]),
    ("max(width(x), mass(x))", ["wrong-type"]),
    ("position(x) + extent(x)", ["wrong-type"]),
    ("position(x) + [1, 2, 3]", ["wrong-type"]),
    ("position(x) * position(y)", ["wrong-type"]),
    ("position(x) + 1", ["wrong-type"]),
    ("1 / position(x)", ["wrong-type"]),
    ("near(position(x), [1, 2, 3])", ["wrong-type"]),
    ("[1, x]", ["wrong-type"]),
    ("1 if clear(x) else x", ["wrong-type"]),
    ("width(x) if clear(x) else mass(x)", ["wrong-type"]),
    ("1 if count else 2", ["wrong-type"]),
    ("9223372036854775808", ["number-too-large"]),
    ("1e999", ["number-too-large"]),
    ("near(position(x), extent(y))", ["wrong-argument-type"]),
    ("clear(table)", ["wrong-argument-type"]),
    ("heavy(x)", ["wrong-argument-type"]),
    ("on(x)", ["wrong-argument-count"]),
    ("on(x, y, b)", ["wrong-argument-count"]),
    ("clear", ["wrong-argument-count"]),
    ("clear[...]", ["elision"]),
    ("on[x, ...]", ["elision"]),
    ("number(...)", ["elision"]),
    ("number[x]", ["wrong-kind"]),
    ("number", ["wrong-kind"]),
    ("pick(x)", ["wrong-kind"]),
    ("x(y)", ["wrong-kind"]),
    ("table(x)", ["wrong-kind"]),
    ("unknown", ["unknown-name"]),
    ("unknown(x)", ["unknown-feature"]),
    # data-oblivious: cells are indexed by objects
    ("clear(count)", ["value-index"]),
    ("clear(1)", ["value-index"]),
    ("size[count + 1]", ["value-index"]),
    ("forall p: Pose: near(p, p)", ["not-an-object-type"]),
    ("forall p: unknown: clear(p)", ["unknown-type"]),
]
ACCEPTED_CONDITIONS = [
    "clear(x) and not clear(y) or clear(b)",
    "clear(x) ^ clear(y)",
    "x == b",
    "b != x",
    "at(x) == table",
    "1 < size(x) <= 2.5 < level(x)",
    "width(x) < 1.5",
    "position(x) == [1, 2]",
    "[1, 2] == position(x)",
    'label(x) == "red"',
    "clear(x) == clear(y)",
    "forall z: block, w: box: on(z, w)",
    "forall z, w: block: on(z, w) or z == w",
    "exists z: block where clear(z): on(x, z)",
    "forall z: block where clear(z): on(x, z)",
    "heavy(b)",
    "clear(b)",
    "near(position(x), position(y))",
    "clear[x]",
    "(forall z: block: clear(z)) and clear(x)",
    "clear(x) and forall z: block: clear(z)",
    "not exists z: block: on(z, x)",
    "clear(x) if clear(y) else clear(b)",
]
REJECTED_CONDITIONS = [
    ("count", ["wrong-type"]),
    ("1", ["wrong-type"]),
    ("x", ["wrong-type"]),
    ("count and clear(x)", ["wrong-type"]),
    ("not count", ["wrong-type"]),
    ("count ^ clear(x)", ["wrong-type"]),
    ("x == table", ["not-comparable"]),
    ("x == 1", ["not-comparable"]),
    ("x < y", ["not-comparable"]),
    ("clear(x) == 1", ["not-comparable"]),
    ("clear(x) < clear(y)", ["not-comparable"]),
    ("label(x) < label(y)", ["not-comparable"]),
    ("width(x) < mass(x)", ["not-comparable"]),
    ("width(x) == mass(x)", ["not-comparable"]),
    ("position(x) == extent(x)", ["not-comparable"]),
    ("forall z: block: count", ["wrong-type"]),
    ("exists z: block where count: clear(z)", ["wrong-type"]),
    ("forall z, z: block: clear(z)", ["duplicate-definition"]),
    ("forall clear: block: True", ["hides-definition"]),
    ("forall x: block: clear(x)", ["shadowing"]),
]
ONE_MISTAKE = [
    "unknown(x) + 1 == 2",
    "clear(unknown) and on(unknown, x)",
    "forall z: nowhere: on(z, x) and z == 1",
    "-unknown < 2",
    "[unknown, 1] == position(x)",
    "(1 if clear(x) else unknown) > 2",
    "not unknown(x, y, 1 + 1)",
    "min(unknown, 2) == 1",
    "unknown[x] == [1, 2]",
]


@pytest.mark.parametrize("text", ACCEPTED_VALUES)
def test_accepted_values(text: str) -> None:
    assert value(text) == []


@pytest.mark.parametrize(("text", "expected"), REJECTED_VALUES)
def test_rejected_values(text: str, expected: list[str]) -> None:
    assert value(text) == expected


@pytest.mark.parametrize("text", ACCEPTED_CONDITIONS)
def test_accepted_conditions(text: str) -> None:
    assert condition(text) == []


@pytest.mark.parametrize(("text", "expected"), REJECTED_CONDITIONS)
def test_rejected_conditions(text: str, expected: list[str]) -> None:
    assert condition(text) == expected


@pytest.mark.parametrize("text", ONE_MISTAKE)
def test_one_mistake_gives_one_kind_of_message(text: str) -> None:
    assert len(set(condition(text))) == 1


def test_deep_expressions_are_reported() -> None:
    assert value(" + ".join(["1"] * 400)) == ["nesting-too-deep"]
    assert condition("not " * 400 + "clear(x)") == ["nesting-too-deep"]
