"""Conditions under what is known: Kleene's logic, and everything else as far as it goes.

Connectives keep their order: an operand that may fail is not passed over for a later one.
"""

from collections.abc import Callable, Iterable, Mapping
from operator import is_
from typing import Any, Final, assert_never

from crow.arithmetic import arithmetic, negated
from crow.calls import FunctionError
from crow.constraints.knowledge import Knowledge
from crow.constraints.python import Cells
from crow.constraints.terms import (
    ARITHMETIC,
    Failed,
    Ground,
    Open,
    first_failure,
    is_known,
    is_partial,
    lifted,
    meaning,
    opened,
)
from crow.evaluate import (
    CHOICES,
    COMPARISONS,
    EvaluationError,
    assignments_of,
    evaluate,
    shown_cell,
)
from crow.problem import State
from crow.program import (
    And,
    Apply,
    Arithmetic,
    Builtin,
    Compare,
    Conditional,
    Constant,
    Expression,
    Location,
    Negative,
    Not,
    Object,
    ObjectType,
    Or,
    Quantified,
    Read,
    Type,
    Variable,
    Vector,
    Xor,
)
from crow.program.types import BOOL, FLOAT64, UNKNOWN, is_boolean, underlying
from crow.unknowns import Touched, Unknown, kept, unknowns_in
from crow.values import Value, converted, stored

Environment = Mapping[str, Ground]
_ABSENT: Final = object()


