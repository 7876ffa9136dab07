"""What an `achieve` wants, in the form that goals of behaviors are matched with (semantics.md §2).

Conditions are brought into negation normal form; derived functions that no behavior achieves are
unfolded. What is neither a connective nor a literal, equation or comparison is opaque: it can be
true already, and nothing else makes it so.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Final

from crow.problem import World
from crow.program import (
    And,
    Apply,
    Compare,
    Constant,
    Expression,
    ForEach,
    ForRange,
    Function,
    Let,
    Not,
    Or,
    Parameter,
    Quantified,
    Read,
    Return,
    SetLocal,
    Statement,
)
from crow.program.expressions import ComparisonOperator
from crow.program.rewrite import substitute
from crow.program.types import INT64

MIRRORED: Final[Mapping[ComparisonOperator, ComparisonOperator]] = {
    "==": "==", "!=": "!=", "<": ">", "<=": ">=", ">": "<", ">=": "<=",
}  # fmt: skip
NEGATED: Final[Mapping[ComparisonOperator, ComparisonOperator]] = {
    "==": "!=", "!=": "==", "<": ">=", "<=": ">", ">": "<=", ">=": "<",
}  # fmt: skip


def plain(condition: Expression) -> Expression:
    """A comparison with a truth value as a literal, and a negated comparison as its opposite."""
    match condition:
        case Compare(operator="==" | "!=" as op, left=left, right=Constant(value=bool(value))):
            return left if value == (op == "==") else Not(left, location=condition.location)
        case Compare(operator="==" | "!=" as op, left=Constant(value=bool(value)), right=right):
            return right if value == (op == "==") else Not(right, location=condition.location)
        case Not(operand=Compare() as compare):
            return replace(compare, operator=NEGATED[compare.operator])
        case _:
            return condition


class Wanted:
    """Conditions of one world in normal form."""

    def __init__(self, world: World) -> None:
        self.functions = world.functions
        goals = (plain(b.goal) for b in world.program.behaviors if b.goal is not None)
        self.achieved = {_polarity(goal) for goal in goals}
        self.normal = cache(self._normal)

    def _normal(self, condition: Expression, *, positive: bool = True) -> Expression:
        """The condition, or its opposite, in negation normal form."""
        match condition:
            case Not(operand=operand):
                return self.normal(operand, positive=not positive)
            case And(operands=operands) | Or(operands=operands):
                parts = tuple(self.normal(o, positive=positive) for o in operands)
                connective = And if isinstance(condition, And) == positive else Or
                return connective(parts, location=condition.location)
            case Quantified(quantifier=quantifier, body=body):
                both: tuple[str, str] = ("forall", "exists")
                kept = quantifier if positive else both[quantifier == "forall"]
                return replace(
                    condition,
                    quantifier=kept,  # type: ignore[arg-type]
                    body=self.normal(body, positive=positive),
                )
            case Apply():
                return self._applied(condition, positive=positive)
            case Compare():
                simple = plain(condition)
                if not isinstance(simple, Compare):
                    return self.normal(simple, positive=positive)
                return simple if positive else plain(Not(simple))
            case _:
                return condition if positive else Not(condition, location=condition.location)

    def _applied(self, condition: Apply, *, positive: bool) -> Expression:
        """A derived function: itself where a behavior achieves it, else what its body says."""
        if (condition.function, positive) not in self.achieved:
            unfolded = unfold(self.functions[condition.function], condition.arguments)
            if unfolded is not None:
                return self.normal(unfolded, positive=positive)
        return condition if positive else Not(condition, location=condition.location)


def _polarity(goal: Expression) -> tuple[str, bool] | None:
    match goal:
        case Apply(function=name):
            return name, True
        case Not(operand=Apply(function=name)):
            return name, False
        case _:
            return None


_MOST_COPIES = 10_000


def unfold(function: Function, arguments: tuple[Expression, ...]) -> Expression | None:
    """The value of a derived function as one expression; None where its body branches."""
    if function.body is None:
        return None
    names = [p.name for p in function.parameters]
    return _value(function.body, dict(zip(names, arguments, strict=True)), [_MOST_COPIES])


def _value(
    statements: tuple[Statement, ...], values: dict[str, Expression], left: list[int]
) -> Expression | None:
    for statement in statements:
        left[0] -= 1
        match statement:
            case Return(value=value):
                return substitute(value, values)
            case (
                Let(variable=Parameter(name=name), value=value)
                | SetLocal(variable=name, value=value)
            ):
                values[name] = substitute(value, values)
            case ForRange(variable=variable):
                for number in range(statement.start, statement.stop, statement.step):
                    values[variable.name] = Constant(number, INT64)
                    found = _value(statement.body, values, left)
                    if found is not None or left[0] < 0:
                        return found
            case ForEach():
                continue  # it can neither return nor assign what is outside
            case _:
                left[0] = -1
        if left[0] < 0:
            return None
    return None


def is_opaque(condition: Expression) -> bool:
    """Whether a condition in normal form can only be true already."""
    inner = condition.operand if isinstance(condition, Not) else condition
    return not isinstance(inner, And | Or | Quantified | Read | Apply | Compare)
