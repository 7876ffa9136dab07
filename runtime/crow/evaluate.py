"""Expressions and effects, run in a state: the interpreter that everything is checked against.

Effects run statement by statement (D.3, D.5): a `foreach` is parallel, everything else in order.
"""

import math
import operator
from collections.abc import Callable, Mapping
from itertools import product
from typing import assert_never

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
    ForEach,
    ForRange,
    If,
    Let,
    Location,
    Negative,
    Not,
    Object,
    Or,
    Parameter,
    Quantified,
    Read,
    Return,
    SetLocal,
    Statement,
    Type,
    Variable,
    Vector,
    Xor,
)
from crow.program.types import is_integer
from crow.values import Value, ValueRangeError, default_value, stored

Environment = Mapping[str, Value]


class EvaluationError(Exception):
    """A computation without a value: the message says why, `location` where in the source."""

    def __init__(self, message: str, location: Location | None) -> None:
        super().__init__(message)
        self.location = location


def evaluate(world: World, state: State, expression: Expression, variables: Environment) -> Value:
    """The value of an expression in a state.

    Raises EvaluationError for an unset value, a division by zero, a number out of range, or an
    external function, which needs Python that is not given.
    """
    return _Evaluator(world, state.cells).value(expression, variables)


def holds(world: World, state: State, condition: Expression, variables: Environment) -> bool:
    """Whether a condition is true in a state. Raises EvaluationError as `evaluate` does."""
    return bool(evaluate(world, state, condition, variables))


def execute(
    world: World, state: State, statements: tuple[Statement, ...], variables: Environment
) -> State:
    """The state after an effect or `init`. Raises EvaluationError as `evaluate` does, and for a
    `foreach` whose iterations write different values to one cell.
    """
    run = _Run(world, dict(state.cells))
    run.block(statements, dict(variables))
    return state.updated(run.written) if run.written else state


# -------------------------------------------------------------------------------------- expressions

_COMPARISONS: Mapping[str, Callable[[Value, Value], bool]] = {
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
}
_ARITHMETIC: Mapping[str, Callable[[Value, Value], Value]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "//": operator.floordiv,
    "%": operator.mod,
    "**": operator.pow,
}


class _Evaluator:
    def __init__(self, world: World, cells: Mapping[Cell, object]) -> None:
        self.world = world
        self.cells = cells

    def value(self, node: Expression, variables: Environment) -> Value:
        match node:
            case Constant(value=value):
                return value
            case Variable(name=name):
                return variables[name]
            case Object(name=name):
                return name
            case Read():
                return self._read(node, variables)
            case Not(operand=operand):
                return not self.value(operand, variables)
            case And(operands=operands):
                return all(self.value(o, variables) for o in operands)
            case Or(operands=operands):
                return any(self.value(o, variables) for o in operands)
            case Xor(left=left, right=right):
                return self.value(left, variables) != self.value(right, variables)
            case Compare(operator=op, left=left, right=right):
                return _COMPARISONS[op](self.value(left, variables), self.value(right, variables))
            case Conditional(condition=condition, then=then, otherwise=otherwise):
                chosen = then if self.value(condition, variables) else otherwise
                return self.value(chosen, variables)
            case Quantified():
                return self._quantified(node, variables)
            case Vector(elements=elements):
                return tuple(self.value(e, variables) for e in elements)
            case Negative(operand=operand):
                value = self.value(operand, variables)
                return tuple(-v for v in value) if isinstance(value, tuple) else -value
            case Arithmetic():
                return self._arithmetic(node, variables)
            case Builtin(function=function, arguments=arguments):
                values = [self.value(a, variables) for a in arguments]
                return (
                    abs(values[0]) if function == "abs" else (min, max)[function == "max"](values)
                )
            case Apply():
                return self._apply(node, variables)
            case _:
                assert_never(node)

    def _read(self, node: Read, variables: Environment) -> Value:
        cell = (node.feature, tuple([self.value(a, variables) for a in node.arguments]))
        if cell in self.cells:
            return self.cells[cell]
        default = default_value(self.world.features[node.feature].type)
        if default is None:
            raise EvaluationError(f"`{shown_cell(cell)}` has no value", node.location)
        return default

    def _quantified(self, node: Quantified, variables: Environment) -> bool:
        assignments = assignments_of(self.world, node.variables, variables)
        test = all if node.quantifier == "forall" else any
        return test(self.value(node.body, inner) for inner in assignments)

    def _arithmetic(self, node: Arithmetic, variables: Environment) -> Value:
        left, right = self.value(node.left, variables), self.value(node.right, variables)
        compute = _ARITHMETIC[node.operator]
        try:
            match left, right:
                case tuple(), tuple():
                    return tuple(compute(a, b) for a, b in zip(left, right, strict=True))
                case tuple(), _:
                    return tuple(compute(a, right) for a in left)
                case _, tuple():
                    return tuple(compute(left, b) for b in right)
                case _:
                    return _checked(compute(left, right), node.type)
        except ZeroDivisionError:
            raise EvaluationError("division by zero", node.location) from None
        except (ArithmeticError, ValueError) as error:
            raise EvaluationError(str(error), node.location) from None

    def _apply(self, node: Apply, variables: Environment) -> Value:
        function = self.world.functions[node.function]
        if function.body is None:
            message = f"the external function `{function.name}` has no Python given for it"
            raise EvaluationError(message, node.location)
        values = [self.value(a, variables) for a in node.arguments]
        names = [p.name for p in function.parameters]
        result = _Run(self.world, dict(self.cells)).block(
            function.body, dict(zip(names, values, strict=True))
        )
        assert isinstance(result, _Returned)
        return result.value