class Reducer:
    """Works terms out under the values that unknowns have by now; `values` needs `get` alone.

    `seen` are the unknowns that were met in expressions.
    """

    def __init__(self, knowledge: Knowledge, values: Any) -> None:
        self.knowledge = knowledge
        self.world = knowledge.world
        self.values = values
        self.seen: dict[Unknown, None] = {}
        self._atom: Ground = None
        self._side = False

    # ------------------------------------------------------------------------------- expressions

    def reduce(self, node: Expression, variables: Environment, cells: Cells) -> Ground:
        """What an expression comes to in the cells of a state."""

        def of(part: Expression) -> Ground:
            return self.reduce(part, variables, cells)

        match node:
            case Constant(value=value):
                return value
            case Object(name=name):
                return name
            case Variable(name=name, type=type_):
                if name not in variables:
                    return _failed(f"`{name}` has no value yet", node.location)
                return self.known(variables[name], type_)
            case Read():
                return self._made(node, "read", map(of, node.arguments), node.feature, cells)
            case Apply():
                return self._apply(node, [of(a) for a in node.arguments], cells)
            case Not(operand=operand):
                return negation(of(operand), node.location)
            case And(operands=operands):
                return connective("and", map(of, operands), node.location)
            case Or(operands=operands):
                return connective("or", map(of, operands), node.location)
            case Quantified():
                inner = assignments_of(self.world, node.variables, variables)
                each = (self.reduce(node.body, i, cells) for i in inner)
                return connective(
                    "and" if node.quantifier == "forall" else "or", each, node.location
                )
            case Xor(left=left, right=right):
                return self._made(node, "xor", (of(left), of(right)))
            case Compare(operator=op, left=left, right=right):
                return self._made(node, op, (of(left), of(right)))
            case Arithmetic(operator=op, left=left, right=right):
                return self._made(node, op, (of(left), of(right)))
            case Negative(operand=operand):
                return self._made(node, "negative", (of(operand),))
            case Builtin(function=name, arguments=arguments):
                return self._made(node, "builtin", map(of, arguments), name)
            case Vector(elements=elements):
                return self._made(node, "vector", map(of, elements))
            case Conditional(condition=condition, then=then, otherwise=otherwise, type=type_):
                return self._conditional(
                    of(condition), lambda: of(then), lambda: of(otherwise), type_, node.location
                )
            case _:
                assert_never(node)

    def known(self, ground: Ground, type_: Type = UNKNOWN) -> Ground:
        """A ground with its unknowns looked up, where it is a value or an unknown."""
        if type(ground) is Unknown:
            self.seen[ground] = None
            return self.values.get(ground, ground)
        if type(ground) is tuple:
            vector = lifted(ground, type_)
            self.seen |= dict.fromkeys(unknowns_in(ground))
            return self.refreshed(vector) if vector is not ground else ground
        return ground

    def _made(
        self,
        node: Any,
        operator: str,
        operands: Iterable[Ground],
        name: str = "",
        cells: Cells | None = None,
    ) -> Ground:
        return self.made(operator, tuple(operands), node.type, node.location, name, cells)

    def _apply(self, node: Apply, arguments: list[Ground], cells: Cells) -> Ground:
        function = self.world.functions[node.function]
        pairs = zip(function.parameters, arguments, node.arguments, strict=True)
        own = tuple([self._as(p.type, given, a.location) for p, given, a in pairs])
        failed = first_failure(own)
        if failed is not None:
            return failed
        if function.body is None:
            python = self.knowledge.python.functions.get(node.function)
            if python is None:
                message = f"the external function `{function.name}` has no Python given for it"
                return _failed(message, node.location)
            read = tuple(dict.fromkeys(self.knowledge.unknowns_read(cells, python.reads)))
            return self._made(node, "call", (*own, *map(self.known, read)), function.name, cells)
        body = self.knowledge.body(function.name)
        if body is None:
            return self._made(node, "run", own, function.name, cells)
        names = [p.name for p in function.parameters]
        value = self.reduce(body, dict(zip(names, own, strict=True)), cells)
        found = self._as(function.type, value, node.location)
        return self._named(found, own, node.type, node.location, function.name, cells)

    def _named(
        self,
        found: Ground,
        arguments: tuple[Ground, ...],
        type_: Type,
        location: Location | None,
        name: str,
        cells: Cells | None,
    ) -> Ground:
        """What a function or cell comes to, by its name if a generator is for it."""
        if is_known(found) or type(found) is Failed or name not in self.knowledge.goals:
            return found
        return opened("named", (found, *arguments), type_, location, name, cells)

    def _as(self, type_: Type, ground: Ground, location: Location | None) -> Ground:
        """A ground converted to a type."""
        if isinstance(type_, ObjectType) or is_boolean(type_):
            return ground
        if type(ground) is Open and underlying(ground.type) == underlying(type_):
            return ground
        return self.made("convert", (ground,), type_, location)

    def _conditional(
        self,
        condition: Ground,
        then: Callable[[], Ground],
        otherwise: Callable[[], Ground],
        type_: Type,
        location: Location | None,
    ) -> Ground:
        if type(condition) is Failed:
            return condition
        if is_known(condition):
            return self._as(type_, then() if condition else otherwise(), location)
        left, right = (self._as(type_, branch(), location) for branch in (then, otherwise))
        if is_known(left) and is_known(right) and left == right and not is_partial(condition):
            return left
        return opened("if", (condition, left, right), type_, location)

    # ------------------------------------------------------------------------------------- terms

    def with_atom(self, ground: Ground, atom: Ground, is_true: bool) -> Ground:
        """A ground under what is known by now, and with the truth value of an atom in it."""
        decided = Reducer(self.knowledge, self.values)
        decided._atom, decided._side = atom, is_true
        return decided.refreshed(ground)

    def refreshed(self, ground: Ground) -> Ground:
        """A ground under what is known by now."""
        kind = type(ground)
        if ground is self._atom and kind is Open:
            return self._side
        if kind is Unknown:
            return self.values.get(ground, ground)
        if kind is not Open:
            return ground
        op, operands = ground.operator, ground.operands
        if op in ("and", "or"):
            return connective(op, map(self.refreshed, operands), ground.location)
        if op == "not":
            return negation(self.refreshed(operands[0]), ground.location)
        if op == "if":
            return self._conditional(
                self.refreshed(operands[0]),
                lambda: self.refreshed(operands[1]),
                lambda: self.refreshed(operands[2]),
                ground.type,
                ground.location,
            )
        new = tuple([self.refreshed(o) for o in operands])
        if all(map(is_, new, operands)):
            return ground
        if op == "named":
            own = ground.type, ground.location, ground.name, ground.cells
            return self._named(new[0], new[1:], *own)
        return self.made(op, new, ground.type, ground.location, ground.name, ground.cells)

    def made(
        self,
        operator: str,
        operands: tuple[Ground, ...],
        type_: Type,
        location: Location | None = None,
        name: str = "",
        cells: Cells | None = None,
    ) -> Ground:
        """An operation that needs its operands: its value, or a term."""
        failed = first_failure(operands)
        if failed is not None:
            return failed
        if all(map(is_known, operands)):
            return self._computed(operator, operands, type_, location, name, cells)
        if operator in COMPARISONS:
            return self._compared(operator, operands[0], operands[1], location)
        if operator == "xor":
            return self._differ(operands[0], operands[1], location)
        if operator in ARITHMETIC and any(map(_is_vector, operands)):
            return self._by_element(operator, operands[0], operands[1], type_, location)
        if operator == "convert" and type(operands[0]) is Unknown:
            return _converted_unknown(operands[0], type_, location)
        return opened(operator, operands, type_, location, name, cells)

    def _computed(
        self,
        operator: str,
        operands: tuple[Value, ...],
        type_: Type,
        location: Location | None,
        name: str,
        cells: Cells | None,
    ) -> Ground:
        """The value of an operation whose operands are known."""
        try:
            match operator:
                case "vector":
                    return operands
                case "xor":
                    return operands[0] != operands[1]
                case "negative":
                    return negated(operands[0], type_)
                case "convert":
                    return converted(operands[0], type_)
                case "store":
                    return stored(operands[0], type_)
                case "builtin":
                    value = abs(operands[0]) if name == "abs" else CHOICES[name](list(operands))
                    return converted(value, type_)
                case "read":
                    assert cells is not None
                    return self._cell(name, operands, cells, type_, location)
                case "call" | "run":
                    assert cells is not None
                    return self._called(operator, operands, type_, location, name, cells)
                case _ if operator in COMPARISONS:
                    return COMPARISONS[operator](operands[0], operands[1])
                case _:
                    return arithmetic(operator, operands[0], operands[1], type_)  # type: ignore[arg-type]
        except ArithmeticError as error:
            return _failed(str(error), location)

    def _cell(
        self,
        feature: str,
        objects: tuple[str, ...],
        cells: Cells,
        type_: Type,
        location: Location | None,
    ) -> Ground:
        cell = (feature, objects)
        value = cells.get(cell, self.world.defaults[feature])
        if value is None:
            return _failed(f"`{shown_cell(cell)}` has no value", location)
        return self._named(self.known(value, type_), objects, type_, location, feature, cells)

    def _called(
        self,
        operator: str,
        operands: tuple[Value, ...],
        type_: Type,
        location: Location | None,
        name: str,
        cells: Cells,
    ) -> Ground:
        """The value of a function that is no expression."""
        function = self.world.functions[name]
        arguments = operands[: len(function.parameters)]
        now = self.knowledge.resolved(cells, self.values)
        try:
            if operator == "call":
                return self.knowledge.python.functions[name].value(now, arguments, location)
            read = (u for _, value in self.knowledge.open_cells(cells) for u in unknowns_in(value))
            self.seen |= dict.fromkeys(read)
            own = tuple([Variable(p.name, p.type) for p in function.parameters])
            names = {p.name: a for p, a in zip(function.parameters, arguments, strict=True)}
            return evaluate(self.world, State(now), Apply(name, own, function.type), names)
        except Touched as stop:
            return opened("run", (*arguments, stop.unknown), type_, location, name, cells)
        except (EvaluationError, FunctionError) as error:
            return Failed(error)  # it may be guarded, and is raised if it is not

    def _compared(
        self, operator: str, left: Ground, right: Ground, location: Location | None
    ) -> Ground:
        """A comparison whose sides are not both known."""
        if meaning(left) is meaning(right):
            return operator in ("==", "<=", ">=")
        if operator in ("==", "!="):
            first, second = _elements(left), _elements(right)
            if first is not None and second is not None:
                return self._compared_vectors(operator, first, second, location)
            for known, other in ((left, right), (right, left)):
                if isinstance(known, bool):
                    same = known == (operator == "==")
                    return other if same else negation(other, location)
        return opened(operator, (left, right), BOOL, location)

    def _compared_vectors(
        self,
        operator: str,
        left: tuple[Ground, ...],
        right: tuple[Ground, ...],
        location: Location | None,
    ) -> Ground:
        if len(left) != len(right):
            return operator == "!="
        pairs = zip(left, right, strict=True)
        same = connective("and", (self.made("==", p, BOOL, location) for p in pairs), location)
        return same if operator == "==" else negation(same, location)

    def _differ(self, left: Ground, right: Ground, location: Location | None) -> Ground:
        if meaning(left) is meaning(right):
            return False
        for known, other in ((left, right), (right, left)):
            if is_known(known):
                return negation(other, location) if known else other
        return opened("xor", (left, right), BOOL, location)

    def _by_element(
        self, operator: str, left: Ground, right: Ground, type_: Type, location: Location | None
    ) -> Ground:
        """Arithmetic on vectors some of whose elements are known."""
        pair = _elements(left), _elements(right)
        if any(e is None and _may_be_vector(g) for e, g in zip(pair, (left, right), strict=True)):
            return opened(operator, (left, right), type_, location)
        sizes = [len(e) for e in pair if e is not None]
        if len(set(sizes)) > 1:
            message = f"one vector has {sizes[0]} elements, the other {sizes[1]}"
            return _failed(message, location)
        element = getattr(underlying(type_), "element", FLOAT64)
        columns = [[g] * sizes[0] if e is None else e
                   for e, g in zip(pair, (left, right), strict=True)]  # fmt: skip
        rows = [self.made(operator, row, element, location) for row in zip(*columns, strict=True)]
        return self.made("vector", tuple(rows), type_, location)


