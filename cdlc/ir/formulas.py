"""Constructors of formulas, which simplify as far as the level of the pool says."""

from collections.abc import Iterable, Mapping
from typing import Any, Final, cast

from cdlc.ir.nodes import Level, Nodes
from crow.program import (
    BOOL,
    And,
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
    Type,
    Variable,
    Xor,
)
from crow.program.expressions import ArithmeticOperator, ComparisonOperator
from crow.program.types import is_integer, is_number, is_object

_FLIPPED: Final[Mapping[str, ComparisonOperator]] = {
    "==": "==",
    "!=": "!=",
    "<": ">",
    "<=": ">=",
    ">": "<",
    ">=": "<=",
}


# A comparison is split into the branches of choices within choices up to this depth: without a
# limit, a loop that compares what it writes would take time quadratic in its iterations.
MOST_SPLITS: Final = 8


class Formulas(Nodes):
    """Connectives, comparisons and arithmetic over interned expressions.

    At level `none` only what cannot change a formula's shape is folded: a choice whose condition is
    known, the negation of a negation, equality of the same or of different objects. `basic` adds
    constant folding, Boolean identities, comparison of literals and chains of whole numbers.
    """

    # --------------------------------------------------------------------------------- connectives

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
        if self._splits == MOST_SPLITS:
            return None
        self._splits += 1
        try:
            for one, other, order in ((left, right, 1), (right, left, -1)):
                if isinstance(one, Conditional):
                    cases = [(case, other)[::order] for case in (one.then, one.otherwise)]
                    if any(self._decided(operator, *case) is not None for case in cases):
                        then, otherwise = (self.compare(operator, *case) for case in cases)
                        return self.choice(one.condition, then, otherwise)
            return None
        finally:
            self._splits -= 1

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


class _Identities:
    """Membership by identity."""

    def __init__(self, nodes: Iterable[Expression]) -> None:
        self.ids = {id(node) for node in nodes}

    def __contains__(self, node: object) -> bool:
        return id(node) in self.ids


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