def _checked(value: Value, type_: Type) -> Value:
    """A result within its type; Python's own integers and powers know no bounds."""
    if isinstance(value, complex) or (isinstance(value, float) and math.isnan(value)):
        raise ValueRangeError("the result is not a real number")
    return stored(value, type_) if is_integer(type_) and isinstance(value, int) else value


def assignments_of(
    world: World, variables: tuple[Parameter, ...], outer: Environment
) -> list[dict[str, Value]]:
    """The outer variables with every tuple of objects for some more, in order of declaration."""
    names = [v.name for v in variables]
    domains = [world.objects_of(v.type) for v in variables]
    return [{**outer, **dict(zip(names, t, strict=True))} for t in product(*domains)]


def shown_cell(cell: Cell) -> str:
    """A cell as CDL reads it: `on(a, b)`."""
    feature, arguments = cell
    return f"{feature}({', '.join(arguments)})"


# ------------------------------------------------------------------------------------------ effects


class _Returned:
    def __init__(self, value: Value) -> None:
        self.value = value


_Signal = _Returned | type[Break] | type[Continue] | None
"""Why a block ended early, if it did."""


class _Run:
    """One run over a state of its own, remembering what it wrote."""

    def __init__(self, world: World, cells: dict[Cell, object]) -> None:
        self.world = world
        self.cells = cells
        self.written: dict[Cell, object] = {}
        self.evaluator = _Evaluator(world, cells)

    def block(self, statements: tuple[Statement, ...], variables: dict[str, Value]) -> _Signal:
        for statement in statements:
            signal = self._statement(statement, variables)
            if signal is not None:
                return signal
        return None

    def _statement(self, node: Statement, variables: dict[str, Value]) -> _Signal:
        match node:
            case Assign():
                self._assign(node, variables)
            case Let(variable=variable, value=value):
                variables[variable.name] = self.evaluator.value(value, variables)
            case SetLocal(variable=name, value=value):
                variables[name] = self.evaluator.value(value, variables)
            case If(condition=condition, then=then, otherwise=otherwise):
                chosen = then if self.evaluator.value(condition, variables) else otherwise
                return self.block(chosen, variables)
            case ForRange():
                return self._for(node, variables)
            case ForEach():
                self._foreach(node, variables)
            case Break():
                return Break
            case Continue():
                return Continue
            case Return(value=value):
                return _Returned(self.evaluator.value(value, variables))
            case _:
                raise AssertionError(f"{type(node).__name__} in an effect")
        return None

    def _assign(self, node: Assign, variables: Environment) -> None:
        evaluate_ = self.evaluator.value
        feature = self.world.features[node.feature]
        cell = (node.feature, tuple([evaluate_(a, variables) for a in node.arguments]))
        value = evaluate_(node.value, variables)
        if node.operator != "=":
            read = Read(node.feature, node.arguments, feature.type, location=node.location)
            symbol = node.operator[0]
            assert symbol in ("+", "-", "*", "/")
            sum_ = Arithmetic(symbol, read, node.value, feature.type, location=node.location)  # type: ignore[arg-type]
            value = evaluate_(sum_, variables)
        try:
            value = stored(value, feature.type)
        except ValueRangeError as error:
            raise EvaluationError(str(error), node.location) from None
        self.cells[cell] = self.written[cell] = value

    def _for(self, node: ForRange, variables: dict[str, Value]) -> _Signal:
        for number in range(node.start, node.stop, node.step):
            variables[node.variable.name] = number
            signal = self.block(node.body, variables)
            if signal is Break:
                break
            if isinstance(signal, _Returned):
                return signal
        return None

    def _foreach(self, node: ForEach, variables: dict[str, Value]) -> None:
        merged: dict[Cell, object] = {}
        for inner in assignments_of(self.world, node.variables, variables):
            run = _Run(self.world, dict(self.cells))
            run.block(node.body, inner)
            for cell, value in run.written.items():
                if cell in merged and merged[cell] != value:
                    message = f"iterations write different values to `{shown_cell(cell)}`"
                    raise EvaluationError(message, node.location)
                merged[cell] = value
        self.cells.update(merged)
        self.written.update(merged)
