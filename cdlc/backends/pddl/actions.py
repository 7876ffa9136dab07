"""Triples to PDDL actions: behaviors with the same triple and calls become one (lowering.md §2).

D.6 has seven behaviors for four operators; one action for each of them would cost planners half as
many operators again.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import permutations

from cdlc.backends.pddl.conditions import condition, lowering_of, typed
from cdlc.backends.pddl.costs import Charged, Costs, CostTable, charge_of, table_of
from cdlc.backends.pddl.effects import effects, overruling
from cdlc.backends.pddl.names import Names, imported_name, variable_name
from cdlc.backends.pddl.normal import NormalTriple, normal
from cdlc.backends.pddl.parts import Part
from cdlc.backends.pddl.sexpr import NEVER, NotPddl, SExpr
from cdlc.ir.graph import in_order
from cdlc.ir.hoare import Model
from cdlc.ir.pool import Pool
from cdlc.ir.symbolic import Executor
from crow.program import Expression, Object, Parameter, Program, Read, Type, Variable
from crow.program.triples import Triple, Update
from crow.program.types import is_object


@dataclass(frozen=True, slots=True)
class Chosen:
    """What a variable of a behavior is: a parameter of the action, or always the same object.

    Neither for a variable that the transition does not depend on.
    """

    variable: Parameter
    parameter: str | None = None
    object: str | None = None


@dataclass(frozen=True, slots=True)
class Source:
    """The part of a behavior that an action stands for, and its variables.

    `order` are the variables of the triple that the parameters of the action stand for.
    """

    part: Part
    variables: tuple[Chosen, ...]
    triple: Triple
    order: tuple[str, ...]

    @property
    def behavior(self) -> str:
        """The name of the behavior."""
        return self.part.whole.name


@dataclass(frozen=True, slots=True)
class Action:
    """One PDDL action; `sources` are its behaviors in source order.

    The names of `parameters` are those of PDDL, without the question mark.
    """

    name: str
    parameters: tuple[Parameter, ...]
    precondition: SExpr
    effects: tuple[SExpr, ...]
    sources: tuple[Source, ...]
    table: CostTable | None = None


def normal_forms(model: Model, triples: Sequence[Triple]) -> list[NormalTriple]:
    """The normal forms of a program's triples. Raises NotPddl."""
    for triple in triples:
        _refuse(triple)
    return [normal(triple, model) for triple in triples]


def actions(
    model: Model,
    transitions: Sequence[Charged],
    names: Names,
    costs: Costs,
    parts: Mapping[str, Part],
) -> tuple[Action, ...]:
    """The actions of a program, in the order of their first behaviors; those that can never be
    applied are left out. `parts` are what triples are of, by their names.

    Raises NotPddl.
    """
    groups: list[list[_Ordered]] = []
    alike: dict[object, dict[object, list[_Ordered]]] = {}
    for triple in transitions:
        # Orders are many, so they are tried only where there is something to be equal to.
        index = alike.setdefault(_shape(triple), {})
        orders = _orders(model, triple) if index else iter(())
        found = next((o for o in orders if o.key in index), None)
        if found is not None:
            index[found.key].append(found)
        else:
            first = next(_orders(model, triple))
            index[first.key] = [first]
            groups.append(index[first.key])
    made = (_action(model, group, names, costs, parts) for group in groups)
    return tuple(action for action in made if action is not None)


def _refuse(triple: Triple) -> None:
    for conflict in triple.conflicts:
        construct = f"`{conflict.first.feature}`, which iterations of a `foreach` may write twice,"
        raise NotPddl(construct, conflict.first.location)
    for parameter in triple.parameters:
        if not is_object(parameter.type):
            owner = f"parameter `{parameter.name}` of `{triple.behavior}`"
            raise NotPddl(f"{owner}, of type `{parameter.type}`,", parameter.location)


# ------------------------------------------------------------------------------------ equal triples

# All orders of that many variables besides those of the calls are tried.
_MOST_ORDERED = 5


@dataclass(frozen=True, slots=True)
class _Ordered:
    """A triple with an order of its variables; under the same order equal transitions have equal
    keys.
    """

    charged: Charged
    order: tuple[str, ...]
    key: object

    @property
    def triple(self) -> Triple:
        """The triple in normal form."""
        return self.charged.form.triple


def _orders(model: Model, charged: Charged) -> Iterator[_Ordered]:
    """The orders of the variables the transition depends on, the declared one first.

    Those of the calls come first, as they stand there.
    """
    triple = charged.form.triple
    called = _variables((a for call in triple.calls for a in call.arguments), model.pool)
    formulas = (e for u in triple.post for e in (*u.arguments, u.value, u.guard))
    used = {*called, *_variables((*triple.pre, *formulas), model.pool)}
    others = [p.name for p in triple.parameters if p.name in used and p.name not in called]
    for other in permutations(others) if len(others) <= _MOST_ORDERED else [tuple(others)]:
        order = (*called, *other)
        yield _Ordered(charged, order, _key(model, charged, order))


def _shape(charged: Charged) -> object:
    """What equal triples share whatever the order of their variables."""
    triple = charged.form.triple
    calls = tuple(call.controller for call in triple.calls)
    reads = frozenset(
        part.feature for e in triple.pre for part in in_order(e) if isinstance(part, Read)
    )
    return (calls, reads, len(triple.pre), tuple(sorted(u.feature for u in triple.post)))


def _variables(expressions: Iterable[Expression], pool: Pool) -> tuple[str, ...]:
    """Free variables, each where it first stands."""
    free = pool.free_variables
    return tuple(dict.fromkeys(name for e in expressions for name in sorted(free(e))))


