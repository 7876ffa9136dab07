"""The untyped syntax tree, as written: every node of it on this page.

Names are not resolved and sugar is kept, so that the formatter can print a file back. Spans are
offsets into the file the node was read from and do not count for equality.
"""

from dataclasses import dataclass, field, fields
from typing import Literal as OneOf

from cdlc.source import Span


@dataclass(frozen=True, slots=True, kw_only=True, repr=False, eq=False)
class Node:
    """What every node carries."""

    span: Span = field(compare=False)

    # Written once instead of compiled for each class, which was half the time of importing them.
    def __repr__(self) -> str:
        shown = (f"{f.name}={getattr(self, f.name)!r}" for f in fields(self) if f.compare)
        return f"{type(self).__name__}({', '.join(shown)})"

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and all(
            getattr(self, f.name) == getattr(other, f.name) for f in fields(self) if f.compare
        )

    def __hash__(self) -> int:
        return hash((type(self), *(getattr(self, f.name) for f in fields(self) if f.compare)))


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Name(Node):
    """An identifier."""

    text: str


# ------------------------------------------------------------------------------------------- types


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class NamedType(Node):
    """`T`."""

    name: str


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class VectorType(Node):
    """`vector[T]`, `vector[T, n]` or `vector[T; n]`."""

    constructor: Name
    element: "Type"
    length: int | None


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class ListType(Node):
    """`T[]`."""

    element: "Type"


Type = NamedType | VectorType | ListType


# ------------------------------------------------------------------------------------- expressions


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Literal(Node):
    """A bool, number or string."""

    value: bool | int | float | str


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class NameExpression(Node):
    """A name on its own."""

    name: str


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Call(Node):
    """`f(a, …)`, or `f[a, …]` when `bracketed`."""

    name: Name
    arguments: tuple["Expression", ...]
    bracketed: bool


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Ellipsis_(Node):  # noqa: N801 - `Ellipsis` is a builtin
    """`...` among the arguments."""


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class VectorLiteral(Node):
    """`[e, …]`."""

    elements: tuple["Expression", ...]


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Unary(Node):
    """`not e` or `-e`."""

    operator: OneOf["not", "-"]
    operand: "Expression"


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Connective(Node):
    """`a and b and …` or `a or b or …`."""

    operator: OneOf["and", "or"]
    operands: tuple["Expression", ...]


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Binary(Node):
    """Arithmetic, or `^`."""

    operator: OneOf["+", "-", "*", "/", "//", "%", "**", "^"]
    left: "Expression"
    right: "Expression"


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Comparison(Node):
    """`a < b <= …`: one operand more than operators."""

    operators: tuple[OneOf["==", "!=", "<", "<=", ">", ">="], ...]
    operands: tuple["Expression", ...]


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Conditional(Node):
    """`then if condition else otherwise`."""

    condition: "Expression"
    then: "Expression"
    otherwise: "Expression"


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class TypedName(Node):
    """A declared name; in lists like `x, y: T` the type of `x` is None."""

    name: Name
    type: Type | None


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Quantified(Node):
    """`forall x: T where c: e` or `exists …`."""

    quantifier: OneOf["forall", "exists"]
    variables: tuple[TypedName, ...]
    where: "Expression | None"
    body: "Expression"


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class ErrorExpression(Node):
    """Stands where an expression could not be read."""


Expression = (
    Literal
    | NameExpression
    | Call
    | Ellipsis_
    | VectorLiteral
    | Unary
    | Connective
    | Binary
    | Comparison
    | Conditional
    | Quantified
    | ErrorExpression
)


# -------------------------------------------------------------------------------------- statements


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Annotation(Node):
    """`[[name]]` or `[[name=value]]`."""

    name: Name
    value: "Literal | Name | None"


