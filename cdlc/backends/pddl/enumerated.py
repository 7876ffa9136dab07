"""Whole numbers with bounds as objects over static tables, for classical planners (`--numeric
enumerate`, lowering.md §4).

`n(x) + 1` is read from a table like any feature with objects as values, so that the old and the new
number become parameters: Fast Downward keeps one variable for each cell.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from typing import cast

from cdlc.backends.pddl.normal import mapped, plain, plain_triple
from cdlc.backends.pddl.sexpr import NotPddl
from cdlc.ir.graph import in_order
from cdlc.ir.hoare import Model
from crow.problem import Cell, Problem, State
from crow.program import (
    BOOL,
    OBJECT,
    And,
    Apply,
    Arithmetic,
    Compare,
    Conditional,
    Constant,
    Expression,
    Feature,
    Location,
    Negative,
    Not,
    ObjectConstant,
    ObjectType,
    Or,
    Parameter,
    Quantified,
    Read,
    Type,
    TypeDefinition,
    Xor,
)
from crow.program.triples import Triple, Update
from crow.program.types import is_integer, is_number

# Names that CDL cannot write, so that they are nobody's.
NUMBER = ObjectType("amount'")
MOST_ENTRIES = 100_000

Range = tuple[int, int]
Compute = Callable[..., int | bool]


@dataclass(frozen=True, slots=True)
class Table:
    """A static feature of numbers, by what it computes."""

    feature: Feature
    compute: Compute


@dataclass
class Enumeration:
    """Formulas over numbers as formulas over objects, and the tables these need."""

    model: Model
    exempt: frozenset[str]
    tables: dict[str, Table] = field(default_factory=dict)
    low: int = 0
    high: int = 0
    _done: dict[int, Expression] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.pool = self.model.pool
        self.features = {f.name: f for f in self.model.program.features}
        for feature in self.features.values():
            if is_number(feature.type) and feature.name not in self.exempt:
                self._cover(self._bounds(feature, feature.location))

    # ------------------------------------------------------------------------------------ ranges

    def _bounds(self, feature: Feature, location: Location | None) -> Range:
        low, high = feature.bounds
        if not is_integer(feature.type) or low is None or high is None:
            construct = f"`{feature.name}` without bounds, with `--numeric enumerate`,"
            cure = f"write `feature [[min=…, max=…]] {feature.name}`, or leave the option out"
            raise NotPddl(construct, location, cure)
        return low, high

    def _cover(self, range_: Range) -> Range:
        self.low, self.high = min(self.low, range_[0]), max(self.high, range_[1])
        return range_

    def _range(self, node: Expression) -> Range:
        """What a number can be; all of it is enumerated."""
        match node:
            case Constant(value=int(value)):
                return self._cover((value, value))
            case Read(feature=name):
                return self._bounds(self.features[name], node.location)
            case Conditional(then=then, otherwise=otherwise):
                ways = self._range(then), self._range(otherwise)
                return min(w[0] for w in ways), max(w[1] for w in ways)
            case Negative(operand=operand):
                low, high = self._range(operand)
                return self._cover((-high, -low))
            case Arithmetic(operator="+" | "-" | "*" as operator, left=left, right=right):
                compute = _OPERATORS[operator]
                ends = [compute(a, b) for a, b in product(self._range(left), self._range(right))]
                return self._cover((min(ends), max(ends)))
            case _:
                raise NotPddl("a number that cannot be enumerated", node.location)

    # --------------------------------------------------------------------------------- formulas

    def formula(self, node: Expression) -> Expression:
        """A pooled expression over objects instead of numbers."""
        if id(node) not in self._done:
            self._done[id(node)] = self._formula(node)
        return self._done[id(node)]

    def _formula(self, node: Expression) -> Expression:
        pool, of = self.pool, self.formula
        match node:
            case _ if is_number(node.type):
                return self._number(node)
            case Compare(left=left) if is_number(left.type):
                return self._comparison(node)
            case Compare(operator=operator, left=left, right=right):
                return pool.compare(operator, of(left), of(right))
            case Not(operand=operand):
                return pool.negation(of(operand))
            case And(operands=operands):
                return pool.conjunction(map(of, operands))
            case Or(operands=operands):
                return pool.disjunction(map(of, operands))
            case Xor(left=left, right=right):
                return pool.exclusive(of(left), of(right))
            case Conditional(condition=test, then=then, otherwise=otherwise):
                return pool.choice(of(test), of(then), of(otherwise))
            case Read(feature=name, arguments=arguments):
                return pool.read(name, tuple(map(of, arguments)), node.type, node.location)
            case Apply(function=name, arguments=arguments):
                return pool.apply(name, tuple(map(of, arguments)), node.type, node.location)
            case Quantified(quantifier=quantifier, variables=variables, body=body):
                opened = {v.name: pool.fresh(v) for v in variables}
                inner = of(pool.substitute(body, opened))
                return pool.quantified(quantifier, tuple(opened.values()), inner)
            case _:
                return node

    def _number(self, node: Expression) -> Expression:
        pool, of = self.pool, self.formula
        self._range(node)
        match node:
            case Constant(value=int(value)):
                return self._literal(value)
            case Read(feature=name, arguments=arguments):
                return pool.read(enumerated_name(name), tuple(map(of, arguments)), NUMBER)
            case Conditional(condition=test, then=then, otherwise=otherwise):
                return pool.choice(of(test), of(then), of(otherwise))
            case Negative(operand=operand):
                return self._table("negative", NUMBER, lambda a: -a, of(operand))
            case Arithmetic(operator=operator, left=left, right=Constant(value=int(k))):
                compute = _OPERATORS[operator]
                name = f"{_WORDS[operator]} {k}".replace("-", "minus ")
                return self._table(name, NUMBER, lambda a: compute(a, k), of(left))
            case Arithmetic(operator=operator, left=left, right=right):
                return self._table(
                    _WORDS[operator], NUMBER, _OPERATORS[operator], of(left), of(right)
                )
            case _:
                raise NotPddl("a number that cannot be enumerated", node.location)

    def _comparison(self, node: Compare) -> Expression:
        pool = self.pool
        match node.operator:
            case "==" | "!=":
                sides = self.formula(node.left), self.formula(node.right)
                return pool.compare(node.operator, *sides)
            case "<=":
                return self._at_most(node.left, node.right)
            case ">=":
                return self._at_most(node.right, node.left)
            case "<":
                return pool.negation(self._at_most(node.right, node.left))
            case ">":
                return pool.negation(self._at_most(node.left, node.right))

    def _at_most(self, left: Expression, right: Expression) -> Expression:
        match left, right:
            case _, Constant(value=int(k)):
                name = f"at most {k}".replace("-", "minus ")
                return self._table(name, BOOL, lambda a: a <= k, self.formula(left))
            case Constant(value=int(k)), _:
                name = f"at least {k}".replace("-", "minus ")
                return self._table(name, BOOL, lambda a: a >= k, self.formula(right))
            case _:
                sides = self.formula(left), self.formula(right)
                return self._table("at most", BOOL, lambda a, b: a <= b, *sides)

    def _literal(self, value: int) -> Expression:
        return self.pool.named_object(number_name(value), NUMBER)

    def _table(self, name: str, type_: Type, compute: Compute, *of: Expression) -> Expression:
        name = f"{name}'"
        parameters = tuple(Parameter(letter, NUMBER) for letter in "ab"[: len(of)])
        self.tables.setdefault(name, Table(Feature(name, parameters, type_), compute))
        return self.pool.read(name, of, type_)

    # ---------------------------------------------------------------------------------- triples

    def triple(self, triple: Triple) -> Triple:
        """A triple over objects instead of numbers."""
        known = plain_triple(triple, self.pool)
        others = tuple(self._update(u) for u in known.post)
        made = mapped(replace(known, post=()), self.pool, self.formula)
        return replace(made, post=others)

    def _update(self, update: Update) -> Update:
        of = self.formula
        arguments, guard = tuple(map(of, update.arguments)), of(update.guard)
        made = replace(update, arguments=arguments, guard=guard)
        if not is_number(update.value.type):
            return replace(made, value=of(update.value))
        if update.feature in self.exempt:
            return replace(made, value=self._kept(update.value))
        return replace(made, feature=enumerated_name(update.feature), value=of(update.value))

    def _kept(self, node: Expression) -> Expression:
        """A cost as the number it is, with the tests of its choices over objects."""
        pool = self.pool
        match node:
            case Conditional(condition=test, then=then, otherwise=otherwise):
                return pool.choice(self.formula(test), self._kept(then), self._kept(otherwise))
            case Arithmetic(operator=operator, left=left, right=right):
                sides = self._kept(left), self._kept(right)
                return pool.arithmetic(operator, *sides, node.type, node.location)
            case _:
                return node

    # ------------------------------------------------------------------------------- the program

    def program_model(self) -> Model:
        """The model over the program in which numbers are objects."""
        program = self.model.program
        numbers = [number_name(n) for n in range(self.low, self.high + 1)]
        features = tuple(
            replace(f, name=enumerated_name(f.name), type=NUMBER)
            if is_number(f.type) and f.name not in self.exempt
            else f
            for f in program.features
        )
        made = Model(
            replace(
                program,
                types=(*program.types, TypeDefinition(NUMBER.name, OBJECT, is_object=True)),
                constants=(*program.constants, *(ObjectConstant(n, NUMBER) for n in numbers)),
                features=(*features, *(t.feature for t in self.tables.values())),
            ),
            self.pool.level,
        )
        made.pool = self.pool
        return made

    def table_cells(self) -> Iterator[tuple[tuple[str, tuple[str, ...]], object]]:
        """The entries of all tables, those of values outside of the range left out."""
        numbers = range(self.low, self.high + 1)
        for name, table in self.tables.items():
            arity = len(table.feature.parameters)
            if len(numbers) ** arity > MOST_ENTRIES:
                raise NotPddl(f"a table of {len(numbers) ** arity:,} numbers", None)
            for where in product(numbers, repeat=arity):
                value = table.compute(*where)
                cell = (name, tuple(map(number_name, where)))
                if value is True:
                    yield cell, True
                elif value is not False and self.low <= value <= self.high:
                    yield cell, number_name(value)


_OPERATORS: Mapping[str, Callable[[int, int], int]] = {
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
}
_WORDS: Mapping[str, str] = {"+": "plus", "-": "minus", "*": "times"}


def enumerated_name(feature: str) -> str:
    """The name of a feature whose numbers are objects."""
    return f"{feature}'"


def number_name(value: int) -> str:
    """The object that a number is."""
    return f"n{value}'" if value >= 0 else f"minus{-value}'"


def costs_of(minimize: Expression | None) -> frozenset[str]:
    """The features of `minimize`, which stay numbers."""
    if minimize is None:
        return frozenset()
    return frozenset(p.feature for p in in_order(minimize) if isinstance(p, Read))


def _ranges_over_all(triples: Sequence[Triple]) -> bool:
    """Whether something ranges over all objects, to which numbers must not be added."""
    updates = [u for t in triples for u in t.post]
    formulas = [p for t in triples for p in t.pre]
    formulas += [e for u in updates for e in (u.guard, u.value)]
    bound = [v for p in in_order(*formulas) if isinstance(p, Quantified) for v in p.variables]
    types = [*(p.type for t in triples for p in t.parameters), *(v.type for v in bound)]
    return OBJECT in (*types, *(v.type for u in updates for v in u.variables))


def enumerated(
    model: Model, triples: Sequence[Triple], problem: Problem | None
) -> tuple[Model, list[Triple], Problem | None]:
    """A program, its triples and a problem with objects instead of numbers.

    Raises NotPddl for a number without bounds, but for those of `minimize`.
    """
    if _ranges_over_all(triples):
        raise NotPddl("a variable of type `object`, with `--numeric enumerate`,", None)
    exempt = costs_of(None if problem is None else problem.minimize)
    enumeration = Enumeration(model, exempt)
    made = [enumeration.triple(triple) for triple in triples]
    if problem is None:
        return enumeration.program_model(), made, None
    goal = enumeration.formula(plain(model.formula(problem.goal), model.pool))
    inside = enumeration.program_model()
    numbers = {c.name: NUMBER for c in inside.program.constants if c.type == NUMBER}
    world = replace(
        problem.world, program=inside.program, objects={**problem.world.objects, **numbers}
    )
    cells = {**dict(_cells(problem, exempt)), **dict(enumeration.table_cells())}
    return inside, made, problem.changed(world=world, goal=goal, initial=State(cells))


def _cells(problem: Problem, exempt: frozenset[str]) -> Iterator[tuple[Cell, object]]:
    """The initial state, its numbers as objects."""
    initial = problem.initial.cells
    for feature in problem.world.program.features:
        is_enumerated = is_number(feature.type) and feature.name not in exempt
        for where in problem.world.cells(feature) if is_enumerated else ():
            value = cast("int", initial.get((feature.name, where), 0))
            yield (enumerated_name(feature.name), where), number_name(value)
        if not is_enumerated:
            yield from ((c, v) for c, v in initial.items() if c[0] == feature.name)
