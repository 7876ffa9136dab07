"""Choices inside terms and numbers, which PDDL has not, as cases: one for each path (§2).

`f if c else g` in a value becomes two cases; each knows the tests on its path, so that later tests
which these decide are no tests any more.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from cdlc.backends.pddl.sexpr import NotPddl
from cdlc.ir.graph import in_order
from cdlc.ir.pool import Pool
from crow.program import And, Compare, Conditional, Constant, Expression, Location, Not, Or
from crow.program.types import is_integer, is_number

MOST_CASES = 256


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """Where all `tests` hold, the expressions are `values`, which hold no choice any more."""

    tests: tuple[Expression, ...]
    values: tuple[Expression, ...]


def cases(
    pool: Pool,
    values: tuple[Expression, ...],
    known: Iterable[Expression] = (),
    location: Location | None = None,
) -> list[Case]:
    """The cases of some expressions where the `known` conditions hold: disjoint, one a path.

    Paths that no number can take are left out. Raises NotPddl for more than 256, naming the
    statement at `location`.
    """
    found: list[Case] = []
    given = Known(pool, tuple(known))
    stack: list[tuple[Known, tuple[Expression, ...], tuple[Expression, ...]]]
    stack = [(given, (), values)]
    while stack:
        facts, tests, current = stack.pop()
        current = tuple(facts.simplified(value) for value in current)
        test = _first_test(current)
        if test is None:
            found.append(Case(tests, current))
            if len(found) > MOST_CASES:
                construct = f"an effect of more than {MOST_CASES} cases"
                raise NotPddl(construct, location)
            continue
        for outcome in (pool.negation(test), test):
            stack.append((facts.with_fact(outcome), (*tests, outcome), current))
    return found


def grouped(pool: Pool, found: list[Case]) -> list[tuple[Expression, tuple[Expression, ...]]]:
    """When each tuple of values comes out: cases of equal values joined, in order."""
    by_values: dict[tuple[int, ...], list[Case]] = {}
    for case in found:
        by_values.setdefault(tuple(map(id, case.values)), []).append(case)
    return [
        (pool.disjunction(pool.conjunction(case.tests) for case in group), group[0].values)
        for group in by_values.values()
    ]


def has_choice(*values: Expression) -> bool:
    """Whether an expression has a choice outside of its quantifiers."""
    return _first_test(values) is not None


def _first_test(values: tuple[Expression, ...]) -> Expression | None:
    """The test of an innermost choice of objects or numbers: it has no such choice within."""
    for node in in_order(*values, into_quantifiers=False):
        if isinstance(node, Conditional):
            return node.condition
    return None


@dataclass(frozen=True, slots=True)
class _Range:
    """What is known of a whole number: bounds, and values it does not have."""

    low: float = float("-inf")
    high: float = float("inf")
    without: frozenset[int] = frozenset()

    def decides(self, operator: str, number: int) -> bool | None:
        """The truth of a comparison, where the range leaves no doubt."""
        match operator:
            case "<=":
                return True if self.high <= number else False if self.low > number else None
            case "<":
                return True if self.high < number else False if self.low >= number else None
            case ">=":
                return True if self.low >= number else False if self.high < number else None
            case ">":
                return True if self.low > number else False if self.high <= number else None
            case _:
                if not self.low <= number <= self.high or number in self.without:
                    return operator == "!="
                is_fixed = self.low == self.high == number
                return (operator == "==") if is_fixed else None

    def narrowed(self, operator: str, number: int) -> "_Range":
        """The range where a comparison holds."""
        low, high, without = self.low, self.high, self.without
        match operator:
            case "<=":
                high = min(high, number)
            case "<":
                high = min(high, number - 1)
            case ">=":
                low = max(low, number)
            case ">":
                low = max(low, number + 1)
            case "==":
                low, high = max(low, number), min(high, number)
            case _:
                without = without | {number}
        return _Range(low, high, without)


_OPPOSITE: Mapping[str, str] = {
    "<=": ">",
    "<": ">=",
    ">=": "<",
    ">": "<=",
    "==": "!=",
    "!=": "==",
}


class Known:
    """Conditions that hold on a path, with what they say about whole numbers."""

    def __init__(
        self,
        pool: Pool,
        facts: tuple[Expression, ...],
        ranges: Mapping[int, _Range] | None = None,
    ) -> None:
        self.pool = pool
        self.facts = facts
        self.ranges: dict[int, _Range] = dict(ranges or {})
        for fact in facts:
            self._learn(fact)

    def with_fact(self, fact: Expression) -> "Known":
        """The same with one more condition."""
        return Known(self.pool, (*self.facts, fact), self.ranges)

    def _learn(self, fact: Expression) -> None:
        match fact:
            case And(operands=operands):
                for operand in operands:
                    self._learn(operand)
            case Not(operand=Or(operands=operands)):
                for operand in operands:
                    self._learn(self.pool.negation(operand))
            case _ if (compared := _comparison(fact)) is not None:
                base, operator, number = compared
                self.ranges[id(base)] = self._range(base).narrowed(operator, number)
            case _:
                pass

    def _range(self, base: Expression) -> _Range:
        return self.ranges.get(id(base), _Range())

    def simplified(self, value: Expression) -> Expression:
        """The expression with what is known put in."""
        pool = self.pool
        parts = [p for f in self.facts for p in _parts(pool, f)]
        value = pool.given(value, parts)

        def decided(node: Expression) -> Expression:
            compared = _comparison(node)
            if compared is None:
                return node
            base, operator, number = compared
            truth = self._range(base).decides(operator, number)
            return node if truth is None else pool.true if truth else pool.false

        return pool.rebuild(value, {}, decided) if self.ranges else value


def _parts(pool: Pool, fact: Expression) -> tuple[Expression, ...]:
    match fact:
        case And(operands=operands):
            return (fact, *operands)
        case Not(operand=Or(operands=operands)):
            return (fact, *map(pool.negation, operands))
        case _:
            return (fact,)


def _comparison(node: Expression) -> tuple[Expression, str, int] | None:
    """`base op number` for a comparison of a whole number with a literal, perhaps negated."""
    match node:
        case Not(operand=Compare() as inner):
            found = _comparison(inner)
            return None if found is None else (found[0], _OPPOSITE[found[1]], found[2])
        case Compare(operator=operator, left=left, right=Constant(value=int(number))) if (
            is_number(left.type) and is_integer(left.type) and not isinstance(number, bool)
        ):
            return left, operator, number
        case _:
            return None
