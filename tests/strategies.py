"""Random CDL: every tree the parser can yield, from the node classes of syntax.py.

Trees are such as a parser yields them, so that printing and parsing gives them back: a chain of
`and` is one node, a block has a statement, and literals are not negative outside annotations.
"""

from dataclasses import replace
from typing import Any

from hypothesis import strategies as st

from cdlc.editors.vocabulary import vocabulary
from cdlc.frontend import syntax
from cdlc.source import Span

SPAN = Span(0, 0)

_WORDS = vocabulary()


def node(kind: type[Any], *arguments: st.SearchStrategy[Any], **named: Any) -> Any:
    """A node of a kind with random fields."""
    return st.builds(kind, *arguments, **named, span=st.just(SPAN))


def tuples(items: st.SearchStrategy[Any], least: int = 0, most: int = 3) -> Any:
    return st.lists(items, min_size=least, max_size=most).map(tuple)


def opaque(strategy: Any) -> Any:
    """The same with a short name: hypothesis spells strategies out, which takes long for these."""

    @st.composite
    def tree(draw: Any) -> Any:
        return draw(strategy)

    return tree()


def nested(leaves: Any, around: Any, depth: int) -> Any:
    """Leaves, and what `around` makes of them, up to a depth."""
    made = leaves = opaque(leaves)
    for _ in range(depth):
        made = opaque(st.one_of(leaves, around(made)))
    return made


# ------------------------------------------------------------------------------ names and literals

# Short words make short lines, long ones lines to be broken; drawing from a list is quick.
_TEXTS = [
    "a",
    "b",
    "x1",
    "_",
    "T",
    "vector",
    "Inner",
    "andy",
    "_0",
    "range",
    "a_name_of_some_length",
]
_TEXTS += [letter * length for letter, length in zip("klmnop", range(20, 80, 10), strict=True)]
texts = st.sampled_from([*_TEXTS, *sorted(_WORDS.soft)])
names = node(syntax.Name, texts)
variables = node(syntax.Name, texts.filter(lambda text: text != "in"))

integers = st.integers(0, 10**39)
floats = st.floats(0, allow_nan=False, allow_infinity=False).map(abs)
strings = st.text(max_size=8)
literals = node(syntax.Literal, st.one_of(st.booleans(), integers, floats, strings))

negative = st.one_of(st.integers(-(10**39), -1), floats.map(lambda value: -value))
annotation_values = st.one_of(st.none(), names, literals, node(syntax.Literal, negative))
annotations = node(syntax.Annotation, names, annotation_values)
annotated = {"annotations": st.one_of(st.just(()), tuples(annotations, 1))}

# ------------------------------------------------------------------------------------------- types

named_types = node(syntax.NamedType, texts)


def _type_around(inner: Any) -> Any:
    lengths = st.one_of(st.none(), st.integers(0, 999))
    return st.one_of(node(syntax.VectorType, names, inner, lengths), node(syntax.ListType, inner))


types = nested(named_types, _type_around, 2)
maybe_types = st.one_of(st.none(), types)
parameters = tuples(node(syntax.TypedName, names, maybe_types))


def declared(names_: Any, last: Any) -> Any:
    """`x, y: T, z`, the last one with a type that `last` gives."""
    before = tuples(node(syntax.TypedName, names_, maybe_types), 0, 2)
    return st.builds(lambda some, one: (*some, one), before, node(syntax.TypedName, names_, last))


quantified = declared(variables, types)

# ------------------------------------------------------------------------------------- expressions

_ARITHMETIC = st.sampled_from(["+", "-", "*", "/", "//", "%", "**", "^"])
_COMPARISONS = st.sampled_from(["==", "!=", "<", "<=", ">", ">="])


def call_arguments(inner: Any) -> Any:
    return tuples(st.one_of(inner, node(syntax.Ellipsis_)))


def calls(inner: Any, bracketed: Any = None) -> Any:
    kinds = st.booleans() if bracketed is None else st.just(bracketed)
    return node(syntax.Call, names, call_arguments(inner), kinds)


def _as_parsed(node: syntax.Connective) -> syntax.Connective:
    """`(a and b) and c` is one chain."""
    first, *others = node.operands
    if isinstance(first, syntax.Connective) and first.operator == node.operator:
        return replace(node, operands=(*first.operands, *others))
    return node


def _connectives(inner: Any) -> Any:
    operators = st.sampled_from(["and", "or"])
    return node(syntax.Connective, operators, tuples(inner, 2, 4)).map(_as_parsed)


