"""Costs of actions: what `minimize` asks for as one `(increase (total-cost) …)` each (§2).

Planners take whole, non-negative, unconditional costs; two increases in one action are silently
one to some. So increments are summed, conditional ones split the transition, fractions are scaled.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import product
from math import lcm

from cdlc.backends.pddl.cases import cases
from cdlc.backends.pddl.conditions import Lowering, atom
from cdlc.backends.pddl.linear import Linear, exact, linear
from cdlc.backends.pddl.names import Names
from cdlc.backends.pddl.normal import NormalTriple, conjuncts
from cdlc.backends.pddl.numbers import number_text
from cdlc.backends.pddl.sexpr import SExpr
from cdlc.ir.behaviors import parts_of
from cdlc.ir.graph import in_order
from cdlc.ir.hoare import Model
from cdlc.ir.pool import Pool
from crow.problem import Problem
from crow.program import Expression, Feature, Object, Parameter, Read, Variable
from crow.program.triples import Triple
from crow.values import default_value


@dataclass(frozen=True, slots=True)
class Costs:
    """How actions are charged: by the increments of some features, weighted, or by their calls.

    With neither they are not. Costs are multiplied by `scale` to be whole.
    """

    weights: Mapping[str, Fraction] = field(default_factory=dict)
    counts_calls: bool = False
    scale: int = 1

    @property
    def are_used(self) -> bool:
        """Whether actions have costs at all."""
        return self.counts_calls or bool(self.weights)


@dataclass(frozen=True, slots=True, eq=False)
class Charged:
    """A transition and what it costs, before scaling."""

    form: NormalTriple
    cost: Linear


def charged(
    model: Model, forms: Iterable[NormalTriple], problem: Problem | None
) -> tuple[list[Charged], Costs]:
    """The transitions with their costs; one whose cost depends on a condition is several.

    Costs are not used where `minimize` is no sum of features that only grow: then it is left to
    planners with numbers.
    """
    known = list(forms)
    if problem is not None and problem.minimize is not None:
        weights = _weights(problem.minimize, model, known, problem)
        if weights is None:
            return [Charged(form, Linear.of(0)) for form in known], Costs()
        made = [c for form in known for c in _split(form, weights, model.pool)]
        return made, Costs(weights, scale=_scale(made, problem))
    calls = {len(form.triple.calls) for form in known}
    counts = bool(calls - {1}) and calls != {0}
    return [Charged(f, Linear.of(len(f.triple.calls))) for f in known], Costs(counts_calls=counts)


@dataclass(frozen=True, slots=True)
class CostTable:
    """A function of some parameters for a cost that is no single number or feature."""

    name: str
    parameters: tuple[Parameter, ...]
    cost: Linear


def table_of(
    cost: Linear, parameters: Iterable[Parameter], action: str, names: Names, costs: Costs
) -> CostTable | None:
    """The table that an action's cost needs; None for a number, or a feature as it stands."""
    if not cost.terms or not costs.are_used or _is_plain(cost, costs):
        return None
    used = {a.name for read, _ in cost.terms for a in read.arguments if isinstance(a, Variable)}
    own = tuple(p for p in parameters if p.name in used)
    return CostTable(names.add("function", f"{action}-cost"), own, cost)


def _is_plain(cost: Linear, costs: Costs) -> bool:
    """Whether a cost is the value of one feature."""
    return not cost.constant and [f for _, f in cost.terms] == [1] and costs.scale == 1


def charge_of(
    cost: Linear, table: CostTable | None, lowering: Lowering, costs: Costs
) -> Iterator[SExpr]:
    """The effect that charges for an action, if it costs anything."""
    amount: SExpr = number_text(cost.constant * costs.scale)
    if table is not None:
        amount = (table.name, *(lowering.variables[p.name] for p in table.parameters))
    elif cost.terms:
        amount = atom(cost.terms[0][0], lowering)
    if costs.are_used and amount != "0":
        yield ("increase", ("total-cost",), amount)


def table_facts(
    table: CostTable, problem: Problem, costs: Costs
) -> Iterator[tuple[tuple[str, ...], int]]:
    """The entries of a table: tuples of objects with what they cost, scaled."""
    features = {f.name: f for f in problem.world.program.features}
    domains = [problem.world.objects_of(p.type) for p in table.parameters]
    for where in product(*domains):
        values = dict(zip((p.name for p in table.parameters), where, strict=True))
        total = table.cost.constant
        for read, factor in table.cost.terms:
            feature = features[read.feature]
            cell = (feature.name, tuple(_object(a, values) for a in read.arguments))
            value = problem.initial.cells.get(cell, default_value(feature.type))
            total += factor * exact(value, feature.type)
        yield where, int(total * costs.scale)


