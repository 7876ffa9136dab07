"""Expressions and effects, run in a state: the interpreter that everything is checked against.

Effects run statement by statement (D.3, D.5): a `foreach` is parallel, everything else in order.
"""

import operator
from collections import ChainMap
from collections.abc import Callable, Iterator, Mapping, MutableMapping
from functools import partial
from itertools import product
from typing import Protocol, assert_never, cast

from crow.arithmetic import arithmetic, negated
from crow.budget import looking
from crow.problem import Cell, State, World
from crow.program import (
    And,
    Apply,
    Arithmetic,
    Assign,
    Break,
    Builtin,
    Compare,
    Conditional,
    Constant,
    Continue,
    Expression,
    Feature,
    ForEach,
    ForRange,
    If,
    Let,
    Location,
    Negative,
    Not,
    Object,
    ObjectType,
    Or,
    Parameter,
    Quantified,
    Read,
    Return,
    SetLocal,
    Simulate,
    Statement,
    Type,
    Variable,
    Vector,
    Xor,
)
from crow.program.expressions import ArithmeticOperator
from crow.program.locals import Locals, set_local
from crow.unknowns import Touched, Unknown, is_same
from crow.values import Value, converted, stored

Environment = Mapping[str, Value]


_TOO_DEEP = "the computation is nested too deeply"


class EvaluationError(Exception):
    """A computation without a value: the message says why, `location` where in the source."""

    def __init__(self, message: str, location: Location | None) -> None:
        super().__init__(message)
        self.location = location


def evaluate(world: World, state: State, expression: Expression, variables: Environment) -> Value:
    """The value of an expression in a state.

    Raises EvaluationError for an unset value, a division by zero, a number out of range, or an
    external function whose Python is not given; FunctionError where that Python fails;
    crow.unknowns.Touched where the value of an unknown is needed.
    """
    try:
        return _Evaluator(world, state.cells).value(expression, variables)
    except RecursionError:
        raise EvaluationError(_TOO_DEEP, expression.location) from None


def evaluate_shared(
    world: World, state: State, expression: Expression, variables: Environment
) -> Value:
    """The value of a formula whose parts are shared, as those of the Hoare model are.

    Each part is evaluated once, where the text of the formula may be exponential in its size.
    Raises EvaluationError as `evaluate` does.
    """
    try:
        return _SharedEvaluator(world, state.cells).value(expression, variables)
    except RecursionError:
        raise EvaluationError(_TOO_DEEP, expression.location) from None


def holds(world: World, state: State, condition: Expression, variables: Environment) -> bool:
    """Whether a condition is true in a state. Raises EvaluationError as `evaluate` does."""
    return bool(evaluate(world, state, condition, variables))


def execute(
    world: World, state: State, statements: tuple[Statement, ...], variables: Environment
) -> State:
    """The state after an effect or `init`.

    Raises EvaluationError as `evaluate` does, for a `foreach` whose iterations write different
    values to one cell, and for a value outside the bounds of its feature.
    """
    return world.updated(state, changes(world, state.cells, statements, variables))


class Asked(Protocol):
    """Who answers where an effect computes with the values of unknowns (App. B)."""

    def define(
        self, value: Expression, type_: Type, variables: Environment, state: State
    ) -> Unknown:
        """An unknown that has a value, as a cell or variable of a type holds it."""

    def decide(self, condition: Expression, variables: Environment, state: State) -> bool:
        """Whether a condition is true."""

    def bound(self, feature: Feature, value: Unknown) -> None:
        """See to it that a value is within the bounds of a feature."""


def changes(
    world: World,
    cells: Mapping[Cell, object],
    statements: tuple[Statement, ...],
    variables: Environment,
    asked: Asked | None = None,
) -> dict[Cell, object]:
    """What an effect writes into the cells of a state.

    Raises EvaluationError as `execute` does, and crow.unknowns.Touched where the value of an
    unknown is needed, unless there is someone to be `asked`.
    """
    run = _Run(world, cells, asked)
    try:
        run.effect(statements, variables)
    except RecursionError:
        location = statements[0].location if statements else None
        raise EvaluationError(_TOO_DEEP, location) from None
    if world.has_bounds:
        for cell, value in run.written.items():
            if asked is not None and type(value) is Unknown:
                asked.bound(world.features[cell[0]], value)
            else:
                check_bounds(world, cell, value)
    return run.written


def is_within(feature: Feature, value: object) -> bool:
    """Whether the bounds of a feature allow a value."""
    low, high = feature.bounds
    return (low is None or value >= low) and (high is None or value <= high)  # type: ignore[operator]