# ----------------------------------------------------------------------------------- connectives


def connective(operator: str, operands: Iterable[Ground], location: Location | None) -> Ground:
    """`and` or `or` of operands, which are asked for from left to right, as far as is needed."""
    decides = operator == "or"
    left: list[Ground] = []
    for operand in operands:
        if type(operand) is Failed:
            left.append(operand)
            break
        if not is_known(operand):
            left.append(operand)
        elif bool(operand) == decides:
            # What may fail comes before, and would fail before this is looked at.
            left = [*filter(is_partial, left), decides]
            break
    if not left:
        return not decides
    return left[0] if len(left) == 1 else opened(operator, tuple(left), BOOL, location)


def negation(operand: Ground, location: Location | None = None) -> Ground:
    """`not` of an operand."""
    if type(operand) is Failed:
        return operand
    if is_known(operand):
        return not operand
    if type(operand) is Open and operand.operator == "not":
        return operand.operands[0]
    return opened("not", (operand,), BOOL, location)


def _failed(message: str, location: Location | None) -> Failed:
    return Failed(EvaluationError(message, location))


def _converted_unknown(unknown: Unknown, type_: Type, location: Location | None) -> Ground:
    try:
        return kept(unknown, type_)
    except Touched:
        return opened("convert", (unknown,), type_, location)


def _is_vector(ground: Ground) -> bool:
    return type(ground) is Open and _elements(ground) is not None


def _elements(ground: Ground) -> tuple[Ground, ...] | None:
    """The elements of a vector that is written out."""
    ground = meaning(ground)
    if type(ground) is tuple:
        return ground
    if type(ground) is Open and ground.operator == "vector":
        return ground.operands
    return None


def _may_be_vector(ground: Ground) -> bool:
    return isinstance(ground, Open | Unknown) and hasattr(underlying(ground.type), "element")
