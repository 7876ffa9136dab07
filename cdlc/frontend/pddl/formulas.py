"""Conditions, numbers and effects of PDDL."""

from collections.abc import Iterator
from typing import Any

from cdlc.frontend.pddl.context import Context, words_of
from cdlc.frontend.pddl.nodes import (
    TRUE,
    Arithmetic,
    Atom,
    Compare,
    Effect,
    Equal,
    Formula,
    Junction,
    Not,
    Number,
    Quantified,
)
from cdlc.frontend.pddl.words import Item, Word, Words

_COMPARISONS = {"<": "<", "<=": "<=", ">": ">", ">=": ">=", "=": "=="}
_CHANGES = {
    "assign": "=", "increase": "+=", "decrease": "-=", "scale-up": "*=", "scale-down": "/=",
}  # fmt: skip


def formula(item: Item, context: Context) -> Formula:
    """A condition. Raises PddlError where it cannot be read."""
    words = words_of(item, context, "a condition in parentheses")
    rest = words.items[1:]
    match words.head:
        case "" if not words.items:
            return TRUE
        case ("and" | "or") as operator:
            return Junction(operator, tuple(formula(part, context) for part in rest))
        case "not":
            return Not(formula(_only(words, context), context))
        case "imply":
            _count(words, 2, context)
            return Junction("or", (Not(formula(rest[0], context)), formula(rest[1], context)))
        case ("forall" | "exists") as quantifier:
            _count(words, 2, context)
            declared = tuple(context.typed_list(words_of(rest[0], context, "variables").items))
            inner, variables = context.with_variables(declared)
            return Quantified(quantifier, variables, formula(rest[1], inner))
        case "preference":
            reason = "CDL has one goal, which holds or does not"
            raise context.unsupported(words.span, "a preference", reason)
        case "=" if not _is_numeric(rest, context):
            _count(words, 2, context)
            return Equal(context.term(rest[0]), context.term(rest[1]))
        case ("<" | "<=" | ">" | ">=" | "=") as operator:
            _count(words, 2, context)
            sign: Any = _COMPARISONS[operator]
            return Compare(sign, number(rest[0], context), number(rest[1], context))
        case _:
            return atom(words, context)


def atom(words: Words, context: Context) -> Atom:
    """A predicate with its arguments."""
    name = words.head
    schema = context.predicates.get(name)
    if schema is None:
        raise context.unknown(words.items[0], "predicate", name, list(context.predicates))
    if len(words.items) - 1 != len(schema.parameters):
        raise context.miscounted(words, schema, len(words.items) - 1)
    return Atom(name, tuple(context.term(item) for item in words.items[1:]))


def number(item: Item, context: Context) -> Number:
    """A numeric expression."""
    if isinstance(item, Word):
        value = literal(item)
        if value is not None:
            return value
        if item.text in context.functions:  # `total-cost` without parentheses is common
            return Atom(item.text, ())
        raise context.syntax(item, f"expected a number, found `{item.text}`")
    rest = item.items[1:]
    match item.head:
        case "-" if len(rest) == 1:
            return Arithmetic("-", 0, number(rest[0], context))
        case ("+" | "*" | "-" | "/") as operator:
            if len(rest) < 2:
                raise context.syntax(item, f"`{operator}` takes two numbers")
            total = number(rest[0], context)
            for part in rest[1:]:
                total = Arithmetic(operator, total, number(part, context))
            return total
        case name:
            return _fluent(item, name, context)


def _fluent(item: Words, name: str, context: Context) -> Atom:
    schema = context.functions.get(name)
    if schema is None:
        raise context.unknown(item, "function", name or "()", list(context.functions))
    if len(item.items) - 1 != len(schema.parameters):
        raise context.miscounted(item, schema, len(item.items) - 1)
    return Atom(name, tuple(context.term(part) for part in item.items[1:]))


def literal(item: Item) -> int | float | None:
    """The value of a word that is a number."""
    if not isinstance(item, Word):
        return None
    try:
        value = float(item.text)
    except ValueError:
        return None
    return int(value) if value.is_integer() else value


def effects(item: Item, context: Context) -> Iterator[Effect]:
    """What an effect changes, one cell after another."""
    yield from _effects(item, context, (), TRUE)


def _effects(
    item: Item, context: Context, variables: tuple[Any, ...], condition: Formula
) -> Iterator[Effect]:
    words = words_of(item, context, "an effect in parentheses")
    rest = words.items[1:]
    match words.head:
        case "" if not words.items:
            return
        case "and":
            for part in rest:
                yield from _effects(part, context, variables, condition)
        case "forall":
            _count(words, 2, context)
            declared = tuple(context.typed_list(words_of(rest[0], context, "variables").items))
            inner, fresh = context.with_variables(declared)
            yield from _effects(rest[1], inner, (*variables, *fresh), condition)
        case "when":
            _count(words, 2, context)
            guard = formula(rest[0], context)
            both = guard if condition == TRUE else Junction("and", (condition, guard))
            yield from _effects(rest[1], context, variables, both)
        case "not":
            cell = atom(words_of(_only(words, context), context, "a predicate"), context)
            yield Effect(variables, condition, cell, "=", value=False, span=words.span)
        case change if change in _CHANGES:
            _count(words, 2, context)
            target = number(rest[0], context)
            if not isinstance(target, Atom):
                raise context.syntax(rest[0], "expected a function")
            operator: Any = _CHANGES[change]
            value = number(rest[1], context)
            yield Effect(variables, condition, target, operator, value, words.span)
        case _:
            yield Effect(
                variables, condition, atom(words, context), "=", value=True, span=words.span
            )


def _is_numeric(items: tuple[Item, ...], context: Context) -> bool:
    """Whether an equation is one of numbers."""
    for item in items:
        if isinstance(item, Words) or literal(item) is not None:
            return True
        if item.text in context.functions and item.text not in context.objects:
            return True
    return False


def _only(words: Words, context: Context) -> Item:
    _count(words, 1, context)
    return words.items[1]


def _count(words: Words, expected: int, context: Context) -> None:
    if len(words.items) - 1 != expected:
        found = len(words.items) - 1
        raise context.syntax(words, f"`{words.head}` takes {expected} parts, not {found}")
