"""What sympy computes for `--simplify full`: sums in normal form, and Boolean functions minimised.

The one module that imports sympy, and only when it is used: the import costs half a second. Both
computations are bounded by the size of what they are given.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from itertools import product
from math import gcd
from typing import TYPE_CHECKING, Any, Final

from cdlc.ir.pool import Pool
from crow.program import Arithmetic, Constant, Expression, Negative, Type
from crow.program.types import is_integer

if TYPE_CHECKING:
    from crow.program.expressions import ArithmeticOperator, ComparisonOperator

MAX_ATOMS: Final = 64
MAX_TERMS: Final = 200
MAX_DEGREE: Final = 8


Term = tuple[tuple[int, ...], int]
"""The places of the atoms that are multiplied, each as often as it occurs, and the factor."""


class TooLarge(Exception):  # noqa: N818 - not an error of the program
    """Simplifying a formula would take more than it may."""


@dataclass(frozen=True, slots=True)
class Bound:
    """A comparison of whole numbers: `total > limit`, or `total == limit`.

    `total` are the coefficients of its terms, without common factor, by the atoms of each.
    """

    total: frozenset[Term]
    limit: int
    is_equality: bool


class Sums:
    """Whole numbers of one formula as polynomials over its other parts, the atoms."""

    def __init__(self, pool: Pool) -> None:
        self.pool = pool
        self._ring = _ring()
        self._atoms: list[Expression] = []
        self._places: dict[int, int] = {}
        self._totals: dict[int, Any] = {}

    def expression(self, node: Expression) -> Expression:
        """A whole number in normal form: terms by degree and by when their atoms came up."""
        return self._written(_terms(self._total(node)), node.type)

    def comparison(
        self, operator: str, left: Expression, right: Expression
    ) -> tuple[Bound, bool] | bool:
        """What a comparison of whole numbers says: its truth, or a bound that holds or does not."""
        total = self._total(left) - self._total(right)
        match operator:
            case "==" | "!=":
                found = self._equality(total)
                return found if operator == "==" else _opposite(found)
            case ">":
                return self._positive(total)
            case ">=":
                return self._positive(total + 1)
            case "<":
                return _opposite(self._positive(total + 1))
            case _:
                return _opposite(self._positive(total))

    def written(self, bound: Bound, type_: Type) -> Expression:
        """A bound as a comparison, what is subtracted on its other side."""
        left = [(key, factor) for key, factor in bound.total if factor > 0]
        right = [(key, -factor) for key, factor in bound.total if factor < 0]
        right += [((), bound.limit)] if bound.limit or not right else []
        operator: ComparisonOperator = "==" if bound.is_equality else ">"
        return self.pool.compare(operator, self._written(left, type_), self._written(right, type_))

    def _total(self, node: Expression) -> Any:
        known = self._totals.get(id(node))
        if known is None:
            known = self._totals[id(node)] = self._polynomial(node)
        return known

    def _polynomial(self, node: Expression) -> Any:
        match node:
            case Constant(value=int(value)):
                return self._ring(value)
            case Negative(operand=operand) if is_integer(operand.type):
                return -self._total(operand)
            case Arithmetic(operator="+" | "-" | "*" as operator, left=left, right=right) if (
                is_integer(left.type) and is_integer(right.type)
            ):
                return _bounded(operator, self._total(left), self._total(right))
            case _:
                return self._atom(node)

    def _atom(self, node: Expression) -> Any:
        if id(node) not in self._places:
            if len(self._atoms) == MAX_ATOMS:
                raise TooLarge
            self._places[id(node)] = len(self._atoms)
            self._atoms.append(node)
        return self._ring.gens[self._places[id(node)]]

    def _equality(self, total: Any) -> tuple[Bound, bool] | bool:
        key, factor, constant = self._primitive(total)
        if not key:
            return constant == 0
        if constant % factor:
            return False
        return Bound(key, -constant // factor, is_equality=True), True

    def _positive(self, total: Any) -> tuple[Bound, bool] | bool:
        """What `total > 0` says."""
        key, factor, constant = self._primitive(total)
        if not key:
            return constant > 0
        if factor > 0:  # factor * key + constant > 0
            return Bound(key, -constant // factor, is_equality=False), True
        # key < constant / -factor: it is not above the largest whole number below that
        return Bound(key, (constant - 1) // -factor, is_equality=False), False

    def _primitive(self, total: Any) -> tuple[frozenset[Term], int, int]:
        """A total as `factor * key + constant`; the first term of the key is positive."""
        terms = _terms(total)
        constant = sum(c for key, c in terms if not key)
        others = sorted((term for term in terms if term[0]), key=_order)
        if not others:
            return frozenset(), 1, constant
        factor = gcd(*(c for _, c in others))
        factor = factor if others[0][1] > 0 else -factor
        return frozenset((key, c // factor) for key, c in others), factor, constant

    def _written(self, terms: list[Term], type_: Type) -> Expression:
        """A sum as an expression, a positive term first where there is one."""
        ordered = sorted(terms, key=_order) or [((), 0)]
        first = next((term for term in ordered if term[0] and term[1] > 0), ordered[0])
        made = self._term(*first, type_)
        for key, factor in ordered:
            if key != first[0]:
                operator: ArithmeticOperator = "+" if factor > 0 else "-"
                made = self.pool.arithmetic(
                    operator, made, self._term(key, abs(factor), type_), type_
                )
        return made

    def _term(self, key: tuple[int, ...], factor: int, type_: Type) -> Expression:
        pool = self.pool
        if not key:
            return pool.constant(factor, type_)
        made, *rest = (self._atoms[place] for place in key)
        for atom in rest:
            made = pool.arithmetic("*", made, atom, type_)
        if factor == -1:
            return pool.negative(made, type_)
        if factor == 1:
            return made
        return pool.arithmetic("*", pool.constant(factor, type_), made, type_)


def _bounded(operator: str, left: Any, right: Any) -> Any:
    """A result within the limits; the work of a product is that of its terms."""
    if operator == "*":
        degrees = [max((sum(m) for m in side.monoms()), default=0) for side in (left, right)]
        if len(left) * len(right) > MAX_TERMS or sum(degrees) > MAX_DEGREE:
            raise TooLarge
        return left * right
    if len(left) + len(right) > MAX_TERMS:
        raise TooLarge
    return left + right if operator == "+" else left - right


def _opposite(found: tuple[Bound, bool] | bool) -> tuple[Bound, bool] | bool:
    return not found if isinstance(found, bool) else (found[0], not found[1])


def _terms(total: Any) -> list[Term]:
    return [
        (tuple(place for place, power in enumerate(monomial) for _ in range(power)), int(factor))
        for monomial, factor in total.terms()
    ]


def _order(term: Term) -> tuple[int, tuple[int, ...]]:
    return -len(term[0]), term[0]


@cache
def _ring() -> Any:
    from sympy import ZZ
    from sympy.polys.rings import PolyRing

    return PolyRing([f"x{index}" for index in range(MAX_ATOMS)], ZZ)


# ---------------------------------------------------------------------------------------- Booleans

Cube = tuple[tuple[int, bool], ...]
"""Which variables are true and which false; of the others nothing is said."""


def minimised(
    count: int, true: list[list[int]], free: list[list[int]]
) -> tuple[list[Cube], list[Cube]]:
    """A Boolean function of `count` variables as few products, and its opposite as few products.

    `true` are the rows where it is true, `free` those where its value does not matter.
    """
    from sympy import Symbol
    from sympy.logic import SOPform

    symbols = [Symbol(f"x{index}") for index in range(count)]
    rows = [list(row) for row in product((0, 1), repeat=count)]
    false = [row for row in rows if row not in true and row not in free]
    found = []
    for wanted in (true, false):
        form = SOPform(symbols, wanted, free)
        found.append(sorted(_cubes(form, {s: i for i, s in enumerate(symbols)})))
    return found[0], found[1]


def _cubes(form: Any, places: Mapping[Any, int]) -> Iterator[Cube]:
    from sympy import And, Not, Or, false, true

    for part in form.args if isinstance(form, Or) else (form,):
        if part is false:
            continue
        literals = part.args if isinstance(part, And) else (part,)
        yield tuple(
            sorted(
                (places[literal.args[0]], False)
                if isinstance(literal, Not)
                else (places[literal], True)
                for literal in literals
                if literal is not true
            )
        )