@st.composite
def _comparisons(draw: Any, inner: Any) -> syntax.Comparison:
    operators = draw(tuples(_COMPARISONS, 1))
    operands = tuple(draw(inner) for _ in range(len(operators) + 1))
    return syntax.Comparison(operators, operands, span=SPAN)


def _compound(inner: Any) -> Any:
    return st.one_of(
        calls(inner),
        node(syntax.VectorLiteral, call_arguments(inner)),
        node(syntax.Unary, st.sampled_from(["not", "-"]), inner),
        _connectives(inner),
        node(syntax.Binary, _ARITHMETIC, inner, inner),
        _comparisons(inner),
        node(syntax.Conditional, inner, inner, inner),
        node(
            syntax.Quantified,
            st.sampled_from(["forall", "exists"]),
            quantified,
            st.one_of(st.none(), inner),
            inner,
        ),
    )


expressions = nested(st.one_of(literals, node(syntax.NameExpression, texts)), _compound, 3)

# -------------------------------------------------------------------------------------- statements

_ORDERS = st.sampled_from(["sequential", "unordered", "alternative"])
_ASSIGNMENTS = st.sampled_from(["=", "+=", "-=", "*=", "/="])
_bound = declared(names, maybe_types)

binds = st.one_of(
    node(syntax.Bind, _bound, st.just("free"), st.none(), **annotated),
    node(syntax.Bind, _bound, st.sampled_from(["where", "equal"]), expressions, **annotated),
    node(
        syntax.Bind,
        node(syntax.TypedName, names, st.none()).map(lambda name: (name,)),
        st.just("call"),
        calls(expressions, bracketed=False),
        **annotated,
    ),
)
simple_statements = st.one_of(
    node(syntax.Let, names, maybe_types, expressions, **annotated),
    node(syntax.Assert, expressions, **annotated),
    node(syntax.Achieve, expressions, st.booleans(), **annotated),
    node(syntax.CallStatement, calls(expressions, bracketed=False), st.booleans(), **annotated),
    node(
        syntax.Assignment,
        st.one_of(node(syntax.NameExpression, texts), calls(expressions)),
        _ASSIGNMENTS,
        expressions,
        **annotated,
    ),
    binds,
    node(syntax.Word, st.sampled_from(["commit", "break", "continue", "pass"]), **annotated),
    node(syntax.Return, expressions, **annotated),
)


def _compound_statements(inner: Any) -> Any:
    block = tuples(inner, 1)
    branches = tuples(st.tuples(expressions, block), 1)
    return st.one_of(
        node(syntax.Group, _ORDERS, block, **annotated),
        node(syntax.Promotable, st.one_of(st.none(), _ORDERS), block, **annotated),
        node(syntax.ForEach, quantified, block, **annotated),
        node(syntax.ForRange, variables, names, call_arguments(expressions), block, **annotated),
        node(syntax.If, branches, st.one_of(st.none(), block), **annotated),
    )


statements = nested(simple_statements, _compound_statements, 2)
blocks = tuples(statements, 1)

# ------------------------------------------------------------------------------------- definitions

goals = node(syntax.Goal, expressions, st.one_of(st.none(), expressions))
sections = st.one_of(
    goals,
    node(syntax.Body, blocks),
    node(syntax.Effect, blocks),
    node(syntax.Direction, st.sampled_from(["in", "out"]), tuples(names)),
)


def _procedures(keywords: list[str], least: int) -> Any:
    kinds = st.sampled_from(keywords)
    inner = tuples(sections, least)
    return node(syntax.Procedure, kinds, names, parameters, inner, **annotated)


definitions = st.one_of(
    node(syntax.Title, st.sampled_from(["domain", "problem"]), strings),
    node(syntax.Include, strings),
    node(syntax.TypeDefinition, names, maybe_types, **annotated),
    node(syntax.ObjectConstant, tuples(names, 1), types, **annotated),
    node(syntax.Feature, names, parameters, maybe_types, **annotated),
    node(
        syntax.Function, names, parameters, maybe_types, st.one_of(st.none(), blocks), **annotated
    ),
    _procedures(["behavior", "action", "generator"], 1),
    _procedures(["controller"], 0),
    node(syntax.Objects, tuples(node(syntax.ObjectsLine, tuples(names, 1), types), 1)),
    node(syntax.Init, blocks),
    goals,
    node(syntax.Minimize, expressions),
)
modules = node(syntax.Module, tuples(definitions, 0, 3))