def check_bounds(world: World, cell: Cell, value: object) -> None:
    """Raise EvaluationError for a value that the bounds of its feature exclude."""
    feature = world.features[cell[0]]
    if is_within(feature, value):
        return
    low, high = feature.bounds
    limits = f"at least {low}" if high is None else f"at most {high}"
    limits = limits if low is None or high is None else f"{low} to {high}"
    raise EvaluationError(
        f"`{shown_cell(cell)}` would be {value}, and may be {limits}", feature.location
    )


def check_unset(world: World, cells: Mapping[Cell, object]) -> None:
    """Raise EvaluationError for a cell that is not set and whose default is out of its bounds."""
    for feature in world.program.features:
        unset = world.defaults[feature.name]
        # What is set was checked where it was set; of large relations that is little.
        if unset is None or is_within(feature, unset):
            continue
        for arguments in world.cells(feature):
            cell = (feature.name, arguments)
            check_bounds(world, cell, cells.get(cell, unset))


# -------------------------------------------------------------------------------------- expressions

COMPARISONS: Mapping[str, Callable[[Value, Value], bool]] = {
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
}
CHOICES: Mapping[str, Callable[[list[Value]], Value]] = {"min": min, "max": max}
_AUGMENTED: Mapping[str, ArithmeticOperator] = {"+=": "+", "-=": "-", "*=": "*", "/=": "/"}


class _Evaluator:
    """Reads cells, or what was written into them since."""

    def __init__(
        self,
        world: World,
        cells: Mapping[Cell, object],
        written: Mapping[Cell, object] | None = None,
    ) -> None:
        self.world = world
        self.cells = cells
        self.written = written

    def value(self, node: Expression, variables: Environment) -> Value:
        # What is most frequent comes first; matching classes takes its time.
        kind = type(node)
        if kind is Variable:
            return self._variable(node, variables)  # type: ignore[arg-type]
        if kind is Read:
            return self._read(node, variables)  # type: ignore[arg-type]
        match node:
            case Read():
                return self._read(node, variables)
            case Constant(value=value):
                return value
            case Object(name=name):
                return name
            case Variable():
                return self._variable(node, variables)
            case Not(operand=operand):
                return not self.value(operand, variables)
            case And(operands=operands):
                return all(self.value(o, variables) for o in operands)
            case Or(operands=operands):
                return any(self.value(o, variables) for o in operands)
            case Xor(left=left, right=right):
                return self.value(left, variables) != self.value(right, variables)
            case Compare(operator=op, left=left, right=right):
                return COMPARISONS[op](self.value(left, variables), self.value(right, variables))
            case Conditional(condition=condition, then=then, otherwise=otherwise, type=type_):
                chosen = then if self.value(condition, variables) else otherwise
                value = self.value(chosen, variables)
                return _located(node.location, converted, value, type_)
            case Quantified():
                return self._quantified(node, variables)
            case Vector(elements=elements):
                return tuple(self.value(e, variables) for e in elements)
            case Negative(operand=operand, type=type_):
                return _located(node.location, negated, self.value(operand, variables), type_)
            case Arithmetic(operator=op, left=left, right=right, type=type_):
                sides = self.value(left, variables), self.value(right, variables)
                return _located(node.location, arithmetic, op, *sides, type_)
            case Builtin(function=function, arguments=arguments, type=type_):
                values = [self.value(a, variables) for a in arguments]
                value = abs(values[0]) if function == "abs" else CHOICES[function](values)
                return _located(node.location, converted, value, type_)
            case Apply():
                return self._apply(node, variables)
            case _:
                assert_never(node)

    def _variable(self, node: Variable, variables: Environment) -> Value:
        try:
            return variables[node.name]
        except KeyError:  # a part of an unordered group ran before the one that binds it
            message = f"`{node.name}` has no value yet"
            raise EvaluationError(message, node.location) from None

    def _read(self, node: Read, variables: Environment) -> Value:
        cell = (node.feature, tuple([self.value(a, variables) for a in node.arguments]))
        return self.cell(cell, node.location)

    def cell(self, cell: Cell, location: Location | None) -> Value:
        """The value of a cell, or the default of its type."""
        if self.written and cell in self.written:
            return self.written[cell]
        if cell in self.cells:
            return self.cells[cell]
        check_known(cell)
        default = self.world.defaults[cell[0]]
        if default is None:
            raise EvaluationError(f"`{shown_cell(cell)}` has no value", location)
        return default

    def _quantified(self, node: Quantified, variables: Environment) -> bool:
        assignments = assignments_of(self.world, node.variables, variables)
        test = all if node.quantifier == "forall" else any
        return test(self.value(node.body, inner) for inner in assignments)

    def _apply(self, node: Apply, variables: Environment) -> Value:
        function = self.world.functions[node.function]
        if function.body is None:
            return self._external(node, variables)
        inner: dict[str, Value] = {}
        for parameter, argument in zip(function.parameters, node.arguments, strict=True):
            given = self.value(argument, variables)
            inner[parameter.name] = _located(argument.location, converted, given, parameter.type)
        value = self._returned(function.body, inner)
        return _located(node.location, converted, value, function.type)

    def _external(self, node: Apply, variables: Environment) -> Value:
        function = self.world.externals.functions.get(node.function)
        if function is None:
            message = f"the external function `{node.function}` has no Python given for it"
            raise EvaluationError(message, node.location)
        arguments = tuple([self.value(a, variables) for a in node.arguments])
        cells = ChainMap(dict(self.written), _below(self.cells)) if self.written else self.cells
        location = node.location
        return _located(location, function.value, cells, arguments, location)

    def _returned(self, body: tuple[Statement, ...], variables: dict[str, Value]) -> Value:
        match body:
            case (Return(value=value),):
                return _Evaluator(self.world, self.cells, self.written).value(value, variables)
            case _:
                below = ChainMap(dict(self.written), _below(self.cells)) if self.written else None
                run = _Run(self.world, self.cells if below is None else below)
                result = run.block(body, ChainMap(variables))
                assert isinstance(result, _Returned)
                return result.value


