"""Numbers in PDDL 2.1: expressions over functions, and comparisons of them."""

from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction

from cdlc.backends.pddl.sexpr import NotPddl, SExpr, negated
from crow.program import Arithmetic, Compare, Constant, Expression, Negative, Read
from crow.text import expression_text

# How an expression that is no arithmetic is written: a read of a function.
Leaf = Callable[[Read], SExpr]


def number_text(value: float | Fraction) -> str:
    """A number as PDDL takes it: decimal, without an exponent."""
    if value == int(value):
        return str(int(value))
    return format(Decimal(repr(float(value))), "f")


def numeric(node: Expression, leaf: Leaf) -> SExpr:
    """A number as a PDDL expression. Raises NotPddl for `//`, `%`, `**` and functions of Python."""
    match node:
        case Constant(value=int() | float() as value):
            return number_text(value)
        case Read():
            return leaf(node)
        case Negative(operand=operand):
            return ("*", "-1", numeric(operand, leaf))
        case Arithmetic(operator="+" | "-" | "*" | "/" as operator, left=left, right=right):
            return (operator, numeric(left, leaf), numeric(right, leaf))
        case Arithmetic(operator=operator):
            cure = "PDDL has `+ - * /`; the runtime plans with all operators"
            raise NotPddl(f"`{operator}` of numbers that change", node.location, cure)
        case _:
            raise NotPddl(f"`{expression_text(node)}`", node.location)


def comparison(node: Compare, leaf: Leaf) -> SExpr:
    """A comparison of numbers.

    Strict ones are negations: a validator in wide use takes `(> f 2)` for true at 2.
    """
    left, right = numeric(node.left, leaf), numeric(node.right, leaf)
    match node.operator:
        case "==":
            return ("=", left, right)
        case "!=":
            return negated(("=", left, right))
        case "<=" | ">=" as operator:
            return (operator, left, right)
        case "<":
            return negated((">=", left, right))
        case ">":
            return negated(("<=", left, right))


def assignment(cell: Expression, value: Expression, leaf: Leaf) -> SExpr | None:
    """A numeric effect as a person writes it; None where the cell keeps its value."""
    assert isinstance(cell, Read)
    written = leaf(cell)
    match value:
        case _ if value is cell:
            return None
        case Arithmetic(operator="+", left=left, right=right) if left is cell:
            return ("increase", written, numeric(right, leaf))
        case Arithmetic(operator="+", left=left, right=right) if right is cell:
            return ("increase", written, numeric(left, leaf))
        case Arithmetic(operator="-", left=left, right=right) if left is cell:
            return ("decrease", written, numeric(right, leaf))
        case _:
            return ("assign", written, numeric(value, leaf))
