"""Typed statements (language.md §3, §2.1 to 2.5 of the paper)."""

from dataclasses import dataclass, field
from typing import Literal as OneOf

from crow.program.expressions import Expression, Parameter, Scalar
from crow.program.location import Node


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Annotation(Node):
    """`[[name]]` or `[[name=value]]`; a bare word stands as a string."""

    name: str
    value: Scalar | tuple[str, ...] | None = None


@dataclass(frozen=True, slots=True, kw_only=True, repr=False, eq=False)
class StatementNode(Node):
    """What every statement carries."""

    annotations: tuple[Annotation, ...] = field(default=())


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Let(StatementNode):
    """`let v = e`: evaluated once, where it stands."""

    variable: Parameter
    value: Expression


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class SetLocal(StatementNode):
    """`v = e` on a local."""

    variable: str
    value: Expression


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Assign(StatementNode):
    """`f[a, …] = e`, or with an operator `f[a, …] += e` and the like."""

    feature: str
    arguments: tuple[Expression, ...]
    operator: OneOf["=", "+=", "-=", "*=", "/="]
    value: Expression


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Assert(StatementNode):
    """`assert e`: true where it stands, or the trace is not sound (§2.2)."""

    condition: Expression


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Achieve(StatementNode):
    """`achieve e`; with `once` the condition need not hold any longer than where it stands."""

    condition: Expression
    once: bool = False


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Do(StatementNode):
    """`do c(…)`: a controller call of the plan."""

    controller: str
    arguments: tuple[Expression, ...]


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Call(StatementNode):
    """A behavior run where it stands, with no null refinement."""

    behavior: str
    arguments: tuple[Expression, ...]


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Bind(StatementNode):
    """`bind v: T where: e` (§2.4)."""

    variables: tuple[Parameter, ...]
    condition: Expression | None


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Commit(StatementNode):
    """`commit` (§2.5)."""


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Group(StatementNode):
    """`sequential:`, `unordered:` or `alternative:`."""

    order: OneOf["sequential", "unordered", "alternative"]
    body: tuple["Statement", ...]


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class ForEach(StatementNode):
    """`foreach o: T:`; parallel in effects (D.3), an unordered group in bodies."""

    variables: tuple[Parameter, ...]
    body: tuple["Statement", ...]


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class ForRange(StatementNode):
    """`for i in range(start, stop, step):` with bounds known at compile time."""

    variable: Parameter
    start: int
    stop: int
    step: int
    body: tuple["Statement", ...]


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Break(StatementNode):
    """Ends the enclosing `for`."""


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Continue(StatementNode):
    """Ends this iteration of the enclosing `for`."""


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class If(StatementNode):
    """`if`/`else`; `elif` is an `If` in `otherwise`."""

    condition: Expression
    then: tuple["Statement", ...]
    otherwise: tuple["Statement", ...]


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Return(StatementNode):
    """`return e`, in derived functions."""

    value: Expression


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Simulate(StatementNode):
    """The effect of a controller as Python computes it (`crow.effect`); no text of CDL says it."""

    controller: str
    arguments: tuple[Expression, ...]


Statement = (
    Let
    | SetLocal
    | Assign
    | Assert
    | Achieve
    | Do
    | Call
    | Bind
    | Commit
    | Group
    | ForEach
    | ForRange
    | Break
    | Continue
    | If
    | Return
    | Simulate
)
