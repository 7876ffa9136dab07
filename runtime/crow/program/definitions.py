"""Definitions, programs and problems (language.md §1 and 2)."""

from dataclasses import dataclass, field
from typing import Literal as OneOf

from crow.program.expressions import Expression, Parameter
from crow.program.location import Node
from crow.program.statements import Annotation, Statement
from crow.program.types import Type


@dataclass(frozen=True, slots=True, kw_only=True, repr=False, eq=False)
class DefinitionNode(Node):
    """What every definition carries."""

    annotations: tuple[Annotation, ...] = field(default=())


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class TypeDefinition(DefinitionNode):
    """A `typedef`. `base` is the parent of an object type, or what a value type stands for."""

    name: str
    base: Type
    is_object: bool


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class ObjectConstant(DefinitionNode):
    """An object that every problem has."""

    name: str
    type: Type


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Feature(DefinitionNode):
    """A state variable for each tuple of arguments (§2, D.2)."""

    name: str
    parameters: tuple[Parameter, ...]
    type: Type

    @property
    def bounds(self) -> tuple[int | None, int | None]:
        """The least and the greatest value it may have, None for no limit (language.md §2)."""
        given = {a.name: a.value for a in self.annotations if isinstance(a.value, int)}
        return given.get("min"), given.get("max")


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Function(DefinitionNode):
    """A function: external when `body` is None (Python supplies it), else derived (D.3)."""

    name: str
    parameters: tuple[Parameter, ...]
    type: Type
    body: tuple[Statement, ...] | None


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Controller(DefinitionNode):
    """A primitive command; `effect` is None when it carries no `eff:` section."""

    name: str
    parameters: tuple[Parameter, ...]
    effect: tuple[Statement, ...] | None


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Promotable(Node):
    """The M of `<L, M, R>` (§2.3)."""

    order: OneOf["unordered", "sequential"]
    members: tuple[Statement, ...]


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Behavior(DefinitionNode):
    """A behavior rule as the program `<left, promotable, right>` and its effect (App. A)."""

    name: str
    parameters: tuple[Parameter, ...]
    goal: Expression | None
    left: tuple[Statement, ...]
    promotable: Promotable | None
    right: tuple[Statement, ...]
    effect: tuple[Statement, ...] | None

    @property
    def body(self) -> tuple[Statement, ...]:
        """The statements of L, M and R, in this order."""
        members = () if self.promotable is None else self.promotable.members
        return (*self.left, *members, *self.right)


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Generator(DefinitionNode):
    """Python that yields values for `outputs` that make `goal` true, given `inputs` (B.1, D.4)."""

    name: str
    parameters: tuple[Parameter, ...]
    goal: Expression
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


Definition = (
    TypeDefinition | ObjectConstant | Feature | Function | Controller | Behavior | Generator
)


@dataclass(frozen=True, slots=True)
class Program:
    """A checked domain: its definitions by kind, each in source order."""

    name: str
    types: tuple[TypeDefinition, ...] = ()
    constants: tuple[ObjectConstant, ...] = ()
    features: tuple[Feature, ...] = ()
    functions: tuple[Function, ...] = ()
    controllers: tuple[Controller, ...] = ()
    behaviors: tuple[Behavior, ...] = ()
    generators: tuple[Generator, ...] = ()


@dataclass(frozen=True, slots=True)
class ProblemStatement:
    """A checked problem file: objects beyond the domain's constants, initial state and goal."""

    name: str
    objects: tuple[Parameter, ...]
    init: tuple[Statement, ...]
    goal: Expression
    minimize: Expression | None = None
