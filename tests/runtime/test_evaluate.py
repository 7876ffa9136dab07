"""Expressions: every node and operator, and computations without a value."""

import math
import time

import pytest
from programs import expression_of, start

from crow.evaluate import EvaluationError, evaluate, evaluate_shared, holds
from crow.problem import State
from crow.program import BOOL, Conditional, Not, Xor
from crow.values import Value

DOMAIN = """
typedef item
typedef box: item
typedef void
typedef pose: vector[float64, 2]
feature p(x: item)
feature on(x: item, y: item)
feature count(x: item) -> int32
feature big(x: item) -> int64
feature small(x: item) -> float32
feature wide(x: item) -> float64
feature place(x: item) -> item
feature label(x: item) -> string
feature at(x: item) -> pose
feature empty()
def external(x: item) -> bool
def twice(n: int64) -> int64: return n + n
def narrow(n: int32) -> int32: return n
def half(n: float64) -> float64: return n / 2
def both(x: item, y: item):
  return on(x, y) and on(y, x)
def sign(n: int64) -> int64:
  if n < 0:
    return -1
  elif n > 0:
    return 1
  return 0
def sum_to(n: int64) -> int64:
  let total = 0
  for i in range(10):
    if i > n:
      break
    if i == 2:
      continue
    total += i
  return total
def found_early(n: int64) -> int64:
  for i in range(10):
    if i * i > n: return i
  return -1
"""
OBJECTS = "a, b: item; c: box"
INIT = """
p[a] = True
on[a, b] = True
count[a] = 7
big[a] = 9223372036854775807
small[a] = 0.1
wide[a] = 0.1
place[a] = c
label[a] = "one"
at[a] = [1, 2.5]
"""

WORLD, STATE = start(DOMAIN, OBJECTS, INIT)


def value(text: str, state: State = STATE) -> Value:
    return evaluate(WORLD, state, expression_of(DOMAIN, text, OBJECTS, value=True), {})


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("7", 7),
        ("1.5", 1.5),
        ('"s"', "s"),
        ("c", "c"),
        ("count(a)", 7),
        ("count[a]", 7),
        ("place(a)", "c"),
        ("count(place(a))", 0),
        ("label(a)", "one"),
        ("at(a)", (1.0, 2.5)),
        ("count(a) + 1", 8),
        ("count(a) - 9", -2),
        ("count(a) * -2", -14),
        ("7 / 2", 3.5),
        ("6 / 2", 3.0),
        ("7 // 2", 3),
        ("-7 // 2", -4),
        ("7 % 3", 1),
        ("-7 % 3", 2),
        ("7 % -3", -2),
        ("7.5 // 2", 3.0),
        ("7.5 % 2", 1.5),
        ("2 ** 10", 1024),
        ("2 ** 0", 1),
        ("2.0 ** -1", 0.5),
        ("0 ** 0", 1),
        ("-1 ** 63", -1),
        ("(-1) ** 9223372036854775807", -1),
        ("1 ** 9223372036854775807", 1),
        ("0 ** 9223372036854775807", 0),
        ("2 ** 62", 2**62),
        ("-count(a)", -7),
        ("abs(-3)", 3),
        ("abs(-0.5)", 0.5),
        ("min(3, 1, 2)", 1),
        ("max(3, 1, 2)", 3),
        ("min(1, 2.5)", 1.0),
        ("1 if p(a) else 2.5", 1.0),
        ("1 if p(b) else 2", 2),
        ("[1, 2.5] + at(a)", (2.0, 5.0)),
        ("at(a) - at(a)", (0.0, 0.0)),
        ("at(a) * 2", (2.0, 5.0)),
        ("2 * at(a)", (2.0, 5.0)),
        ("at(a) / 2", (0.5, 1.25)),
        ("-at(a)", (-1.0, -2.5)),
        ("twice(count(a))", 14),
        ("half(3)", 1.5),
        ("sign(-5) + 10 * sign(5) + sign(0)", 9),
        ("sum_to(4)", 8),
        ("sum_to(-1)", 0),
        ("found_early(10)", 4),
        ("found_early(1000)", -1),
        ("9007199254740993 + 0", 9007199254740993),
        ("big(a) - 1", 2**63 - 2),
    ],
)
def test_values(text: str, expected: Value) -> None:
    found = value(text)
    assert found == expected
    expression = expression_of(DOMAIN, text, OBJECTS, value=True)
    assert evaluate_shared(WORLD, STATE, expression, {}) == expected
    assert type(found) is type(expected)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("True", True),
        ("p(a)", True),
        ("p(b)", False),
        ("empty", False),
        ("not p(b)", True),
        ("p(a) and p(b)", False),
        ("p(a) or p(b)", True),
        ("p(a) ^ p(b)", True),
        ("p(a) ^ p(a)", False),
        ("a == b", False),
        ("a != b", True),
        ("place(a) == c", True),
        ("1 == 1.0", True),
        ("label(a) == \"one\"", True),
        ("at(a) == [1, 2.5]", True),
        ("at(a) != [1, 2]", True),
        ("p(a) == p(b)", False),
        ("p(a) != p(b)", True),
        ("1 < 2", True),
        ("2 < 2", False),
        ("2 <= 2", True),
        ("2 > 2", False),
        ("2 >= 2", True),
        ("1 < 2 < 3", True),
        ("1 < 2 > 3", False),
        ("both(a, b)", False),
        ("forall x: item: not on(x, x)", True),
        ("forall x: item: p(x)", False),
        ("exists x: item: p(x)", True),
        ("exists x: box: p(x)", False),
        ("exists x, y: item: on(x, y)", True),
        ("exists x: item, y: box: on(x, y)", False),
        ("forall x: void: False", True),
        ("exists x: void: True", False),
        ("forall x: item, y: void: False", True),
        ("forall x: item where p(x): x == a", True),
        ("exists x: item where p(x): x == b", False),
        ("forall x: item: exists y: item: x == y", True),
        ("exists y: item: forall x: item: x == y", False),
        ("forall x: item: (exists x: item: p(x)) or not p(x)", True),
        ("p(a) if p(b) else p(b)", False),
    ],
)  # fmt: skip
def test_conditions(text: str, expected: bool) -> None:
    condition = expression_of(DOMAIN, text, OBJECTS)
    assert holds(WORLD, STATE, condition, {}) is expected
    assert evaluate_shared(WORLD, STATE, condition, {}) is expected


