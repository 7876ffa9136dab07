"""Which behavior achieves what and needs what: a program as nodes and edges."""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum

from crow.program import (
    Achieve,
    Apply,
    Assert,
    Assign,
    Behavior,
    Bind,
    Call,
    Do,
    Expression,
    If,
    Parameter,
    Program,
    Read,
    Statement,
)
from crow.program.walk import expressions_of, statements_within, subexpressions


class Kind(StrEnum):
    """What a node is."""

    FEATURE = "feature"
    FUNCTION = "function"
    BEHAVIOR = "behavior"


class Link(StrEnum):
    """What an edge says of its source: the strongest thing that is true of it."""

    ACHIEVES = "achieves"
    NEEDS = "achieves first"
    TESTS = "tests"
    WRITES = "writes besides"
    CALLS = "calls"
    READS = "is defined by"


@dataclass(frozen=True, slots=True)
class Node:
    """A definition, as it is shown."""

    name: str
    kind: Kind
    text: str


@dataclass(frozen=True, slots=True)
class Edge:
    """From a behavior or function to what it is about; both by their names and kinds."""

    source: tuple[Kind, str]
    target: tuple[Kind, str]
    link: Link


@dataclass(frozen=True, slots=True)
class Graph:
    """Nodes in source order, and edges."""

    nodes: tuple[Node, ...]
    edges: tuple[Edge, ...]


def graph_of(program: Program) -> Graph:
    """The graph of a program; what no behavior has to do with is left out."""
    builder = _Builder(program)
    edges = tuple(builder.edges())
    used = {end for edge in edges for end in (edge.source, edge.target)}
    nodes = [
        Node(d.name, kind, _signature(d.name, d.parameters))
        for kind, definitions in (
            (Kind.FEATURE, program.features),
            (Kind.FUNCTION, program.functions),
            (Kind.BEHAVIOR, program.behaviors),
        )
        for d in definitions
        if kind is Kind.BEHAVIOR or (kind, d.name) in used
    ]
    return Graph(tuple(nodes), edges)


def _signature(name: str, parameters: tuple[Parameter, ...]) -> str:
    return f"{name}({', '.join(str(parameter.type) for parameter in parameters)})"


class _Builder:
    def __init__(self, program: Program) -> None:
        self.program = program
        self.controllers = {c.name: c for c in program.controllers}

    def edges(self) -> Iterator[Edge]:
        """Every edge once: of several things between two nodes, the strongest."""
        for behavior in self.program.behaviors:
            source = (Kind.BEHAVIOR, behavior.name)
            found: dict[tuple[tuple[Kind, str], bool], Link] = {}
            for target, link in self._of_behavior(behavior):
                outward = link in (Link.ACHIEVES, Link.WRITES)
                found.setdefault((target, outward), link)
            for (target, _), link in found.items():
                yield Edge(source, target, link)
        for function in self.program.functions:
            read = [e for s in statements_within(function.body or ()) for e in expressions_of(s)]
            for target in dict.fromkeys(t for e in read for t in _read(e)):
                yield Edge((Kind.FUNCTION, function.name), target, Link.READS)

    def _of_behavior(self, behavior: Behavior) -> Iterator[tuple[tuple[Kind, str], Link]]:
        """What a behavior is about, the stronger first."""
        statements = list(statements_within(behavior.body))
        yield from ((target, Link.ACHIEVES) for target in _read(behavior.goal))
        for statement in statements:
            match statement:
                case Achieve(condition=condition):
                    yield from ((target, Link.NEEDS) for target in _read(condition))
                case Call(behavior=name):
                    yield (Kind.BEHAVIOR, name), Link.CALLS
                case _:
                    pass
        yield from ((target, Link.WRITES) for target in self._written(behavior, statements))
        for statement in statements:
            match statement:
                case Assert(condition=tested) | Bind(condition=tested) | If(condition=tested):
                    yield from ((target, Link.TESTS) for target in _read(tested))
                case _:
                    pass

    def _written(
        self, behavior: Behavior, statements: list[Statement]
    ) -> Iterator[tuple[Kind, str]]:
        """The features that an effect writes, that of a controller that is called included."""
        effects = [behavior.effect or ()]
        called = (s.controller for s in statements if isinstance(s, Do))
        effects += (self.controllers[name].effect or () for name in called)
        for effect in effects:
            for statement in statements_within(effect):
                if isinstance(statement, Assign):
                    yield Kind.FEATURE, statement.feature


def _read(condition: Expression | None) -> Iterator[tuple[Kind, str]]:
    """The features and functions that a condition names, if there is one."""
    for part in () if condition is None else subexpressions(condition):
        match part:
            case Read(feature=name):
                yield Kind.FEATURE, name
            case Apply(function=name):
                yield Kind.FUNCTION, name
            case _:
                pass