def _object(argument: Expression, values: Mapping[str, str]) -> str:
    match argument:
        case Variable(name=name):
            return values[name]
        case Object(name=name):
            return name
        case _:
            raise AssertionError("arguments of static features are variables and objects")


def _weights(
    minimize: Expression, model: Model, forms: list[NormalTriple], problem: Problem
) -> dict[str, Fraction] | None:
    """The factor of each feature in `minimize`, if all of them only ever grow."""
    wanted = linear(model.formula(minimize))
    if wanted is None:
        return None
    features = {f.name: f for f in problem.world.program.features}
    weights: dict[str, Fraction] = {}
    for read, factor in wanted.terms:
        if read.arguments or factor < 0:
            return None
        weights[read.feature] = factor
    goal = model.formula(problem.goal)
    bodies = [part for f in model.program.functions for part in parts_of(f.body or ())]
    if any(isinstance(p, Read) and p.feature in weights for p in (*in_order(goal), *bodies)):
        return None
    assigned = {u.feature for form in forms for u in form.triple.post}
    for form in forms:
        if not _only_grow(form.triple, weights, model.pool):
            return None
        for part in _split(form, weights, model.pool):
            if not _is_charge(part.cost, assigned, features, problem):
                return None
    return weights if any(name in assigned for name in weights) else None


def _only_grow(triple: Triple, weights: Mapping[str, Fraction], pool: Pool) -> bool:
    """Whether a transition reads these features only to increase them."""
    others: list[Expression] = list(triple.pre)
    for update in triple.post:
        others += update.guard, *update.arguments
        if update.feature not in weights:
            others.append(update.value)
            continue
        if update.variables:
            return False
        for case in cases(pool, (update.value,), (), update.location):
            others += case.tests
            increased = linear(case.values[0])
            if increased is None or increased.factor_of(update.feature) != 1:
                return False
    return not any(isinstance(part, Read) and part.feature in weights for part in in_order(*others))


def _is_charge(
    cost: Linear, assigned: set[str], features: Mapping[str, Feature], problem: Problem
) -> bool:
    """Whether a cost is a sum of non-negative constants and of features that never change."""
    if cost.constant < 0:
        return False
    for read, factor in cost.terms:
        values = _values(features[read.feature], problem)
        if read.feature in assigned or factor < 0 or any(value < 0 for value in values):
            return False
    return True


def _values(feature: Feature, problem: Problem) -> Iterator[Fraction]:
    """The initial values of a numeric feature."""
    default = default_value(feature.type)
    for where in problem.world.cells(feature):
        yield exact(problem.initial.cells.get((feature.name, where), default), feature.type)


def _split(form: NormalTriple, weights: Mapping[str, Fraction], pool: Pool) -> Iterator[Charged]:
    """A transition without its cost features, one for each case of its cost."""
    triple = form.triple
    charges = [u for u in triple.post if u.feature in weights]
    others = tuple(u for u in triple.post if u.feature not in weights)
    cells = [pool.read(u.feature, u.arguments, u.value.type) for u in charges]
    after = tuple(
        pool.choice(u.guard, u.value, cell) for u, cell in zip(charges, cells, strict=True)
    )
    for case in cases(pool, after, triple.pre, triple.location):
        total = Linear.of(0)
        for update, value in zip(charges, case.values, strict=True):
            found = linear(value)
            if found is not None:
                total = total.plus(found.without(update.feature), weights[update.feature])
        pre = conjuncts(pool.conjunction((*triple.pre, *case.tests)), pool)
        yield Charged(replace(form, triple=replace(triple, pre=pre, post=others)), total)


def _scale(made: list[Charged], problem: Problem) -> int:
    """The least number that makes all costs whole."""
    features = {f.name: f for f in problem.world.program.features}
    numbers = [c.cost.constant for c in made]
    for part in made:
        for read, factor in part.cost.terms:
            numbers += [factor * value for value in _values(features[read.feature], problem)]
    return lcm(*(number.denominator for number in numbers))
