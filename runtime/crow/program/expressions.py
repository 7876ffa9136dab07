"""Typed expressions (language.md §4). Sugar is gone: chains, `where` and named calls are resolved.

Conditions, values and index expressions all share this one family; each node knows its type.
"""

from dataclasses import dataclass
from typing import Literal as OneOf

from crow.program.location import Node
from crow.program.types import BOOL, Type

ArithmeticOperator = OneOf["+", "-", "*", "/", "//", "%", "**"]
ComparisonOperator = OneOf["==", "!=", "<", "<=", ">", ">="]
Scalar = bool | int | float | str


@dataclass(frozen=True, slots=True, repr=False)
class Parameter(Node):
    """A typed name: a parameter, a quantified or loop variable, a bound variable."""

    name: str
    type: Type


@dataclass(frozen=True, slots=True, repr=False)
class Constant(Node):
    """A literal: bool, number or string."""

    value: Scalar
    type: Type

    def __eq__(self, other: object) -> bool:
        # `True == 1 == 1.0` in Python; as literals of CDL they differ.
        return isinstance(other, Constant) and (
            (type(self.value), self.value, self.type)
            == (type(other.value), other.value, other.type)
        )

    def __hash__(self) -> int:
        return hash((type(self.value), self.value, self.type))


@dataclass(frozen=True, slots=True, repr=False)
class Vector(Node):
    """`[e, …]`, a vector or a list."""

    elements: tuple["Expression", ...]
    type: Type


@dataclass(frozen=True, slots=True, repr=False)
class Variable(Node):
    """A parameter or local of the enclosing definition."""

    name: str
    type: Type


@dataclass(frozen=True, slots=True, repr=False)
class Object(Node):
    """An object named by the domain (`object_constant`) or by the problem."""

    name: str
    type: Type


@dataclass(frozen=True, slots=True, repr=False)
class Read(Node):
    """The value of a feature at its arguments in the state of this place."""

    feature: str
    arguments: tuple["Expression", ...]
    type: Type


@dataclass(frozen=True, slots=True, repr=False)
class Apply(Node):
    """A call of an external or derived function."""

    function: str
    arguments: tuple["Expression", ...]
    type: Type


@dataclass(frozen=True, slots=True, repr=False)
class Builtin(Node):
    """`min`, `max` or `abs`."""

    function: OneOf["min", "max", "abs"]
    arguments: tuple["Expression", ...]
    type: Type


@dataclass(frozen=True, slots=True, repr=False)
class Not(Node):
    """Negation."""

    operand: "Expression"

    @property
    def type(self) -> Type:
        """Always bool."""
        return BOOL


@dataclass(frozen=True, slots=True, repr=False)
class And(Node):
    """Conjunction of two or more operands, left to right."""

    operands: tuple["Expression", ...]

    @property
    def type(self) -> Type:
        """Always bool."""
        return BOOL


@dataclass(frozen=True, slots=True, repr=False)
class Or(Node):
    """Disjunction of two or more operands, left to right."""

    operands: tuple["Expression", ...]

    @property
    def type(self) -> Type:
        """Always bool."""
        return BOOL


@dataclass(frozen=True, slots=True, repr=False)
class Xor(Node):
    """`^`: true when the operands differ."""

    left: "Expression"
    right: "Expression"

    @property
    def type(self) -> Type:
        """Always bool."""
        return BOOL


@dataclass(frozen=True, slots=True, repr=False)
class Compare(Node):
    """One comparison; the operands have been checked to be comparable."""

    operator: ComparisonOperator
    left: "Expression"
    right: "Expression"

    @property
    def type(self) -> Type:
        """Always bool."""
        return BOOL


@dataclass(frozen=True, slots=True, repr=False)
class Negative(Node):
    """Unary minus."""

    operand: "Expression"
    type: Type


@dataclass(frozen=True, slots=True, repr=False)
class Arithmetic(Node):
    """A binary arithmetic operation on numbers or, element by element, on vectors."""

    operator: ArithmeticOperator
    left: "Expression"
    right: "Expression"
    type: Type


@dataclass(frozen=True, slots=True, repr=False)
class Conditional(Node):
    """`then if condition else otherwise`; the branch not chosen is not evaluated."""

    condition: "Expression"
    then: "Expression"
    otherwise: "Expression"
    type: Type


@dataclass(frozen=True, slots=True, repr=False)
class Quantified(Node):
    """`forall` or `exists` over the objects of each variable's type."""

    quantifier: OneOf["forall", "exists"]
    variables: tuple[Parameter, ...]
    body: "Expression"

    @property
    def type(self) -> Type:
        """Always bool."""
        return BOOL


Expression = (
    Constant
    | Vector
    | Variable
    | Object
    | Read
    | Apply
    | Builtin
    | Not
    | And
    | Or
    | Xor
    | Compare
    | Negative
    | Arithmetic
    | Conditional
    | Quantified
)
