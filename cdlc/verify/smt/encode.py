"""Pooled formulas as z3 terms: every node once, and without recursion.

A value is a tuple of terms: one, or one a component for a vector. Truth values are Booleans, whole
numbers integers, floats real numbers; texts and opaque values are integers that stand for them.
Features and external functions are uninterpreted functions. Beside its value, an expression has a
condition under which the interpreter gives it one: no division by zero, every whole number within
its type. Both sides of `and`, `or` and `if` are evaluated as far as the interpreter does.
"""

import time
from collections.abc import Iterator
from typing import Any, assert_never

import z3

from cdlc.ir.graph import in_order, parts
from cdlc.ir.updates import NotModelled
from cdlc.verify.smt.arithmetic import (
    in_range,
    operation,
    operation_is_defined,
    real,
    widened,
)
from cdlc.verify.smt.universe import Universe
from crow.program import (
    And,
    Apply,
    Arithmetic,
    Builtin,
    Compare,
    Conditional,
    Constant,
    Expression,
    Feature,
    Function,
    Location,
    Negative,
    Not,
    Object,
    Or,
    Parameter,
    Program,
    Quantified,
    Read,
    Type,
    Variable,
    Vector,
    VectorType,
    Xor,
)
from crow.program.types import is_boolean, is_integer, is_number, is_object, underlying

Term = tuple[Any, ...]


# How many nodes are translated between two looks at the clock.
_BETWEEN_LOOKS = 256


class TimedOut(Exception):  # noqa: N818 - a limit, nothing is wrong
    """A formula so large that the time has passed before z3 has seen it."""