def _key(model: Model, charged: Charged, order: tuple[str, ...]) -> object:
    """What two triples must share to be one action: formulas over the places of variables in the
    order, compared by identity.

    Updates are a set, each with those that overrule it, so that the order of statements that do
    not meet makes no difference.
    """
    pool, executor = model.pool, Executor(model.program, model.pool)
    triple = charged.form.triple
    types = {p.name: p.type for p in triple.parameters}
    places = {name: pool.variable(f"'{i}", types[name]) for i, name in enumerate(order)}
    pre = frozenset(id(pool.substitute(part, places)) for part in triple.pre)
    calls = tuple(
        (c.controller, *(id(pool.substitute(a, places)) for a in c.arguments)) for c in triple.calls
    )
    updates = tuple(_renamed_update(update, pool, places) for update in triple.post)
    post = frozenset(
        (_identity(u), frozenset(map(_identity, overruling(u, updates, executor)))) for u in updates
    )
    cost = (
        charged.cost.constant,
        frozenset((id(pool.substitute(r, places)), f) for r, f in charged.cost.terms),
    )
    return (tuple(types[name] for name in order), calls, pre, post, cost)


def _renamed_update(update: Update, pool: Pool, places: dict[str, Expression]) -> Update:
    """An update over places; its own variables are named by theirs."""
    own = [v for v in update.variables if isinstance(v, Variable)]
    bound = {v.name: pool.variable(f"'q{i}", v.type) for i, v in enumerate(own)}
    values = {**places, **bound}
    return replace(
        update,
        arguments=tuple(pool.substitute(a, values) for a in update.arguments),
        value=pool.substitute(update.value, values),
        guard=pool.substitute(update.guard, values),
        variables=tuple(bound.values()),
    )


def _identity(update: Update) -> tuple[object, ...]:
    formulas = (*update.arguments, update.value, update.guard, *update.variables)
    return (update.feature, *map(id, formulas))


# --------------------------------------------------------------------------------------- actions


def _action(
    model: Model,
    group: list[_Ordered],
    names: Names,
    costs: Costs,
    parts: Mapping[str, Part],
) -> Action | None:
    first = group[0]
    triple = first.triple
    chosen = _parameter_names(model.program, first)
    lowering = lowering_of(model, names, {name: f"?{chosen[name]}" for name in first.order})
    executor = Executor(model.program, model.pool)
    precondition = condition(model.pool.conjunction(triple.pre), lowering)
    if precondition == NEVER:
        return None
    clauses = tuple(effects(triple.post, triple.pre, lowering, executor))
    types = {p.name: p.type for p in triple.parameters}
    name = _name(triple, names, parts)
    name = names.add("action", name, _imported(model.program, name))
    cost = first.charged.cost
    own = [Parameter(n, types[n]) for n in first.order]
    table = table_of(cost, own, name, names, costs)
    charge = charge_of(cost, table, lowering, costs)
    return Action(
        name,
        tuple(Parameter(chosen[name], types[name]) for name in first.order),
        precondition,
        (*clauses, *charge),
        tuple(_source(same, [chosen[name] for name in first.order], parts) for same in group),
        table,
    )


def _source(ordered: _Ordered, parameters: list[str], parts: Mapping[str, Part]) -> Source:
    places = dict(zip(ordered.order, parameters, strict=True))
    form = ordered.charged.form
    variables = tuple(_chosen(v, places, form.fixed) for v in form.variables)
    part = parts[ordered.triple.behavior]
    return Source(part, variables, ordered.triple, ordered.order)


def _chosen(
    variable: Parameter, places: Mapping[str, str], fixed: Mapping[str, Expression]
) -> Chosen:
    match fixed.get(variable.name):
        case Object(name=name):
            return Chosen(variable, object=name)
        case Variable(name=name):
            return Chosen(variable, places.get(name))
        case _:
            return Chosen(variable, places.get(variable.name))


def _parameter_names(program: Program, ordered: _Ordered) -> dict[str, str]:
    """Names of the action's parameters: the controller's own where one call decides them."""
    wanted = {name: name for name in ordered.order}
    calls = ordered.triple.calls
    if len(calls) == 1:
        controller = next(c for c in program.controllers if c.name == calls[0].controller)
        pairs = list(zip(controller.parameters, calls[0].arguments, strict=True))
        wanted |= {a.name: p.name for p, a in reversed(pairs) if isinstance(a, Variable)}
    chosen: dict[str, str] = {}
    for name in ordered.order:
        chosen[name] = variable_name(wanted[name], chosen.values())
    return chosen


def _imported(program: Program, name: str) -> str | None:
    """What the controller of a name was called in the PDDL it was imported from."""
    found = (imported_name(c) for c in program.controllers if c.name == name)
    return next(found, None)


def _name(triple: Triple, names: Names, parts: Mapping[str, Part]) -> str:
    """The only controller's name if it is free, else the behavior's, numbered from the second."""
    if len(triple.calls) == 1:
        name = triple.calls[0].controller
        if not names.has("action", name):
            return name
    name = origin = parts[triple.behavior].whole.name
    number = 1
    while names.has("action", name) or (number > 1 and not names.is_free(name)):
        number += 1
        name = f"{origin}-{number}"
    return name


def parameter_list(action: Action, names: Names) -> tuple[SExpr, ...]:
    """The typed parameters of an action."""
    declared: list[tuple[str, Type]] = [(f"?{p.name}", p.type) for p in action.parameters]
    return typed(declared, names)