@dataclass(frozen=True, slots=True, kw_only=True, repr=False, eq=False)
class Annotated(Node):
    """A node that annotations can stand before."""

    annotations: tuple[Annotation, ...] = ()


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Let(Annotated):
    """`let v: T = e`."""

    name: Name
    type: Type | None
    value: Expression


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Assert(Annotated):
    """`assert e`."""

    condition: Expression


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Achieve(Annotated):
    """`achieve e` or `achieve_once e`."""

    condition: Expression
    once: bool


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class CallStatement(Annotated):
    """`do c(…)` or `c(…)`."""

    call: Call
    has_do: bool


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Assignment(Annotated):
    """`v = e`, `f[a, …] = e`, and with `+=` and the like."""

    target: NameExpression | Call
    operator: OneOf["=", "+=", "-=", "*=", "/="]
    value: Expression


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Bind(Annotated):
    """`bind v: T`, then `where: e`, `: e`, `= e`, or nothing; `form` says which was written."""

    variables: tuple[TypedName, ...]
    form: OneOf["free", "where", "equal", "call"]
    condition: Expression | None


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Word(Annotated):
    """`commit`, `break`, `continue` or `pass`."""

    word: OneOf["commit", "break", "continue", "pass"]


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Return(Annotated):
    """`return e`."""

    value: Expression


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Group(Annotated):
    """`sequential:`, `unordered:` or `alternative:`."""

    order: OneOf["sequential", "unordered", "alternative"]
    body: tuple["Statement", ...]


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Promotable(Annotated):
    """`promotable:`, with an order or without."""

    order: OneOf["sequential", "unordered", "alternative"] | None
    body: tuple["Statement", ...]


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class ForEach(Annotated):
    """`foreach o: T:`, `forall o: T:` or `for each o: T:` as a statement."""

    variables: tuple[TypedName, ...]
    body: tuple["Statement", ...]


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class ForRange(Annotated):
    """`for i in range(…):`."""

    variable: Name
    function: Name
    arguments: tuple[Expression, ...]
    body: tuple["Statement", ...]


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class If(Annotated):
    """`if`, `elif`s and `else`: conditions with blocks; `otherwise` is None without `else`."""

    branches: tuple[tuple[Expression, tuple["Statement", ...]], ...]
    otherwise: tuple["Statement", ...] | None


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class ErrorStatement(Annotated):
    """Stands where a statement, section or definition could not be read."""


Statement = (
    Let
    | Assert
    | Achieve
    | CallStatement
    | Assignment
    | Bind
    | Word
    | Return
    | Group
    | Promotable
    | ForEach
    | ForRange
    | If
    | ErrorStatement
)


# ------------------------------------------------------------------------------------- definitions


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Title(Node):
    """`domain "name"`, `problem "name"`, or, in a problem file, `domain "path.cdl"`."""

    keyword: OneOf["domain", "problem"]
    text: str


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Include(Node):
    """`include "file.cdl"`."""

    path: str


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class TypeDefinition(Annotated):
    """`typedef T: base`."""

    name: Name
    base: Type | None


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class ObjectConstant(Annotated):
    """`object_constant a, b: T`."""

    names: tuple[Name, ...]
    type: Type


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Feature(Annotated):
    """`feature f(…) -> T`."""

    name: Name
    parameters: tuple[TypedName, ...]
    type: Type | None


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Function(Annotated):
    """`def f(…) -> T`, with a body or without."""

    name: Name
    parameters: tuple[TypedName, ...]
    type: Type | None
    body: tuple[Statement, ...] | None


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Goal(Node):
    """`goal: e`; `goal: l = r` keeps the right side apart."""

    condition: Expression
    equals: Expression | None


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Body(Node):
    """`body:`."""

    statements: tuple[Statement, ...]


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Effect(Node):
    """`eff:`."""

    statements: tuple[Statement, ...]


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Direction(Node):
    """`in: x, y` or `out: z` of a generator."""

    keyword: OneOf["in", "out"]
    names: tuple[Name, ...]


Section = Goal | Body | Effect | Direction | ErrorStatement


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Procedure(Annotated):
    """`controller`, `behavior` (or `action`) or `generator`: a name with sections."""

    keyword: OneOf["controller", "behavior", "action", "generator"]
    name: Name
    parameters: tuple[TypedName, ...]
    sections: tuple[Section, ...]


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class ObjectsLine(Node):
    """`A, B: block`."""

    names: tuple[Name, ...]
    type: Type


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Objects(Node):
    """`objects:` of a problem file."""

    lines: tuple[ObjectsLine | ErrorStatement, ...]


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Init(Node):
    """`init:` of a problem file."""

    statements: tuple[Statement, ...]


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Minimize(Node):
    """`minimize: e` of a problem file."""

    expression: Expression


Definition = (
    Title
    | Include
    | TypeDefinition
    | ObjectConstant
    | Feature
    | Function
    | Procedure
    | Objects
    | Init
    | Goal
    | Minimize
    | ErrorStatement
)


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Module(Node):
    """One file."""

    definitions: tuple[Definition, ...]
