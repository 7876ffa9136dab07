"""Level `full`: formulas folded by what is known where they stand, with sympy's normal forms.

Going down a formula, the conditions passed on the way are facts: they decide inner conditions, of
whole numbers also by bounds. Going up, whole numbers become sums in normal form, and connectives of
few parts the smaller of their minimal sums and products. Nothing with floats is reordered, and
nothing that may have no value is evaluated earlier than before. Whole numbers are taken to stay
within their width, as everywhere in the model.

Work is bounded by sizes, never by a clock, so that a program has one text: a formula over a limit
keeps its form of level `basic`, and says so.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from itertools import product
from typing import Final

from cdlc.ir.algebra import Bound, Cube, Sums, TooLarge, minimised
from cdlc.ir.graph import in_order, parts, written_size
from cdlc.ir.pool import Pool
from crow.program import (
    And,
    Apply,
    Arithmetic,
    Compare,
    Conditional,
    Constant,
    Expression,
    Location,
    Negative,
    Not,
    Or,
    Quantified,
    Read,
    Xor,
)
from crow.program.triples import Triple, Update
from crow.program.types import BOOL, is_integer, is_number
from crow.values import default_value

MAX_PARTS: Final = 2_000
MAX_DEPTH: Final = 120
MAX_LIFTED: Final = 16
MAX_MINIMISED: Final = 40
# Minimising takes time exponential in the number of conditions.
MAX_CONDITIONS: Final = 6
# All formulas of a program together; beyond, they stay as they are.
MAX_WORK: Final = 400_000
MAX_ALL_MINIMISED: Final = 400


@dataclass(slots=True)
class Work:
    """How many parts may still be simplified, and how many conditions minimised."""

    left: int = MAX_WORK
    minimisations: int = MAX_ALL_MINIMISED


def simplified(triple: Triple, pool: Pool, work: Work) -> Triple:
    """A triple with every formula simplified, those over the limits marked."""
    pre: list[Expression] = []
    reasons: list[tuple[Location, ...]] = []
    limited: set[int] = set()
    for conjunct, sources in zip(triple.pre, triple.reasons, strict=True):
        found = simplest(conjunct, pool, work)
        for part in _conjuncts(conjunct if found is None else found, pool):
            if found is None:
                limited.add(len(pre))
            pre.append(part)
            reasons.append(sources)
    updates = (_update(update, pool, work) for update in triple.post)
    return replace(
        triple,
        pre=tuple(pre),
        reasons=tuple(reasons),
        limited=frozenset(limited),
        post=tuple(update for update in updates if update.guard is not pool.false),
    )


def simplest(formula: Expression, pool: Pool, work: Work) -> Expression | None:
    """A pooled formula at level `full`; None where that is over the limits."""
    size = written_size(formula)
    if size > min(MAX_PARTS, work.left) or _depth(formula) > MAX_DEPTH:
        return None
    work.left -= size
    try:
        made = _Simplifier(pool, work).simplify(formula, _Facts())
    except (TooLarge, RecursionError):  # the stack of the caller may be nearly full
        return None
    return pool.rebuild(made, {}, _plainly(pool)) if written_size(made) <= MAX_PARTS else None


def _plainly(pool: Pool) -> Callable[[Expression], Expression]:
    """`x <= y` where bounds have given `not x > y`."""

    def written(node: Expression) -> Expression:
        match node:
            case Not(operand=Compare(operator=">", left=left, right=right)) if is_integer(
                left.type
            ) and is_integer(right.type):
                return pool.compare("<=", left, right)
            case _:
                return node

    return written


def _update(update: Update, pool: Pool, work: Work) -> Update:
    """An update with guard, value and arguments simplified."""
    guard = simplest(update.guard, pool, work)
    value = simplest(update.value, pool, work)
    arguments = [simplest(argument, pool, work) for argument in update.arguments]
    return replace(
        update,
        guard=guard or update.guard,
        value=value or update.value,
        arguments=tuple(a or b for a, b in zip(arguments, update.arguments, strict=True)),
        is_limited=None in (guard, value, *arguments),
    )


def _conjuncts(condition: Expression, pool: Pool) -> tuple[Expression, ...]:
    if condition is pool.true:
        return ()
    return condition.operands if isinstance(condition, And) else (condition,)


def _depth(formula: Expression) -> int:
    depths: dict[int, int] = {}
    for node in in_order(formula):
        depths[id(node)] = 1 + max((depths[id(part)] for part in parts(node)), default=0)
    return depths[id(formula)]


@dataclass(frozen=True, slots=True)
class _Facts:
    """What is known: the truth of conditions, and the ends of totals, the lower one excluded."""

    known: dict[int, bool] = field(default_factory=dict)
    ends: dict[object, tuple[int | None, int | None]] = field(default_factory=dict)
    is_possible: bool = True


class _Simplifier:
    """Simplifies one formula."""

    def __init__(self, pool: Pool, work: Work) -> None:
        self.pool = pool
        self.work = work
        self.sums = Sums(pool)
        self.bounds: dict[int, Bound] = {}
        self.minimised = 0

    # ---------------------------------------------------------------------------------- downwards

    def simplify(self, node: Expression, facts: _Facts, *, is_inside: bool = False) -> Expression:
        """A formula where some facts hold; `is_inside` another connective."""
        match node:
            case Not() | And() | Or() | Xor():
                made = self._connective(node, facts)
            case Conditional(type=type_) if type_ == BOOL:
                made = self._choice(node, facts)
            case Conditional():
                return self._choice(node, facts)
            case Quantified(quantifier=quantifier, variables=variables, body=body):
                opened = tuple(self.pool.fresh(v) for v in variables)
                names = {v.name: o for v, o in zip(variables, opened, strict=True)}
                inner = self.simplify(self.pool.substitute(body, names), facts)
                return self._decided(self.pool.quantified(quantifier, opened, inner), facts)
            case _:
                return self._decided(self._plain(node, facts), facts)
        return made if is_inside else self._minimal(made, facts)

    def _connective(self, node: Not | And | Or | Xor, facts: _Facts) -> Expression:
        pool = self.pool
        match node:
            case Not(operand=operand):
                return pool.negation(self.simplify(operand, facts, is_inside=True))
            case Xor(left=left, right=right):
                sides = [self.simplify(side, facts, is_inside=True) for side in (left, right)]
                return pool.exclusive(sides[0], sides[1])
            case And(operands=operands) | Or(operands=operands):
                made = []
                for operand in operands:
                    made.append(self.simplify(operand, facts, is_inside=True))
                    facts = self._assume(facts, made[-1], isinstance(node, And))
                return pool.conjunction(made) if isinstance(node, And) else pool.disjunction(made)

    def _choice(self, node: Conditional, facts: _Facts) -> Expression:
        condition = self.simplify(node.condition, facts, is_inside=node.type == BOOL)
        if condition is self.pool.true:
            return self.simplify(node.then, facts, is_inside=True)
        if condition is self.pool.false:
            return self.simplify(node.otherwise, facts, is_inside=True)
        branches = [
            self.simplify(branch, self._assume(facts, condition, value), is_inside=True)
            for branch, value in ((node.then, True), (node.otherwise, False))
        ]
        return self._folded(condition, branches[0], branches[1], facts)

    def _folded(
        self, condition: Expression, then: Expression, otherwise: Expression, facts: _Facts
    ) -> Expression:
        """A choice; one within it that ends in the same value is joined with it."""
        pool = self.pool
        match then, otherwise:
            case _, Conditional(condition=inner, then=same, otherwise=rest) if same is then:
                joined = pool.disjunction((condition, inner))
                return pool.choice(self._minimal(joined, facts), then, rest)
            case _, Conditional(condition=inner, then=rest, otherwise=same) if same is then:
                joined = pool.disjunction((condition, pool.negation(inner)))
                return pool.choice(self._minimal(joined, facts), then, rest)
            case Conditional(condition=inner, then=rest, otherwise=same), _ if same is otherwise:
                joined = pool.conjunction((condition, inner))
                return pool.choice(self._minimal(joined, facts), rest, otherwise)
            case Conditional(condition=inner, then=same, otherwise=rest), _ if same is otherwise:
                joined = pool.conjunction((condition, pool.negation(inner)))
                return pool.choice(self._minimal(joined, facts), rest, otherwise)
            case _:
                return pool.choice(condition, then, otherwise)

    def _plain(self, node: Expression, facts: _Facts) -> Expression:
        """What is neither connective nor choice, from its simplified parts."""
        done = {id(part): self.simplify(part, facts) for part in parts(node)}
        match node:
            case Arithmetic(left=left, right=right, operator=operator, type=type_):
                sides = done[id(left)], done[id(right)]
                if is_integer(type_):
                    return self._sum(operator, *sides, node, 0)
            case Negative(operand=operand, type=type_) if is_integer(type_):
                return self.sums.expression(self.pool.negative(done[id(operand)], type_))
            case Compare(left=left, right=right, operator=operator):
                return self._comparison(operator, done[id(left)], done[id(right)])
            case _:
                pass
        return self.pool.again(node, done)

    def _sum(
        self, operator: str, left: Expression, right: Expression, node: Arithmetic, depth: int
    ) -> Expression:
        """A sum or product, within the branches of a choice where one side is one."""
        for side, other in ((left, right), (right, left)):
            if isinstance(side, Conditional) and not isinstance(other, Conditional):
                if depth == MAX_LIFTED:
                    break
                ends = side.then, side.otherwise
                sides = [(end, other) if side is left else (other, end) for end in ends]
                then, otherwise = (self._sum(operator, a, b, node, depth + 1) for a, b in sides)
                return self._folded(side.condition, then, otherwise, _Facts())
        again = self.pool.arithmetic(operator, left, right, node.type, node.location)  # type: ignore[arg-type]
        return self.sums.expression(again)

    def _comparison(self, operator: str, left: Expression, right: Expression) -> Expression:
        if not (is_integer(left.type) and is_integer(right.type)):
            return self.pool.compare(operator, left, right)  # type: ignore[arg-type]
        found = self.sums.comparison(operator, left, right)
        if isinstance(found, bool):
            return self.pool.true if found else self.pool.false
        bound, holds = found
        made = self.sums.written(bound, left.type)
        if isinstance(made, Compare):
            self.bounds[id(made)] = bound
        return made if holds else self.pool.negation(made)

    # -------------------------------------------------------------------------------------- facts

    def _decided(self, node: Expression, facts: _Facts) -> Expression:
        """True or false where the facts say so."""
        if node.type != BOOL:
            return node
        plain, is_negated = (node.operand, True) if isinstance(node, Not) else (node, False)
        value = facts.known.get(id(plain))
        bound = self.bounds.get(id(plain))
        if value is None and bound is not None:
            value = _within(bound, *facts.ends.get(bound.total, (None, None)))
        if value is None:
            return node
        return self.pool.true if value is not is_negated else self.pool.false

    def _assume(self, facts: _Facts, condition: Expression, value: bool) -> _Facts:
        """The facts with one more."""
        match condition:
            case Not(operand=operand):
                return self._assume(facts, operand, not value)
            case Constant(value=known):
                return facts if known == value else replace(facts, is_possible=False)
            case And(operands=operands) | Or(operands=operands) if (
                isinstance(condition, And) is value
            ):
                for operand in operands:
                    facts = self._assume(facts, operand, value)
                return facts
            case _:
                return self._learned(facts, condition, value)

    def _learned(self, facts: _Facts, condition: Expression, value: bool) -> _Facts:
        is_possible = facts.is_possible and facts.known.get(id(condition), value) is value
        ends = facts.ends
        bound = self.bounds.get(id(condition))
        if bound is not None:
            low, high = ends.get(bound.total, (None, None))
            is_possible = is_possible and _within(bound, low, high) in (None, value)
            ends = {**ends, bound.total: _narrowed(bound, value, low, high)}
        return _Facts({**facts.known, id(condition): value}, ends, is_possible)

    # ----------------------------------------------------------------------------------- Booleans

    def _minimal(self, node: Expression, facts: _Facts) -> Expression:
        """A connective as the smallest of itself, a minimal sum and a minimal product."""
        conditions = _conditions(node)
        if not 2 <= len(conditions) <= MAX_CONDITIONS or any(map(_may_fail, conditions)):
            return node
        if self.minimised == MAX_MINIMISED or not self.work.minimisations:
            raise TooLarge
        self.minimised += 1
        self.work.minimisations -= 1
        true, free = [], []
        for row in product((0, 1), repeat=len(conditions)):
            values = {id(c): bool(value) for c, value in zip(conditions, row, strict=True)}
            assumed = facts
            for condition in conditions:
                assumed = self._assume(assumed, condition, values[id(condition)])
            if not assumed.is_possible:
                free.append(list(row))
            elif _truth(node, values):
                true.append(list(row))
        positive, negative = minimised(len(conditions), true, free)
        forms = [node, self._sum_of(positive, conditions), self._product_of(negative, conditions)]
        return min(forms, key=written_size)

    def _sum_of(self, cubes: Iterable[Cube], conditions: list[Expression]) -> Expression:
        pool = self.pool
        return pool.disjunction(
            pool.conjunction(self._literal(conditions[i], value) for i, value in cube)
            for cube in cubes
        )

    def _product_of(self, cubes: Iterable[Cube], conditions: list[Expression]) -> Expression:
        """All but what the cubes say."""
        pool = self.pool
        return pool.conjunction(
            pool.disjunction(self._literal(conditions[i], not value) for i, value in cube)
            for cube in cubes
        )

    def _literal(self, condition: Expression, value: bool) -> Expression:
        return condition if value else self.pool.negation(condition)


def _within(bound: Bound, low: int | None, high: int | None) -> bool | None:
    """The truth of a bound for a total above `low` and up to `high`, where these decide it."""
    limit = bound.limit
    if bound.is_equality:
        if (low is not None and limit <= low) or (high is not None and limit > high):
            return False
        return True if low is not None and low + 1 == high == limit else None
    if low is not None and low >= limit:
        return True
    return False if high is not None and high <= limit else None


def _narrowed(
    bound: Bound, value: bool, low: int | None, high: int | None
) -> tuple[int | None, int | None]:
    limit = bound.limit
    if bound.is_equality:
        return (limit - 1, limit) if value else (low, high)
    if value:
        return limit if low is None else max(low, limit), high
    return low, limit if high is None else min(high, limit)


def _conditions(node: Expression) -> list[Expression]:
    """What the connectives of a condition connect, each once."""
    found: dict[int, Expression] = {}
    pending = [node]
    while pending:
        part = pending.pop()
        if _is_connective(part):
            pending.extend(reversed(parts(part)))
        elif not isinstance(part, Constant):
            found[id(part)] = part
    return list(found.values())


def _is_connective(node: Expression) -> bool:
    return isinstance(node, Not | And | Or | Xor) or (
        isinstance(node, Conditional) and node.type == BOOL
    )


def _truth(node: Expression, values: dict[int, bool]) -> bool:
    match node:
        case _ if id(node) in values:
            return values[id(node)]
        case Constant(value=value):
            return bool(value)
        case Not(operand=operand):
            return not _truth(operand, values)
        case And(operands=operands):
            return all(_truth(operand, values) for operand in operands)
        case Or(operands=operands):
            return any(_truth(operand, values) for operand in operands)
        case Xor(left=left, right=right):
            return _truth(left, values) != _truth(right, values)
        case Conditional(condition=condition, then=then, otherwise=otherwise):
            return _truth(then if _truth(condition, values) else otherwise, values)
        case _:
            raise AssertionError("a condition without a truth value")


def _may_fail(condition: Expression) -> bool:
    """Whether a condition may have no value, so that it must not be evaluated before another."""
    for node in in_order(condition):
        match node:
            case Apply():
                return True
            case Read(type=type_) if default_value(type_) is None:
                return True
            case Arithmetic(operator=operator, type=type_) if operator not in "+-*" or not (
                is_number(type_)
            ):
                return True
            case _:
                continue
    return False