class _SharedEvaluator(_Evaluator):
    """Remembers the value of each node, for the variables there are at the time."""

    def __init__(self, world: World, cells: Mapping[Cell, object]) -> None:
        super().__init__(world, cells)
        self._known: dict[int, Value] = {}

    def value(self, node: Expression, variables: Environment) -> Value:
        if id(node) not in self._known:
            self._known[id(node)] = super().value(node, variables)
        return self._known[id(node)]

    def _quantified(self, node: Quantified, variables: Environment) -> bool:
        outer, is_every = self._known, node.quantifier == "forall"
        try:
            for inner in assignments_of(self.world, node.variables, variables):
                self._known = {}
                if self.value(node.body, inner) != is_every:
                    return not is_every
            return is_every
        finally:
            self._known = outer


def _located(location: Location | None, compute: Callable[..., Value], *arguments: object) -> Value:
    """What a computation gives; an error of arithmetic gets its place in the source."""
    try:
        return compute(*arguments)
    except ArithmeticError as error:
        raise EvaluationError(str(error), location) from None


def assignments_of(
    world: World, variables: tuple[Parameter, ...], outer: Environment
) -> Iterator[dict[str, Value]]:
    """The outer variables with every tuple of objects for some more, in order of declaration."""
    names = [v.name for v in variables]
    domains = [world.objects_of(v.type) for v in variables]
    return ({**outer, **dict(zip(names, t, strict=True))} for t in looking(product(*domains)))


def shown_cell(cell: Cell) -> str:
    """A cell as CDL reads it: `on(a, b)`."""
    feature, arguments = cell
    return f"{feature}({', '.join(arguments)})"


def check_known(cell: Cell) -> None:
    """Raise Touched for a cell of an object that is not known yet."""
    arguments: tuple[object, ...] = cell[1]
    for argument in arguments:
        if type(argument) is Unknown:
            raise Touched(argument)


# ------------------------------------------------------------------------------------------ effects


class _Returned:
    def __init__(self, value: Value) -> None:
        self.value = value


_Signal = _Returned | type[Break] | type[Continue] | None
"""Why a block ended early, if it did."""


def _below(cells: Mapping[Cell, object]) -> MutableMapping[Cell, object]:
    """Cells as a map that others lie above: they are only read."""
    return cast("MutableMapping[Cell, object]", cells)


