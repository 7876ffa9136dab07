"""Names to declarations: the definitions of a domain, and the locals of one definition."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Literal

from crow.program import (
    BOOL,
    OBJECT,
    Controller,
    Feature,
    Function,
    Hierarchy,
    Location,
    NamedType,
    Object,
    ObjectType,
    Parameter,
    Primitive,
    Type,
    UnknownType,
    VectorType,
)
from crow.program.types import PRIMITIVES, is_number, promotes, underlying

from cdlc.diagnostics import Collector
from cdlc.source import SourceFile, Span

BUILTIN_FUNCTIONS = ("min", "max", "abs")


@dataclass(frozen=True, slots=True)
class Signature:
    """What a call of a behavior has to know about it."""

    name: str
    parameters: tuple[Parameter, ...]


@dataclass(slots=True)
class Declarations:
    """Everything a domain declares, by name; `places` says where, for diagnostics.

    Types have a name space of their own; the other tables share one.
    """

    types: dict[str, Type] = field(default_factory=lambda: {"object": OBJECT, **PRIMITIVES})
    parents: dict[str, str] = field(default_factory=dict)
    features: dict[str, Feature] = field(default_factory=dict)
    functions: dict[str, Function] = field(default_factory=dict)
    controllers: dict[str, Controller] = field(default_factory=dict)
    behaviors: dict[str, Signature] = field(default_factory=dict)
    generators: dict[str, Signature] = field(default_factory=dict)
    objects: dict[str, Object] = field(default_factory=dict)
    type_places: dict[str, Location | None] = field(default_factory=dict)
    places: dict[str, Location | None] = field(default_factory=dict)

    @property
    def hierarchy(self) -> Hierarchy:
        """The object types as a tree."""
        return Hierarchy(self.parents)

    def kind(self, name: str) -> str | None:
        """What a name is, in words, or None when it is not declared."""
        tables = (
            (self.features, "feature"),
            (self.functions, "function"),
            (self.controllers, "controller"),
            (self.behaviors, "behavior"),
            (self.generators, "generator"),
            (self.objects, "object"),
        )
        return next((word for table, word in tables if name in table), None)

    def fits(self, source: Type, target: Type) -> bool:
        """Whether a value of type `source` may stand where `target` is wanted (language.md §4)."""
        match source, target:
            case (UnknownType(), _) | (_, UnknownType()):
                return True
            case ObjectType(), ObjectType():
                return self.hierarchy.is_subtype(source, target)
            case NamedType(), NamedType():
                return _is_based_on(source, target) or _is_based_on(target, source)
            case _:
                return self._fits_structurally(underlying(source), underlying(target))

    def _fits_structurally(self, source: Type, target: Type) -> bool:
        match source, target:
            case VectorType(element, length), VectorType(wanted, wanted_length):
                same_length = length is None or wanted_length is None or length == wanted_length
                return same_length and self.fits(element, wanted)
            case _ if is_number(source) and is_number(target):
                return promotes(source, target)
            case _:
                return source == target


def _is_based_on(type_: Type, ancestor: NamedType) -> bool:
    while isinstance(type_, NamedType):
        if type_ == ancestor:
            return True
        type_ = type_.base
    return False


LocalKind = Literal["parameter", "local", "bound", "loop", "quantified"]


@dataclass(frozen=True, slots=True)
class Local:
    """A variable of one definition; `depth` counts the `foreach` loops around its declaration."""

    variable: Parameter
    kind: LocalKind
    depth: int = 0


@dataclass(frozen=True, slots=True)
class Scope:
    """The locals visible at a place; adding one makes a new scope."""

    locals: dict[str, Local] = field(default_factory=dict)
    depth: int = 0
    in_for: bool = False

    def get(self, name: str) -> Local | None:
        """The local of that name."""
        return self.locals.get(name)

    def add(self, variable: Parameter, kind: LocalKind) -> "Scope":
        """A scope with one more local, which hides an earlier one of its name."""
        added = {**self.locals, variable.name: Local(variable, kind, self.depth)}
        return Scope(added, self.depth, self.in_for)

    def inside_foreach(self) -> "Scope":
        """The scope of a `foreach` block: outer locals are read-only, `break` does not cross."""
        return Scope(self.locals, self.depth + 1, in_for=False)

    def inside_for(self) -> "Scope":
        """The scope of a `for` block."""
        return Scope(self.locals, self.depth, in_for=True)

    def __iter__(self) -> Iterator[str]:
        return iter(self.locals)


@dataclass(slots=True)
class Context:
    """What checking one file needs: its text for places, all declarations, and the diagnostics."""

    source: SourceFile
    declarations: Declarations
    found: Collector
    depth: int = 0

    def location(self, span: Span) -> Location:
        """A span of this file in lines and columns."""
        return self.source.location(span)

    def known_values(self, scope: Scope) -> list[str]:
        """Names an expression may start with."""
        declared = self.declarations
        return [*scope, *declared.features, *declared.functions, *declared.objects]


def is_condition(type_: Type) -> bool:
    """Whether a value of the type can be true or false."""
    return isinstance(type_, UnknownType) or underlying(type_) == BOOL


def is_primitive(type_: Type) -> bool:
    """Whether the type is built in under its typedefs."""
    return isinstance(underlying(type_), Primitive)
