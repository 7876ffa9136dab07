"""Hash-consed expressions: equal ones are one object, so formulas are graphs, not trees.

`for i in range(30): if f[x] > i: f[x] -= 1` has a formula whose tree has 2**30 leaves and whose
graph has a hundred nodes. Everything that builds formulas goes through a Pool; its constructors
also simplify, as far as its level says. Pooled expressions are compared with `is`: comparing or
hashing their structure would unfold the graph.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Any, Final, TypeVar, cast

from cdlc.ir.graph import in_order, parts
from crow.program import (
    BOOL,
    And,
    Apply,
    Arithmetic,
    Builtin,
    Compare,
    Conditional,
    Constant,
    Expression,
    Hierarchy,
    Location,
    Negative,
    Not,
    Object,
    ObjectType,
    Or,
    Parameter,
    Quantified,
    Read,
    Scalar,
    Type,
    Variable,
    Vector,
    Xor,
)
from crow.program.expressions import ArithmeticOperator, ComparisonOperator
from crow.program.types import is_integer, is_number, is_object

_E = TypeVar("_E", bound=Expression)


class Level(StrEnum):
    """How far formulas are simplified (lowering.md §1)."""

    NONE = "none"
    BASIC = "basic"
    FULL = "full"


_FLIPPED: Final[Mapping[str, ComparisonOperator]] = {
    "==": "==",
    "!=": "!=",
    "<": ">",
    "<=": ">=",
    ">": "<",
    ">=": "<=",
}


@dataclass
class Pool:
    """The expressions of one model, each once.

    At level `none` only what cannot change a formula's shape is folded: a choice whose condition is
    known, the negation of a negation, equality of the same or of different objects. `basic` adds
    constant folding, Boolean identities, comparison of literals and chains of whole numbers.
    """

    hierarchy: Hierarchy
    level: Level = Level.BASIC
    _nodes: dict[tuple[object, ...], Expression] = field(default_factory=dict)
    _free: dict[int, frozenset[str]] = field(default_factory=dict)
    _heights: dict[int, int] = field(default_factory=dict)
    _fresh: int = 0

    def __post_init__(self) -> None:
        self.true = self.constant(True, BOOL)  # noqa: FBT003 - a value
        self.false = self.constant(False, BOOL)  # noqa: FBT003 - a value

    def __len__(self) -> int:
        return len(self._nodes)

    # ------------------------------------------------------------------------------------- leaves

    def constant(self, value: Scalar, type_: Type, location: Location | None = None) -> Expression:
        """A literal."""
        key = ("constant", type(value), value, type_)
        return self._intern(key, lambda: Constant(value, type_, location=location))

    def variable(self, name: str, type_: Type) -> Expression:
        """A parameter or bound variable."""
        return self._intern(("variable", name, type_), lambda: Variable(name, type_))

    def named_object(self, name: str, type_: Type) -> Expression:
        """An object constant."""
        return self._intern(("object", name, type_), lambda: Object(name, type_))

    def fresh(self, parameter: Parameter) -> Expression:
        """A variable that occurs nowhere yet; its name cannot be written in CDL."""
        self._fresh += 1
        return self.variable(f"{parameter.name}'{self._fresh}", parameter.type)

    # ----------------------------------------------------------------------------------- compound

    def read(
        self,
        feature: str,
        arguments: tuple[Expression, ...],
        type_: Type,
        location: Location | None = None,
    ) -> Expression:
        """The value of a feature before the transition."""
        key = ("read", feature, *map(id, arguments))
        return self._intern(key, lambda: Read(feature, arguments, type_, location=location))

    def apply(
        self,
        function: str,
        arguments: tuple[Expression, ...],
        type_: Type,
        location: Location | None = None,
    ) -> Expression:
        """A call of an external function, uninterpreted."""
        key = ("apply", function, *map(id, arguments))
        return self._intern(key, lambda: Apply(function, arguments, type_, location=location))

    def vector(self, elements: tuple[Expression, ...], type_: Type) -> Expression:
        """A vector of given elements."""
        key = ("vector", type_, *map(id, elements))
        return self._intern(key, lambda: Vector(elements, type_))

    def negation(self, operand: Expression) -> Expression:
        """The opposite of a condition."""
        match operand:
            case Not(operand=inner):
                return inner
            case Constant(value=value):
                return self.false if value else self.true
            case _:
                return self._intern(("not", id(operand)), lambda: Not(operand))

    def conjunction(self, parts: Iterable[Expression]) -> Expression:
        """All of the parts, each once."""
        kept = self._gathered(And, parts, neutral=self.true)
        if self.false in _Identities(kept) or self._has_opposites(kept):
            return self.false
        if len(kept) <= 1:
            return kept[0] if kept else self.true
        return self._intern(("and", *map(id, kept)), lambda: And(tuple(kept)))

    def disjunction(self, parts: Iterable[Expression]) -> Expression:
        """Any of the parts, each once."""
        kept = self._gathered(Or, parts, neutral=self.false)
        if self.true in _Identities(kept) or self._has_opposites(kept):
            return self.true
        if len(kept) <= 1:
            return kept[0] if kept else self.false
        return self._intern(("or", *map(id, kept)), lambda: Or(tuple(kept)))

    def _gathered(
        self, connective: type[And | Or], parts: Iterable[Expression], neutral: Expression
    ) -> list[Expression]:
        """The operands of a connective: nested ones spread out, repeated and neutral ones gone."""
        kept: dict[int, Expression] = {}
        for part in parts:
            spread = part.operands if isinstance(part, connective) else (part,)
            for operand in spread:
                if operand is not neutral:
                    kept[id(operand)] = operand
        return list(kept.values())

    def _has_opposites(self, parts: list[Expression]) -> bool:
        if self.level is Level.NONE:
            return False
        known = {id(part) for part in parts}
        return any(id(self.negation(part)) in known for part in parts)

    def exclusive(self, left: Expression, right: Expression) -> Expression:
        """Whether two conditions differ."""
        if left is right:
            return self.false
        for one, other in ((left, right), (right, left)):
            if one is self.false:
                return other
            if one is self.true:
                return self.negation(other)
        return self._intern(("xor", id(left), id(right)), lambda: Xor(left, right))

    def choice(self, condition: Expression, then: Expression, otherwise: Expression) -> Expression:
        """`then if condition else otherwise`; never of a negated condition."""
        if condition is self.true or then is otherwise:
            return then
        if condition is self.false:
            return otherwise
        if isinstance(condition, Not):
            return self.choice(condition.operand, otherwise, then)
        if then.type == BOOL and otherwise.type == BOOL:
            return self._boolean_choice(condition, then, otherwise)
        type_ = self._common(then.type, otherwise.type)
        key = ("if", id(condition), id(then), id(otherwise))
        return self._intern(key, lambda: Conditional(condition, then, otherwise, type_))

    def _common(self, then: Type, otherwise: Type) -> Type:
        """A type that values of both types have."""
        if is_object(then) and is_object(otherwise):
            above = self.hierarchy.ancestors(str(otherwise))
            return ObjectType(next(t for t in self.hierarchy.ancestors(str(then)) if t in above))
        return otherwise if is_integer(then) and is_number(otherwise) else then

    def _boolean_choice(
        self, condition: Expression, then: Expression, otherwise: Expression
    ) -> Expression:
        if then is self.true:
            return self.disjunction((condition, otherwise))
        if then is self.false:
            return self.conjunction((self.negation(condition), otherwise))
        if otherwise is self.false:
            return self.conjunction((condition, then))
        if otherwise is self.true:
            return self.disjunction((self.negation(condition), then))
        key = ("if", id(condition), id(then), id(otherwise))
        return self._intern(key, lambda: Conditional(condition, then, otherwise, BOOL))

    # --------------------------------------------------------------------------------- comparisons

    def equal(self, left: Expression, right: Expression) -> Expression:
        """`left == right`, decided where the sides are the same or can never be."""
        return self.compare("==", left, right)

    def compare(
        self, operator: ComparisonOperator, left: Expression, right: Expression
    ) -> Expression:
        """A comparison."""
        decided = self._decided(operator, left, right)
        if decided is not None:
            return self.true if decided else self.false
        if left.type == BOOL and right.type == BOOL and self.level is not Level.NONE:
            differ = self.exclusive(left, right)
            return differ if operator == "!=" else self.negation(differ)
        if self.level is not Level.NONE and (split := self._split(operator, left, right)):
            return split
        if self.level is not Level.NONE:
            operator, left, right = self._normal_comparison(operator, left, right)
            decided = self._decided(operator, left, right)
            if decided is not None:
                return self.true if decided else self.false
            if operator == "!=":
                return self.negation(self.equal(left, right))
        key = ("compare", operator, id(left), id(right))
        return self._intern(key, lambda: Compare(operator, left, right))

    def _split(
        self, operator: ComparisonOperator, left: Expression, right: Expression
    ) -> Expression | None:
        """A comparison with a choice, where one branch decides it: a choice of two conditions."""
        for one, other, order in ((left, right, 1), (right, left, -1)):
            if isinstance(one, Conditional):
                cases = [(case, other)[::order] for case in (one.then, one.otherwise)]
                if any(self._decided(operator, *case) is not None for case in cases):
                    then, otherwise = (self.compare(operator, *case) for case in cases)
                    return self.choice(one.condition, then, otherwise)
        return None

    def _decided(
        self, operator: ComparisonOperator, left: Expression, right: Expression
    ) -> bool | None:
        """The truth of a comparison that does not depend on the state."""
        # Floats are left alone: NaN is not equal to itself.
        if left is right and (is_integer(left.type) or not is_number(left.type)):
            return (
                operator in ("==", "<=", ">=")
                if operator in ("==", "!=") or is_number(left.type)
                else None
            )
        match left, right:
            case Object(), Object():
                return operator == "!="
            case Constant(value=a), Constant(value=b) if self.level is not Level.NONE:
                return _compared(operator, a, b)
            case _ if is_object(left.type) and is_object(right.type):
                apart = not self.hierarchy.may_share_objects(left.type, right.type)
                return (operator == "!=") if apart else None
            case _:
                return None

    def _normal_comparison(
        self, operator: ComparisonOperator, left: Expression, right: Expression
    ) -> tuple[ComparisonOperator, Expression, Expression]:
        """Objects: variables first, by name. Whole numbers: the literal to the right, and
        `x - 1 > 0` as `x > 1`.
        """
        if is_object(left.type):
            turned = _leaf_order(right) < _leaf_order(left)
            return (operator, right, left) if turned else (operator, left, right)
        if isinstance(left, Constant) and not isinstance(right, Constant):
            operator, left, right = _FLIPPED[operator], right, left
        if not (is_integer(left.type) and isinstance(right, Constant)):
            return operator, left, right
        base, offset = _chain(left)
        if base is left or type(right.value) is not int:
            return operator, left, right
        return operator, base, self.constant(right.value - offset, right.type)

    # ---------------------------------------------------------------------------------- arithmetic

    def arithmetic(
        self,
        operator: ArithmeticOperator,
        left: Expression,
        right: Expression,
        type_: Type,
        location: Location | None = None,
    ) -> Expression:
        """A binary operation; with whole numbers, chains of `+` and `-` of literals are summed."""
        if self.level is not Level.NONE and is_integer(type_):
            match operator, left, right:
                case "+" | "-" | "*", Constant(value=int(a)), Constant(value=int(b)):
                    return self._folded({"+": a + b, "-": a - b, "*": a * b}[operator], type_)
                case "+", Constant(), _:
                    left, right = right, left
                case _:
                    pass
            if operator in "+-" and isinstance(right, Constant):
                return self._sum(operator, left, right, type_, location)
        key = ("arithmetic", operator, type_, id(left), id(right))
        made = lambda: Arithmetic(operator, left, right, type_, location=location)  # noqa: E731
        return self._intern(key, made)

    def _folded(self, value: int, type_: Type) -> Expression:
        return self.constant(value, type_)

    def _sum(
        self,
        operator: ArithmeticOperator,
        left: Expression,
        right: Constant,
        type_: Type,
        location: Location | None,
    ) -> Expression:
        base, offset = _chain(left)
        offset += cast("int", right.value) if operator == "+" else -cast("int", right.value)
        if offset == 0:
            return base
        amount = self.constant(abs(offset), right.type)
        sign: ArithmeticOperator = "+" if offset > 0 else "-"
        key = ("arithmetic", sign, type_, id(base), id(amount))
        return self._intern(key, lambda: Arithmetic(sign, base, amount, type_, location=location))

    def negative(self, operand: Expression, type_: Type) -> Expression:
        """Unary minus."""
        if isinstance(operand, Constant) and self.level is not Level.NONE:
            return self.constant(-cast("int", operand.value), operand.type)
        return self._intern(("negative", id(operand)), lambda: Negative(operand, type_))

    def builtin(self, function: Any, arguments: tuple[Expression, ...], type_: Type) -> Expression:
        """`min`, `max` or `abs`."""
        if self.level is not Level.NONE and all(isinstance(a, Constant) for a in arguments):
            values = [cast("Constant", a).value for a in arguments]
            folded = abs(values[0]) if function == "abs" else (min, max)[function == "max"](values)  # type: ignore[arg-type]
            return self.constant(folded, type_)
        key = ("builtin", function, *map(id, arguments))
        return self._intern(key, lambda: Builtin(function, arguments, type_))

    # --------------------------------------------------------------------------------- quantifiers

    def quantified(
        self, quantifier: Any, variables: tuple[Expression, ...], body: Expression
    ) -> Expression:
        """`forall` or `exists` over fresh variables, which are renamed by how deep they stand.

        So formulas that differ only in the names of bound variables are one.
        """
        if not variables:
            return body
        used = self.free_variables(body)
        bound = [v for v in variables if isinstance(v, Variable) and v.name in used]
        if not bound or body is self.true or body is self.false:
            # `forall x: c` is true where there is no x at all; only then does it matter.
            if body is (self.true if quantifier == "forall" else self.false):
                return body
            bound = [v for v in variables if isinstance(v, Variable)]
        height = self._heights[id(body)] + 1
        named = [replace_name(v, f"_{height}_{i}") for i, v in enumerate(bound)]
        renaming = {
            old.name: self.variable(new.name, new.type)
            for old, new in zip(bound, named, strict=True)
        }
        renamed = self.substitute(body, renaming)
        parameters = tuple(Parameter(v.name, v.type) for v in named)
        key = (quantifier, *((p.name, p.type) for p in parameters), id(renamed))
        return self._intern(key, lambda: Quantified(quantifier, parameters, renamed))

    # --------------------------------------------------------------------------------- rebuilding

    def substitute(self, node: Expression, values: Mapping[str, Expression]) -> Expression:
        """A pooled expression with free variables replaced, and none captured by a quantifier."""
        if self._free[id(node)].isdisjoint(values):
            return node
        return self.rebuild(node, values)

    def rebuild(
        self,
        node: Expression,
        values: Mapping[str, Expression],
        rule: Callable[[Expression], Expression] | None = None,
    ) -> Expression:
        """The expression built anew, innermost first, each shared part once.

        Free variables are replaced by `values`; `rule` says what stands for each node. An
        expression from outside comes into the pool in this way, too.
        """
        done: dict[int, Expression] = {}
        for part in in_order(node, into_quantifiers=False):
            match part:
                case Variable(name=name) if name in values:
                    made = values[name]
                case Quantified():
                    made = self._rebuild_quantified(part, values, rule)
                case _:
                    made = self._again(part, done)
                    made = made if rule is None else rule(made)
            done[id(part)] = made
        return done[id(node)]

    def given(self, node: Expression, facts: Iterable[Expression]) -> Expression:
        """The expression where some conditions are known to hold: they are true in it."""
        known: dict[int, Expression] = {}
        for fact in facts:
            plain, value = (
                (fact.operand, self.false) if isinstance(fact, Not) else (fact, self.true)
            )
            if isinstance(plain, Constant):
                continue
            known[id(plain)] = value
            if isinstance(plain, Compare) and plain.operator == "==":
                known[id(self.equal(plain.right, plain.left))] = value
        return self.rebuild(node, {}, lambda part: known.get(id(part), part))

    def _rebuild_quantified(
        self,
        node: Quantified,
        values: Mapping[str, Expression],
        rule: Callable[[Expression], Expression] | None,
    ) -> Expression:
        if rule is None and id(node) in self._free:
            free = self._free[id(node)]
            if free.isdisjoint(values):
                return node
            used = [values[name] for name in free if name in values]
            if not any(self._heights[id(value)] for value in used):
                return self._substituted_inside(node, values)
        opened = tuple(self.fresh(v) for v in node.variables)
        names = {v.name: o for v, o in zip(node.variables, opened, strict=True)}
        body = self.rebuild(node.body, {**values, **names}, rule)
        made = self.quantified(node.quantifier, opened, body)
        return made if rule is None else rule(made)

    def _substituted_inside(self, node: Quantified, values: Mapping[str, Expression]) -> Expression:
        """A quantifier over a changed body, its own variables as they were.

        Values without quantifiers leave how deep it stands, and so its variables' names, alone; and
        those names are free in no value.
        """
        bound = {v.name for v in node.variables}
        inner = {name: value for name, value in values.items() if name not in bound}
        body = self.rebuild(node.body, inner)
        if body is self.true or body is self.false or not bound <= self._free[id(body)]:
            opened = tuple(self.variable(v.name, v.type) for v in node.variables)
            return self.quantified(node.quantifier, opened, body)
        key = (node.quantifier, *((p.name, p.type) for p in node.variables), id(body))
        return self._intern(key, lambda: Quantified(node.quantifier, node.variables, body))

    def _again(self, node: Expression, done: Mapping[int, Expression]) -> Expression:
        def new(part: Expression) -> Expression:
            return done[id(part)]

        match node:
            case Constant(value=value, type=type_):
                return self.constant(value, type_, node.location)
            case Variable(name=name, type=type_):
                return self.variable(name, type_)
            case Object(name=name, type=type_):
                return self.named_object(name, type_)
            case Read(feature=name, arguments=arguments, type=type_):
                return self.read(name, tuple(map(new, arguments)), type_, node.location)
            case Apply(function=name, arguments=arguments, type=type_):
                return self.apply(name, tuple(map(new, arguments)), type_, node.location)
            case Builtin(function=name, arguments=arguments, type=type_):
                return self.builtin(name, tuple(map(new, arguments)), type_)
            case Vector(elements=elements, type=type_):
                return self.vector(tuple(map(new, elements)), type_)
            case Not(operand=operand):
                return self.negation(new(operand))
            case And(operands=operands):
                return self.conjunction(map(new, operands))
            case Or(operands=operands):
                return self.disjunction(map(new, operands))
            case Xor(left=left, right=right):
                return self.exclusive(new(left), new(right))
            case Compare(operator=op, left=left, right=right):
                return self.compare(op, new(left), new(right))
            case Negative(operand=operand, type=type_):
                return self.negative(new(operand), type_)
            case Arithmetic(operator=op, left=left, right=right, type=type_):
                return self.arithmetic(op, new(left), new(right), type_, node.location)
            case Conditional(condition=condition, then=then, otherwise=otherwise):
                return self.choice(new(condition), new(then), new(otherwise))
            case Quantified():
                raise AssertionError("quantifiers are opened before their bodies are rebuilt")

    def _intern(self, key: tuple[object, ...], make: Callable[[], _E]) -> Expression:
        node = self._nodes.get(key)
        if node is None:
            node = self._nodes[key] = make()
            self._free[id(node)] = self._free_in(node)
            self._heights[id(node)] = self._height_of(node)
        return node

    def _free_in(self, node: Expression) -> frozenset[str]:
        if isinstance(node, Variable):
            return frozenset((node.name,))
        inside = [self._free[id(part)] for part in parts(node)]
        free = inside[0].union(*inside[1:]) if inside else frozenset()
        return free - {v.name for v in node.variables} if isinstance(node, Quantified) else free

    def _height_of(self, node: Expression) -> int:
        inner = max((self._heights[id(part)] for part in parts(node)), default=0)
        return inner + isinstance(node, Quantified)

    def free_variables(self, node: Expression) -> frozenset[str]:
        """The names of a pooled expression's variables that no quantifier within binds."""
        return self._free[id(node)]


class _Identities:
    """Membership by identity."""

    def __init__(self, nodes: Iterable[Expression]) -> None:
        self.ids = {id(node) for node in nodes}

    def __contains__(self, node: object) -> bool:
        return id(node) in self.ids


def replace_name(variable: Variable, name: str) -> Variable:
    """The variable under another name."""
    return replace(variable, name=name)


def _leaf_order(node: Expression) -> tuple[int, str]:
    match node:
        case Variable(name=name):
            return 0, name
        case Object(name=name):
            return 1, name
        case _:
            return 2, ""


def _chain(node: Expression) -> tuple[Expression, int]:
    """A whole number as a base and the sum of the literals added to it."""
    match node:
        case Arithmetic(operator="+", left=base, right=Constant(value=int(n))):
            return base, n
        case Arithmetic(operator="-", left=base, right=Constant(value=int(n))):
            return base, -n
        case _:
            return node, 0


def _compared(operator: ComparisonOperator, left: Any, right: Any) -> bool:
    match operator:
        case "==":
            return bool(left == right)
        case "!=":
            return bool(left != right)
        case "<":
            return bool(left < right)
        case "<=":
            return bool(left <= right)
        case ">":
            return bool(left > right)
        case ">=":
            return bool(left >= right)
