"""Expressions as text: what is printed reads back as the same tree."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import expression_of

from crow.program import (
    BOOL,
    FLOAT64,
    INT64,
    STRING,
    Arithmetic,
    Compare,
    Constant,
    Expression,
    Negative,
    Parameter,
)
from crow.text import expression_text, statistics_text, variables_text

DOMAIN = """
typedef T
typedef U: T
typedef pose: vector[float64, 2]
feature p(x: T)
feature in(x: T, goal: T)
feature handempty()
feature f(x: T) -> int64
feature g(x: T) -> float64
feature place(x: T) -> T
feature at(x: T) -> pose
feature label(x: T) -> string
def holds(x: T, flag: bool) -> bool
def dist(x: pose, y: pose) -> float64
"""
OBJECTS = "a, b: T; each: U"


def read(text: str) -> Expression:
    return expression_of(DOMAIN, text, OBJECTS)


# Conditions as text with every operand in parentheses, whether it needs them or not.


def _operation(*parts: str | st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    texts = [st.just(part) if isinstance(part, str) else part for part in parts]
    return st.tuples(*texts).map("".join)


def _in_parentheses(text: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    return text.map("({})".format)


OBJECT = st.recursive(
    st.sampled_from(["a", "b", "each"]),
    lambda inner: _operation("place(", inner, ")"),
    max_leaves=3,
)
STRINGS = st.sampled_from(
    ["label(a)", r'"say \"so\""', r'"back\\slash"', '""', r'"line\nend"', '"é#;"']
)
LITERALS = st.one_of(
    st.integers(0, 2**63 - 1).map(str),
    st.floats(0, 1e300, allow_nan=False).map(str),
    st.sampled_from(["1e22", "1E-7", "0.1", "0", "2.0"]),
)
NUMBER = st.recursive(
    st.one_of(LITERALS, _operation("f(", OBJECT, ")"), _operation("g(", OBJECT, ")")),
    lambda inner: st.one_of(
        _operation("-", _in_parentheses(inner)),
        _operation(
            _in_parentheses(inner),
            st.sampled_from([" + ", " - ", " * ", " / ", " // ", " % ", " ** "]),
            _in_parentheses(inner),
        ),
        _operation("min(", inner, ", ", inner, ")"),
        _operation("abs(", inner, ")"),
        _operation(_in_parentheses(inner), " if p(a) else ", _in_parentheses(inner)),
    ),
    max_leaves=8,
)
VECTOR = st.one_of(
    _operation("at(", OBJECT, ")"),
    _operation("at(a) + [", NUMBER, ", ", NUMBER, "]"),
    _operation("-at(", OBJECT, ")"),
)
COMPARISON = st.sampled_from([" == ", " != ", " < ", " <= ", " > ", " >= "])
LEAF = st.one_of(
    st.sampled_from(["True", "False", "handempty()", "in(a, b)", "p(each)"]),
    _operation(NUMBER.map("({})".format), COMPARISON, NUMBER.map("({})".format)),
    _operation(OBJECT, st.sampled_from([" == ", " != "]), OBJECT),
    _operation(VECTOR, " == at(b)"),
    _operation(STRINGS, " == label(b)"),
    _operation("dist(", VECTOR, ", at(a)) < 1"),
)
CONDITION = st.recursive(
    LEAF,
    lambda inner: st.one_of(
        _operation("not ", _in_parentheses(inner)),
        _operation(
            _in_parentheses(inner),
            st.sampled_from([" and ", " or ", " ^ ", " == ", " != "]),
            _in_parentheses(inner),
        ),
        _operation(_in_parentheses(inner), " and p(a) and ", _in_parentheses(inner)),
        _operation(
            _in_parentheses(inner), " if ", _in_parentheses(inner), " else ", _in_parentheses(inner)
        ),
        _operation(
            st.sampled_from(["forall x: T: ", "exists x, goal: U: ", "exists x: T, y: U: "]),
            _in_parentheses(inner),
        ),
        _operation("holds(a, ", inner, ")"),
    ),
    max_leaves=10,
)


@given(CONDITION)
@settings(max_examples=150, deadline=None)
def test_what_is_printed_reads_back_as_the_same_tree(text: str) -> None:
    tree = read(text)
    assert read(expression_text(tree)) == tree


@pytest.mark.parametrize(
    "text",
    [
        "p(a) and p(b) or not p(a)",
        "p(a) and (p(b) or p(a))",
        "p(a) or p(b) or p(a)",
        "not (p(a) and p(b))",
        "not not p(a)",
        "(exists x: T: p(x)) and p(a)",
        "p(a) and (exists x: T: p(x))",
        "not (forall x: T: p(x))",
        "forall x: T: exists y: U: in(x, y)",
        "forall x: T, y: U: in(x, y) or p(x)",
        "holds(a, exists x: T: p(x))",
        "1 - (2 - 3) == 0",
        "1 - 2 - 3 == 0",
        "2 ** 3 ** 2 == 0",
        "(2 ** 3) ** 2 == 0",
        "-2 ** 2 == 0",
        "(-2) ** 2 == 0",
        "2 ** -1.0 == 0",
        "2 * (3 + 4) == 0",
        "2 * 3 + 4 == 0",
        "2 / (3 / 4) == 0",
        "- -f(a) == 0",
        "(1 if p(a) else 2) + 3 == 0",
        "(p(a) if p(b) else p(a)) if p(b) else p(a)",
        "p(a) if p(b) else p(a) if p(a) else p(b)",
        "p(a) ^ p(b) ^ p(a)",
        "p(a) ^ (p(b) ^ p(a))",
        "(p(a) == p(b)) == p(a)",
        "(1 < 2) == (2 < 3)",
        "at(a) == [1, -2.5]",
        "place(place(a)) == a",
        'label(a) == "say \\"so\\""',
    ],
)
def test_parentheses_stand_only_where_they_are_needed(text: str) -> None:
    assert expression_text(read(text)).replace("--", "- -") == text


def test_a_chain_is_a_conjunction() -> None:
    assert expression_text(read("1 < f(a) < 3")) == "1 < f(a) and f(a) < 3"


def test_where_is_resolved() -> None:
    assert (
        expression_text(read("exists x: T where p(x): in(x, a)"))
        == "exists x: T: p(x) and in(x, a)"
    )
    assert expression_text(read("forall x: T where p(x): in(x, a)")) == (
        "forall x: T: not p(x) or in(x, a)"
    )


@pytest.mark.parametrize(("value", "text"), [(-1, "(-1) ** 2 == 1"), (-1.5, "(-1.5) ** 2 == 1")])
def test_a_negative_constant_is_an_operand_like_a_negation(value: float, text: str) -> None:
    """No literal is negative, but a compiled program may hold such a constant."""
    type_ = INT64 if isinstance(value, int) else FLOAT64
    negative, two, one = (Constant(v, type_) for v in (value, 2, 1))
    condition = Compare("==", Arithmetic("**", negative, two, type_), one)
    assert expression_text(condition) == text
    assert isinstance(read(text), Compare)
    assert expression_text(Negative(negative, type_)).startswith("-")


@pytest.mark.parametrize(
    "text", ["line\nend", "tab\t", "\x00", 'q"', "back\\", "é", "\\n", "\u2028"]
)
def test_strings_stay_on_one_line_and_read_back(text: str) -> None:
    condition = Compare("==", Constant(text, STRING), Constant("x", STRING))
    printed = expression_text(condition)
    assert len(printed.splitlines()) == 1
    assert read(printed) == condition


def test_variables() -> None:
    assert variables_text((Parameter("x", BOOL), Parameter("n", INT64))) == "x: bool, n: int64"


def test_statistics_are_told_in_words() -> None:
    figures = {
        "seconds": 1.04, "depth": 3, "nodes": 12345, "states": 7, "effects": 8,
        "pruned": {"depth": 1, "duplicates": 2, "hopeless": 3, "width": 4},
    }  # fmt: skip
    assert statistics_text(figures) == (
        "searched 12,345 nodes in 1.0 s, to depth 3: 7 states, 8 effects\n"
        "left out: 1 too deep, 2 seen before, 3 without hope, 4 too wide"
    )
    assert statistics_text({"nodes": 0}) == "searched 0 nodes"
