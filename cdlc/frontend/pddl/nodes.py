"""PDDL as it means: every node of a domain and a problem on this page.

Names are in lower case; variables keep their question mark, so that a term says what it is. Bound
variables have names of their own within an action.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from cdlc.source import Span


@dataclass(frozen=True, slots=True)
class Typed:
    """A declared name with its type."""

    name: str
    type: str


# ---------------------------------------------------------------------------------------- formulas


@dataclass(frozen=True, slots=True)
class Atom:
    """`(p t …)`, or as a number `(f t …)`."""

    name: str
    arguments: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Equal:
    """`(= t u)` of objects."""

    left: str
    right: str


@dataclass(frozen=True, slots=True)
class Compare:
    """`(<= e f)` and the like, of numbers."""

    operator: Literal["==", "<", "<=", ">", ">="]
    left: "Number"
    right: "Number"


@dataclass(frozen=True, slots=True)
class Not:
    """`(not φ)`."""

    operand: "Formula"


@dataclass(frozen=True, slots=True)
class Junction:
    """`(and φ …)` or `(or φ …)`; the empty one is true or false."""

    operator: Literal["and", "or"]
    operands: tuple["Formula", ...]


@dataclass(frozen=True, slots=True)
class Quantified:
    """`(forall (?x - t …) φ)` or `exists`."""

    quantifier: Literal["forall", "exists"]
    variables: tuple[Typed, ...]
    body: "Formula"


@dataclass(frozen=True, slots=True)
class Arithmetic:
    """`(+ e f)` and the like."""

    operator: Literal["+", "-", "*", "/"]
    left: "Number"
    right: "Number"


Number = int | float | Atom | Arithmetic
Formula = Atom | Equal | Compare | Not | Junction | Quantified
TRUE = Junction("and", ())


# ------------------------------------------------------------------------------------- definitions


@dataclass(frozen=True, slots=True)
class Effect:
    """One cell that changes, for all `variables`, where `condition` holds before.

    `value` is True or False for a predicate, a number for a function with its operator.
    """

    variables: tuple[Typed, ...]
    condition: Formula
    cell: Atom
    operator: Literal["=", "+=", "-=", "*=", "/="]
    value: "bool | Number"
    span: Span


@dataclass(frozen=True, slots=True)
class Action:
    """An `:action`."""

    name: str
    parameters: tuple[Typed, ...]
    precondition: Formula
    effects: tuple[Effect, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Derived:
    """A `:derived` predicate: it holds where any of its definitions does."""

    name: str
    parameters: tuple[Typed, ...]
    body: Formula
    span: Span


@dataclass(frozen=True, slots=True)
class Schema:
    """A predicate or function with its parameters."""

    name: str
    parameters: tuple[Typed, ...]


@dataclass(frozen=True, slots=True)
class Domain:
    """A domain; `types` is parents by type, without `object`."""

    name: str
    types: dict[str, str]
    constants: tuple[Typed, ...]
    predicates: tuple[Schema, ...]
    functions: tuple[Schema, ...]
    actions: tuple[Action, ...]
    derived: tuple[Derived, ...]


@dataclass(frozen=True, slots=True)
class Problem:
    """A problem; `facts` hold, `numbers` are initial values that differ from 0."""

    name: str
    objects: tuple[Typed, ...]
    facts: tuple[Atom, ...]
    numbers: tuple[tuple[Atom, int | float], ...]
    goal: Formula
    minimize: Number | None


def ancestors(type_: str, parents: Mapping[str, str]) -> list[str]:
    """A type and those above it, up to `object`; types that are above themselves end there."""
    line = [type_]
    while line[-1] in parents and parents[line[-1]] not in line:
        line.append(parents[line[-1]])
    return line if line[-1] == "object" else [*line, "object"]