class Encoder:
    """Translates the formulas of one pool; `features` and `functions` are those that occurred."""

    def __init__(self, program: Program, universe: Universe, deadline: float) -> None:
        self.universe = universe
        self.deadline = deadline
        self.ctx = universe.ctx
        self.declared_features = {f.name: f for f in program.features}
        self.declared_functions = {f.name: f for f in program.functions}
        self.features: dict[str, Feature] = {}
        self.functions: dict[str, Function] = {}
        self.texts: dict[str, int] = {}
        self._values: dict[int, Term] = {}
        # One term for each node with conditions in or under it: lists would grow with the depth.
        self._conditions: dict[int, Any] = {}
        self._kept: list[Expression] = []  # or their identities might be used again

    # ------------------------------------------------------------------------------------- public

    def value(self, node: Expression) -> Term:
        """The value of an expression.

        Raises NotModelled for what has none in z3, TimedOut at the deadline.
        """
        self._kept.append(node)
        for part in in_order(node):
            if id(part) not in self._values:
                self._values[id(part)] = self._translate(part)
                if conditions := self._defined(part):
                    self._conditions[id(part)] = self._all(tuple(conditions))
                if len(self._values) % _BETWEEN_LOOKS == 0 and time.monotonic() > self.deadline:
                    raise TimedOut
        return self._values[id(node)]

    def condition(self, node: Expression) -> Any:
        """A truth value as one term."""
        return self.value(node)[0]

    def is_defined(self, node: Expression) -> Any:
        """That the interpreter has a value for an expression."""
        self.value(node)
        return self._all(tuple(self._of_part(node)))

    def variable(self, name: str, type_: Type) -> Term:
        """The terms of a parameter or bound variable."""
        return tuple(
            z3.Const(f"{name}:{type_}:{i}", sort) for i, sort in enumerate(self._sorts(type_))
        )

    def variable_is_valid(self, variable: Parameter) -> Any:
        """That a parameter has a value of its type."""
        terms = self.variable(variable.name, variable.type)
        if is_object(variable.type):
            return self.universe.is_of(terms[0], variable.type)
        return self._is_valid(terms, variable.type)

    def cell(self, feature: Feature, arguments: list[Any]) -> Term:
        """The value of a feature before the transition; arguments are objects."""
        return tuple(
            z3.Function(f"f:{feature.name}:{i}", *(a.sort() for a in arguments), sort)(*arguments)
            if arguments
            else z3.Const(f"f:{feature.name}:{i}", sort)
            for i, sort in enumerate(self._sorts(feature.type))
        )

    def fits(self, node: Expression, type_: Type) -> Any:
        """That the value of an expression can be stored in a cell of a type."""
        if is_integer(type_) and is_integer(node.type):
            return in_range(self.value(node)[0], type_)
        return z3.BoolVal(True, self.ctx)  # noqa: FBT003 - a value

    def axioms(self) -> Iterator[Any]:
        """What holds in every state of the features that occurred: their values are of their types
        and within their bounds. To be asked for after everything else.
        """
        yield from self.universe.axioms()
        for feature in self.features.values():
            arguments = [
                z3.Const(f"a{i}", self.universe.sort) for i in range(len(feature.parameters))
            ]
            terms = self.cell(feature, arguments)
            valid = self._is_valid(terms, feature.type, feature.bounds)
            if z3.is_true(valid):
                continue
            types = [p.type for p in feature.parameters]
            yield (self.universe.for_all(arguments, types, valid, terms[0]) if arguments else valid)

    # -------------------------------------------------------------------------------------- types

    def _sorts(self, type_: Type) -> tuple[Any, ...]:
        plain = underlying(type_)
        if is_object(plain):
            return (self.universe.sort,)
        if is_boolean(plain):
            return (z3.BoolSort(self.ctx),)
        if is_number(plain) and not is_integer(plain):
            return (z3.RealSort(self.ctx),)
        if isinstance(plain, VectorType) and plain.length is not None:
            return self._sorts(plain.element) * plain.length
        return (z3.IntSort(self.ctx),)

    def _is_valid(
        self, terms: Term, type_: Type, bounds: tuple[int | None, int | None] = (None, None)
    ) -> Any:
        """That terms are the value of a cell of a type.

        One of objects has an object of its type if there is one; else it cannot be read.
        """
        plain = underlying(type_)
        low, high = bounds
        conditions = [terms[0] >= low] if low is not None else []
        conditions += [terms[0] <= high] if high is not None else []
        if is_object(plain):
            other = z3.Const("other", self.universe.sort)
            some = self.universe.exists([other], [plain], z3.BoolVal(True, self.ctx))  # noqa: FBT003
            conditions.append(z3.Implies(some, self.universe.is_of(terms[0], plain)))
        elif is_integer(plain):
            conditions.append(in_range(terms[0], plain))
        elif isinstance(plain, VectorType) and is_integer(plain.element):
            conditions += [in_range(term, plain.element) for term in terms]
        return self._all(tuple(conditions))

    def _coerced(self, term: Term, sorts: tuple[Any, ...], location: Location | None) -> Term:
        if len(term) != len(sorts):
            raise NotModelled("a vector whose length is known only when it runs", location)
        return tuple(
            widened(t) if s.kind() == z3.Z3_REAL_SORT else t
            for t, s in zip(term, sorts, strict=True)
        )

    def _all(self, conditions: tuple[Any, ...]) -> Any:
        if len(conditions) == 1:
            return conditions[0]
        if not conditions:
            return z3.BoolVal(True, self.ctx)  # noqa: FBT003 - a value
        return z3.And(list(conditions))

    # -------------------------------------------------------------------------------------- values

    def _translate(self, node: Expression) -> Term:
        of = self._of
        match node:
            case Constant():
                return (self._literal(node),)
            case Variable(name=name, type=type_):
                return self.variable(name, type_)
            case Object(name=name):
                return (self.universe.constant(name),)
            case Read(feature=name, arguments=arguments):
                feature = self.features[name] = self.declared_features[name]
                return self.cell(feature, [of(a)[0] for a in arguments])
            case Apply():
                return self._apply(node)
            case Vector():
                return self._vector(node)
            case Not(operand=operand):
                return (z3.Not(of(operand)[0]),)
            case And(operands=operands):
                return (z3.And([of(o)[0] for o in operands]),)
            case Or(operands=operands):
                return (z3.Or([of(o)[0] for o in operands]),)
            case Xor(left=left, right=right):
                return (z3.Xor(of(left)[0], of(right)[0]),)
            case Compare():
                return (self._compare(node),)
            case Conditional(condition=condition, then=then, otherwise=otherwise, type=type_):
                sorts = self._sorts(type_)
                cases = [self._coerced(of(c), sorts, node.location) for c in (then, otherwise)]
                return tuple(
                    z3.If(of(condition)[0], a, b) for a, b in zip(cases[0], cases[1], strict=True)
                )
            case Negative(operand=operand):
                self._refuse_opaque(operand)
                return tuple(-term for term in of(operand))
            case Builtin():
                return (self._builtin(node),)
            case Arithmetic():
                return self._arithmetic(node)
            case Quantified():
                return (self._quantified(node, of(node.body)[0]),)
            case _:
                assert_never(node)

    def _of(self, part: Expression) -> Term:
        return self._values[id(part)]

    def _literal(self, node: Constant) -> Any:
        match node.value:
            case bool(value):
                return z3.BoolVal(value, self.ctx)
            case str(text):
                return z3.IntVal(self.texts.setdefault(text, len(self.texts)), self.ctx)
            case value if is_integer(node.type) and isinstance(value, int):
                return z3.IntVal(value, self.ctx)
            case value:
                return real(value, self.ctx)

    def _apply(self, node: Apply) -> Term:
        """An external function, uninterpreted; a vector gives as many arguments as components."""
        name = node.function
        function = self.declared_functions[name]
        self.functions[name] = function
        arguments: list[Any] = []
        for parameter, argument in zip(function.parameters, node.arguments, strict=True):
            sorts = self._sorts(parameter.type)
            arguments += self._coerced(self._of(argument), sorts, node.location)
        return self.application(name, function, arguments)

    def application(self, name: str, function: Function, arguments: list[Any]) -> Term:
        """An external function applied to terms."""
        sorts = [a.sort() for a in arguments]
        return tuple(
            z3.Function(f"e:{name}:{i}", *sorts, sort)(*arguments)
            if arguments
            else z3.Const(f"e:{name}:{i}", sort)
            for i, sort in enumerate(self._sorts(function.type))
        )

    def application_sorts(self, function: Function) -> tuple[Any, ...]:
        """The sorts of the components of a function's value."""
        return self._sorts(function.type)

    def _vector(self, node: Vector) -> Term:
        plain = underlying(node.type)
        if not isinstance(plain, VectorType) or plain.length is None:
            raise NotModelled("a list, or a vector without a length,", node.location)
        terms = tuple(term for element in node.elements for term in self._of(element))
        return self._coerced(terms, self._sorts(plain), node.location)

    def _compare(self, node: Compare) -> Any:
        left, right = self._of(node.left), self._of(node.right)
        if len(left) != len(right):
            raise NotModelled("a vector whose length is known only when it runs", node.location)
        pairs = [_alike(a, b) for a, b in zip(left, right, strict=True)]
        (a, b), *_ = pairs
        match node.operator:
            case "==":
                return self._all(tuple(x == y for x, y in pairs))
            case "!=":
                return z3.Not(self._all(tuple(x == y for x, y in pairs)))
            case "<":
                return a < b
            case "<=":
                return a <= b
            case ">":
                return a > b
            case ">=":
                return a >= b

    def _builtin(self, node: Builtin) -> Any:
        terms = [self._of(a)[0] for a in node.arguments]
        if not is_integer(node.type):
            terms = [widened(term) for term in terms]
        if node.function == "abs":
            return z3.If(terms[0] >= 0, terms[0], -terms[0])
        result = terms[0]
        for term in terms[1:]:
            is_better = term < result if node.function == "min" else term > result
            result = z3.If(is_better, term, result)
        return result

    def _arithmetic(self, node: Arithmetic) -> Term:
        return tuple(
            operation(node.operator, a, b, _element(node.type)) for a, b in self._pairs(node)
        )

    def _pairs(self, node: Arithmetic) -> list[tuple[Any, Any]]:
        """The operands; a number stands beside every component of a vector."""
        self._refuse_opaque(node.left)
        self._refuse_opaque(node.right)
        left, right = self._of(node.left), self._of(node.right)
        if len(left) == 1 and not isinstance(underlying(node.left.type), VectorType):
            left = left * len(right)
        if len(right) == 1 and not isinstance(underlying(node.right.type), VectorType):
            right = right * len(left)
        if len(left) != len(right):
            raise NotModelled("vectors of different lengths", node.location)
        return list(zip(left, right, strict=True))

    def _refuse_opaque(self, node: Expression) -> None:
        plain = underlying(node.type)
        is_vector = isinstance(plain, VectorType) and plain.length is not None
        if not is_vector and not is_number(plain):
            construct = "arithmetic on a vector whose length is known only when it runs"
            raise NotModelled(construct, node.location)

    def _quantified(self, node: Quantified, body: Any) -> Any:
        variables = [self.variable(v.name, v.type)[0] for v in node.variables]
        types = [v.type for v in node.variables]
        if node.quantifier == "forall":
            return self.universe.for_all(variables, types, body, None)
        return self.universe.exists(variables, types, body)

    # ---------------------------------------------------------------------------------- definedness

    def _of_part(self, part: Expression) -> list[Any]:
        """The condition under which a part has a value, unless it always has."""
        return [self._conditions[id(part)]] if id(part) in self._conditions else []

    def _defined(self, node: Expression) -> list[Any]:
        """The conditions under which a node has a value; none if it always has."""
        match node:
            case And(operands=operands) | Or(operands=operands):
                return self._short_circuit(operands, is_and=isinstance(node, And))
            case Conditional(condition=condition, then=then, otherwise=otherwise):
                test = self._of(condition)[0]
                cases = [(test, then), (z3.Not(test), otherwise)]
                chosen = [z3.Implies(t, c) for t, case in cases for c in self._of_part(case)]
                return [*self._of_part(condition), *chosen]
            case Quantified(quantifier=quantifier, body=body):
                if not (inner := self._of_part(body)):
                    return []
                # Only where it comes to its end are all objects looked at.
                everywhere = self._quantified(
                    Quantified("forall", node.variables, body), self._all(tuple(inner))
                )
                is_true = self._of(node)[0]
                ended = is_true if quantifier == "forall" else z3.Not(is_true)
                return [z3.Implies(ended, everywhere)]
            case _:
                inside = [c for part in parts(node) for c in self._of_part(part)]
                return [*inside, *self._own(node)]

    def _own(self, node: Expression) -> list[Any]:
        """What a node adds to the conditions of its parts."""
        match node:
            case Arithmetic(operator=op, type=type_):
                results = zip(self._pairs(node), self._of(node), strict=True)
                element = _element(type_)
                return [
                    condition
                    for (left, right), result in results
                    for condition in operation_is_defined(op, left, right, result, element)
                ]
            case Negative(type=type_) | Builtin(function="abs", type=type_) if is_integer(type_):
                return [in_range(self._of(node)[0], type_)]
            case _:
                return []

    def _short_circuit(self, operands: tuple[Expression, ...], *, is_and: bool) -> list[Any]:
        """Each operand is evaluated where those before it have not decided."""
        found: list[Any] = []
        before: Any = None
        for operand in operands:
            found += [
                condition if before is None else z3.Implies(before, condition)
                for condition in self._of_part(operand)
            ]
            value = self._of(operand)[0]
            goes_on = value if is_and else z3.Not(value)
            before = goes_on if before is None else z3.And(before, goes_on)
        return found


def _element(type_: Type) -> Type:
    plain = underlying(type_)
    return plain.element if isinstance(plain, VectorType) else type_


def _alike(left: Any, right: Any) -> tuple[Any, Any]:
    """Two numbers as one sort."""
    if left.sort().kind() == z3.Z3_REAL_SORT or right.sort().kind() == z3.Z3_REAL_SORT:
        return widened(left), widened(right)
    return left, right