class _Run:
    """One run over the cells of a state, which it leaves alone: `written` is what it wrote."""

    def __init__(
        self, world: World, cells: Mapping[Cell, object], asked: Asked | None = None
    ) -> None:
        self.world = world
        self.written: dict[Cell, object] = {}
        self.cells = cells
        self.evaluator = _Evaluator(world, cells, self.written)
        self.asked = asked

    def effect(self, statements: tuple[Statement, ...], variables: Environment) -> None:
        """The statements of an effect; mostly assignments, which need no scope of their own."""
        scope: Locals | None = None
        for statement in statements:
            if type(statement) is Assign and scope is None:
                self._assign(statement, variables)
            else:
                scope = ChainMap(dict(variables)) if scope is None else scope
                self._statement(statement, scope)

    def block(self, statements: tuple[Statement, ...], variables: Locals) -> _Signal:
        for statement in statements:
            signal = self._statement(statement, variables)
            if signal is not None:
                return signal
        return None

    def _statement(self, node: Statement, variables: Locals) -> _Signal:
        match node:
            case Assign():
                self._assign(node, variables)
            case Let(variable=variable, value=value):
                compute = partial(self._converted, value, variable.type, variables, node.location)
                variables[variable.name] = self._value(compute, value, variable.type, variables)
            case SetLocal(variable=name, value=value):
                compute = partial(self.evaluator.value, value, variables)
                set_local(variables, name, self._value(compute, value, value.type, variables))
            case If(condition=condition, then=then, otherwise=otherwise):
                chosen = then if self._is_true(condition, variables) else otherwise
                return self.block(chosen, variables.new_child())
            case ForRange():
                return self._for(node, variables)
            case ForEach():
                self._foreach(node, variables)
            case Break():
                return Break
            case Continue():
                return Continue
            case Simulate():
                self._simulate(node, variables)
            case Return(value=value):
                return _Returned(self.evaluator.value(value, variables))
            case _:
                raise AssertionError(f"{type(node).__name__} in an effect")
        return None

    def _value(
        self, compute: Callable[[], Value], value: Expression, type_: Type, variables: Environment
    ) -> Value:
        """A value; who is asked defines one that depends on unknowns."""
        if self.asked is None:
            return compute()
        try:
            return compute()
        except Touched:
            return self.asked.define(value, type_, dict(variables), self._state())

    def _is_true(self, condition: Expression, variables: Environment) -> bool:
        try:
            return bool(self.evaluator.value(condition, variables))
        except Touched:
            if self.asked is None:
                raise
            return self.asked.decide(condition, dict(variables), self._state())

    def _state(self) -> State:
        """The state as it is in the middle of the effect."""
        return State(ChainMap(dict(self.written), _below(self.cells)))

    def _converted(
        self, value: Expression, type_: Type, variables: Environment, location: Location | None
    ) -> Value:
        return _located(location, converted, self.evaluator.value(value, variables), type_)

    def _simulate(self, node: Simulate, variables: Environment) -> None:
        effect = self.world.externals.effects[node.controller]
        arguments = tuple([self.evaluator.value(a, variables) for a in node.arguments])
        before = ChainMap(self.written, _below(self.cells))
        location = node.location
        self.written.update(_located(location, effect.changes, before, arguments, location))

    def _assign(self, node: Assign, variables: Environment) -> None:
        feature = self.world.features[node.feature]
        arguments = tuple([self.evaluator.value(a, variables) for a in node.arguments])
        cell = (node.feature, arguments)
        check_known(cell)
        if self.asked is None:
            self.written[cell] = self._assigned(node, cell, feature.type, variables)
            return
        new = node.value
        if node.operator != "=":
            before = Read(node.feature, node.arguments, feature.type, location=node.location)
            new = Arithmetic(_AUGMENTED[node.operator], before, new, feature.type)
        compute = partial(self._assigned, node, cell, feature.type, variables)
        self.written[cell] = self._value(compute, new, feature.type, variables)

    def _assigned(self, node: Assign, cell: Cell, type_: Type, variables: Environment) -> Value:
        value = self.evaluator.value(node.value, variables)
        if node.operator != "=":
            before = self.evaluator.cell(cell, node.location)
            op = _AUGMENTED[node.operator]
            value = _located(node.location, arithmetic, op, before, value, type_)
        if isinstance(type_, ObjectType):
            return value
        return _located(node.location, stored, value, type_)

    def _for(self, node: ForRange, variables: Locals) -> _Signal:
        for number in range(node.start, node.stop, node.step):
            signal = self.block(node.body, variables.new_child({node.variable.name: number}))
            if signal is Break:
                break
            if isinstance(signal, _Returned):
                return signal
        return None

    def _foreach(self, node: ForEach, variables: Environment) -> None:
        merged: dict[Cell, object] = {}
        before = ChainMap(self.written, _below(self.cells))
        for inner in assignments_of(self.world, node.variables, variables):
            run = _Run(self.world, before, self.asked)
            run.block(node.body, ChainMap(inner))
            for cell, value in run.written.items():
                if cell in merged and not is_same(merged[cell], value):
                    message = f"iterations write different values to `{shown_cell(cell)}`"
                    raise EvaluationError(message, node.location)
                merged[cell] = value
        self.written.update(merged)