def test_shared_parts_are_evaluated_once() -> None:
    node = expression_of(DOMAIN, "exists x: item: p(x) and not p(b)", OBJECTS)
    for _ in range(100):  # its text would have some 3 ** 100 parts
        node = Conditional(node, Xor(Not(node), node), node, BOOL)
    assert evaluate_shared(WORLD, STATE, node, {}) is True


@pytest.mark.parametrize(
    "text",
    [
        "p(b) and 1 / 0 == 1",
        "not (p(a) or 1 / 0 == 1)",
        "1 == (2 if p(a) else 1 // 0)",
        "p(b) and external(a)",
        "forall x: item: not p(x) and 1 / 0 == 1",
    ],
)
def test_what_is_not_needed_is_not_computed(text: str) -> None:
    assert not holds(WORLD, STATE, expression_of(DOMAIN, text, OBJECTS), {})


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1 / 0", "division by zero"),
        ("1 // 0", "division by zero"),
        ("1 % 0", "division by zero"),
        ("1.0 / 0", "division by zero"),
        ("0 ** -1", "division by zero"),
        ("2 ** -1", "negative power"),
        ("at(a) / 0", "division by zero"),
        ("big(a) + 1", "does not fit into `int64`"),
        ("-(-big(a) - 1)", "does not fit into `int64`"),
        ("abs(-big(a) - 1)", "does not fit into `int64`"),
        ("2 ** 63", "does not fit into `int64`"),
        ("10 ** 9223372036854775807", "does not fit into `int64`"),
        ("twice(big(a))", "does not fit into `int64`"),
        ("narrow(big(a))", "does not fit into `int32`"),
        ("(-8.0) ** 0.5", "not a real number"),
        ("1e308 * 10", "too large"),
        ("10.0 ** 400", "too large"),
        ("at(a) * 1e308 * 100", "too large"),
        ("place(b)", "`place(b)` has no value"),
        ("label(b)", "`label(b)` has no value"),
        ("at(b)", "`at(b)` has no value"),
    ],
)
def test_computations_without_a_value(text: str, message: str) -> None:
    with pytest.raises(EvaluationError) as raised:
        value(text)
    assert message in str(raised.value)
    assert raised.value.location is not None
    if "twice" not in text and "narrow" not in text:
        assert raised.value.location.file == "expression.cdl"


def test_the_place_is_that_of_the_part_that_failed() -> None:
    with pytest.raises(EvaluationError) as raised:
        value("1 + (2 // (3 - 3))")
    assert raised.value.location is not None
    assert (raised.value.location.column, raised.value.location.end_column) == (16, 27)


def test_an_external_function_needs_its_python() -> None:
    with pytest.raises(EvaluationError, match="`external`"):
        holds(WORLD, STATE, expression_of(DOMAIN, "external(a)", OBJECTS), {})


def test_float32_is_rounded_in_the_cell_only() -> None:
    assert value("wide(a)") == 0.1
    assert value("small(a)") == pytest.approx(0.1, abs=1e-8)
    assert value("small(a)") != 0.1
    assert value("small(a) + 0.1") == value("small(a)") + 0.1


def test_defaults_of_unset_cells() -> None:
    assert [value(f"{f}(b)", State()) for f in ("count", "big")] == [0, 0]
    assert [value(f"{f}(b)", State()) for f in ("small", "wide")] == [0.0, 0.0]
    assert math.copysign(1, value("wide(b)", State())) == 1


def test_a_chain_of_functions_longer_than_the_stack_is_an_error_with_a_place() -> None:
    links = "\n".join(f"def f{i}(x: item): return f{i + 1}(x)" for i in range(400))
    domain = f"typedef item\nfeature p(x: item)\n{links}\ndef f400(x: item): return p(x)\n"
    world, state = start(domain, "a: item")
    with pytest.raises(EvaluationError, match="nested too deeply") as raised:
        holds(world, state, expression_of(domain, "f0(a)", "a: item"), {})
    assert raised.value.location is not None


def test_quantifiers_stop_at_the_first_witness() -> None:
    objects = ", ".join(f"o{i}" for i in range(300))
    domain = "typedef t\nfeature p(x: t)\n"
    world, state = start(domain, f"{objects}: t", "p[o0] = True")
    text = "exists x, y, z, w: t: p(x) and p(y) and p(z) and p(w)"
    condition = expression_of(domain, text, f"{objects}: t")
    began = time.monotonic()
    assert holds(world, state, condition, {})
    assert time.monotonic() - began < 5
