"""A concrete case: objects, a state, arguments, and what the interpreter makes of them.

Whatever a solver says is tried here before anyone sees it: the interpreter (crow.transition) knows
nothing of formulas.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

from cdlc.verify.ways import Way
from crow.evaluate import EvaluationError, check_bounds, evaluate
from crow.problem import Cell, State, World
from crow.program import (
    And,
    Compare,
    Constant,
    Expression,
    Function,
    If,
    Location,
    Object,
    ObjectType,
    Parameter,
    Program,
    Return,
    Statement,
    Type,
    Variable,
    Vector,
    VectorType,
)
from crow.program.triples import Triple
from crow.program.types import underlying
from crow.transition import Transition, Unmet, apply
from crow.values import Value, default_value

CONFLICT = "iterations write different values"


@dataclass(frozen=True, slots=True)
class Opaque:
    """A value that has no form in CDL; equal to itself only."""

    type: str
    number: int

    def __repr__(self) -> str:
        return f"{self.type}#{self.number}"


@dataclass(frozen=True, slots=True)
class Table:
    """An external function by its values: those listed, and one for all other arguments."""

    rows: Mapping[tuple[Value, ...], Value]
    otherwise: Value


@dataclass(frozen=True)
class Situation:
    """Objects beside the constants, a state, and values for the variables of a triple."""

    program: Program
    way: Way
    triple: Triple
    objects: tuple[Parameter, ...]
    state: State
    values: Mapping[str, Value]
    tables: Mapping[str, Table]

    @cached_property
    def world(self) -> World:
        """The world, its external functions being those of the tables."""
        functions = tuple(self._function(f) for f in self.program.functions)
        behaviors = (*self.program.behaviors, *self.way.called)
        program = replace(self.program, functions=functions, behaviors=behaviors)
        return World.of(program, self.objects)

    @property
    def arguments(self) -> tuple[Value, ...]:
        """The values of the behavior's parameters."""
        return tuple(self.values[p.name] for p in self.way.behavior.parameters)

    @property
    def bindings(self) -> dict[str, Value]:
        """The values of the behavior's binds."""
        own = {p.name for p in self.way.behavior.parameters}
        return {p.name: self.values[p.name] for p in self.triple.parameters if p.name not in own}

    @cached_property
    def ran(self) -> Transition:
        """The behavior applied by the interpreter."""
        return apply(self.world, self.state, self.way.behavior, self.arguments, self.bindings)

    @property
    def is_possible(self) -> bool:
        """Whether the state is one that a problem can have: every cell within its bounds."""
        return is_within_bounds(self.world, self.state)

    @property
    def has_conflict(self) -> bool:
        """Whether the behavior fails because iterations of a `foreach` disagree."""
        problem = self.ran.problem
        return isinstance(problem, Unmet) and CONFLICT in problem.reason

    def before(self, expression: Expression) -> Value | None:
        """The value of an expression before the behavior; None where there is none."""
        return _value(self.world, self.state, expression, self.values)

    def after(
        self, expression: Expression, more: Mapping[str, Value] | None = None
    ) -> Value | None:
        """The value of an expression after the behavior; None where there is none."""
        return _value(self.world, self.ran.state, expression, {**self.values, **(more or {})})

    def _function(self, function: Function) -> Function:
        if function.body is not None or function.name not in self.tables:
            return function
        return replace(function, body=_lookup(function, self.tables[function.name]))


def _value(
    world: World, state: State, expression: Expression, values: Mapping[str, Value]
) -> Value | None:
    try:
        return evaluate(world, state, expression, values)
    except EvaluationError:
        return None


def is_within_bounds(world: World, state: State) -> bool:
    """Whether every cell of a feature with `[[min, max]]` is within them."""
    for feature in world.program.features:
        if feature.bounds == (None, None):
            continue
        for where in world.cells(feature):
            cell = (feature.name, where)
            try:
                check_bounds(world, cell, state.cells.get(cell, default_value(feature.type)))
            except EvaluationError:
                return False
    return True


# --------------------------------------------------------------------------------------- functions


def _lookup(function: Function, table: Table) -> tuple[Statement, ...]:
    """A body that finds the value in a table."""
    rows = []
    for arguments, value in table.rows.items():
        tests = tuple(
            Compare("==", Variable(p.name, p.type), literal(a, p.type))
            for p, a in zip(function.parameters, arguments, strict=True)
        )
        found = Return(literal(value, function.type))
        rows.append(If(tests[0] if len(tests) == 1 else And(tests), (found,), ()))
    return (*rows, Return(literal(table.otherwise, function.type)))


def literal(value: Value, type_: Type, location: Location | None = None) -> Expression:
    """A value as an expression."""
    plain = underlying(type_)
    if isinstance(plain, ObjectType):
        return Object(value, plain, location=location)
    if isinstance(value, tuple):
        element = plain.element if isinstance(plain, VectorType) else plain
        return Vector(tuple(literal(v, element) for v in value), type_, location=location)
    return Constant(value, type_, location=location)


def filler(type_: Type, objects: tuple[str, ...]) -> Value | None:
    """Some value of a type: what an unset cell holds, else the simplest; None if there is none."""
    default = default_value(type_)
    plain = underlying(type_)
    if default is not None:
        return default
    if isinstance(plain, ObjectType):
        return objects[0] if objects else None
    if isinstance(plain, VectorType) and plain.length is not None:
        return (filler(plain.element, objects),) * plain.length
    return "" if str(plain) == "string" else Opaque(str(type_), 0)


def changed_cells(situation: Situation) -> tuple[tuple[Cell, Value, Value], ...]:
    """The cells that the behavior changes, with their values before and after."""
    before, after = situation.state.cells, situation.ran.state.cells
    found = []
    for feature in situation.world.program.features:
        default = default_value(feature.type)
        for where in situation.world.cells(feature):
            cell = (feature.name, where)
            old, new = before.get(cell, default), after.get(cell, default)
            if old != new:
                found.append((cell, old, new))
    return tuple(found)
