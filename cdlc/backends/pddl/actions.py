"""Triples to PDDL actions: behaviors with the same triple and calls become one (lowering.md §2).

D.6 has seven behaviors for four operators; one action for each of them would cost planners half as
many operators again.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import permutations

from cdlc.backends.pddl.conditions import (
    ALWAYS,
    NEVER,
    Lowering,
    NotPddl,
    SExpr,
    atom,
    condition,
    typed,
)
from cdlc.backends.pddl.names import Names, variable_name
from cdlc.ir.hoare import Model
from cdlc.ir.pool import Pool
from cdlc.ir.symbolic import Executor
from crow.program import BOOL, And, Expression, Parameter, Program, Read, Type, Variable
from crow.program.triples import Triple, Update
from crow.program.types import is_object


@dataclass(frozen=True, slots=True)
class Source:
    """A behavior an action stands for: its parameters and binds, by the action's parameter.

    One that the transition does not depend on has none.
    """

    behavior: str
    variables: tuple[tuple[Parameter, str | None], ...]


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


def actions(model: Model, triples: Sequence[Triple], names: Names) -> tuple[Action, ...]:
    """The actions of a program, in the order of their first behaviors; those that can never be
    applied are left out. Raises NotPddl.
    """
    groups: list[list[_Ordered]] = []
    index: dict[object, list[_Ordered]] = {}
    for triple in triples:
        _refuse(triple)
        found = next((o for o in _orders(model, triple) if o.key in index), None)
        if found is not None:
            index[found.key].append(found)
        else:
            declared = next(_orders(model, triple))
            index[declared.key] = [declared]
            groups.append(index[declared.key])
    made = (_action(model, group, names) for group in groups)
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

    triple: Triple
    order: tuple[str, ...]
    key: object


def _orders(model: Model, triple: Triple) -> Iterator[_Ordered]:
    """The orders of the variables the transition depends on, the declared one first.

    Those of the calls come first, as they stand there.
    """
    called = _variables((a for call in triple.calls for a in call.arguments), model.pool)
    formulas = (e for u in triple.post for e in (*u.arguments, u.value, u.guard))
    used = {*called, *_variables((*triple.pre, *formulas), model.pool)}
    others = [p.name for p in triple.parameters if p.name in used and p.name not in called]
    for other in permutations(others) if len(others) <= _MOST_ORDERED else [tuple(others)]:
        order = (*called, *other)
        yield _Ordered(triple, order, _key(model, triple, order))


def _variables(expressions: Iterable[Expression], pool: Pool) -> tuple[str, ...]:
    """Free variables, each where it first stands."""
    free = pool.free_variables
    return tuple(dict.fromkeys(name for e in expressions for name in sorted(free(e))))


def _key(model: Model, triple: Triple, order: tuple[str, ...]) -> object:
    """What two triples must share to be one action: formulas over the places of variables in the
    order, compared by identity.

    Updates are a set, each with those that overrule it, so that the order of statements that do
    not meet makes no difference.
    """
    pool, executor = model.pool, Executor(model.program, model.pool)
    types = {p.name: p.type for p in triple.parameters}
    places = {name: pool.variable(f"'{i}", types[name]) for i, name in enumerate(order)}
    pre = frozenset(id(pool.substitute(part, places)) for part in triple.pre)
    calls = tuple(
        (c.controller, *(id(pool.substitute(a, places)) for a in c.arguments)) for c in triple.calls
    )
    updates = tuple(_renamed_update(update, pool, places) for update in triple.post)
    post = frozenset(
        (_identity(u), frozenset(map(_identity, _overruling(u, updates, executor))))
        for u in updates
    )
    return (tuple(types[name] for name in order), calls, pre, post)


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


def _overruling(update: Update, post: tuple[Update, ...], executor: Executor) -> tuple[Update, ...]:
    """The later updates that may put another value into the same cell."""
    later = post[post.index(update) + 1 :]
    return tuple(
        other
        for other in later
        if other.feature == update.feature
        and other.value is not update.value
        and executor.meets(other, update.arguments) is not executor.pool.false
    )


# --------------------------------------------------------------------------------------- actions


def _action(model: Model, group: list[_Ordered], names: Names) -> Action | None:
    first = group[0]
    triple = first.triple
    chosen = _parameter_names(model.program, first)
    lowering = Lowering(names, {name: f"?{chosen[name]}" for name in first.order})
    executor = Executor(model.program, model.pool)
    precondition = condition(model.pool.conjunction(triple.pre), lowering)
    effects = tuple(_effects(triple.post, lowering, executor))
    if precondition == NEVER:
        return None
    types = {p.name: p.type for p in triple.parameters}
    return Action(
        names.add("action", _name(triple, names)),
        tuple(Parameter(chosen[name], types[name]) for name in first.order),
        precondition,
        effects,
        tuple(_source(same, [chosen[name] for name in first.order]) for same in group),
    )


def _source(ordered: _Ordered, parameters: list[str]) -> Source:
    places = dict(zip(ordered.order, parameters, strict=True))
    variables = tuple((p, places.get(p.name)) for p in ordered.triple.parameters)
    return Source(ordered.triple.behavior, variables)


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


def _name(triple: Triple, names: Names) -> str:
    """The only controller's name if it is free, else the behavior's."""
    if len(triple.calls) == 1:
        name = triple.calls[0].controller
        if not names.has("action", name):
            return name
    return triple.behavior


def _effects(post: tuple[Update, ...], lowering: Lowering, executor: Executor) -> Iterator[SExpr]:
    """The clauses of an effect: simultaneous, with PDDL's add after delete.

    An earlier update is guarded against a later one in the same cell, except where the later one
    adds: then both fire, and the add wins.
    """
    pool = executor.pool
    for update in post:
        overruled = [
            pool.negation(executor.meets(other, update.arguments))
            for other in _overruling(update, post, executor)
            if other.value is not pool.true
        ]
        guard = pool.conjunction((update.guard, *overruled))
        yield from _clauses(update, guard, lowering, executor)


def _clauses(
    update: Update, guard: Expression, lowering: Lowering, executor: Executor
) -> Iterator[SExpr]:
    """The add and the delete of one update."""
    pool = executor.pool
    bound = tuple(Parameter(v.name, v.type) for v in update.variables if isinstance(v, Variable))
    inner = lowering.with_variables(bound)
    cell = pool.read(update.feature, update.arguments, BOOL)
    assert isinstance(cell, Read)
    written = atom(cell, inner)
    adds, deletes = _when_written(update, guard, cell, pool)
    for when, effect in ((deletes, ("not", written)), (adds, written)):
        lowered = condition(when, inner)
        if lowered == NEVER:
            continue
        clause: SExpr = effect if lowered == ALWAYS else ("when", lowered, effect)
        if bound:
            named = [(inner.variables[v.name], v.type) for v in bound]
            clause = ("forall", typed(named, inner.names), clause)
        yield clause


def _when_written(
    update: Update, guard: Expression, cell: Expression, pool: Pool
) -> tuple[Expression, Expression]:
    """When an update adds and when it deletes.

    An add is needed only where the cell is false before, a delete only where it is true.
    """
    known = guard.operands if isinstance(guard, And) else (guard,)
    from_false = pool.given(update.value, (*known, pool.negation(cell)))
    from_true = pool.given(update.value, (*known, cell))
    deletes = pool.conjunction((guard, pool.negation(from_true)))
    if from_false is from_true:
        return pool.conjunction((guard, from_true)), deletes
    # Where the cell is true and becomes false, the add must not fire: it would win.
    stays = pool.disjunction((pool.negation(cell), from_true))
    return pool.conjunction((guard, from_false, stays)), deletes


def parameter_list(action: Action, names: Names) -> tuple[SExpr, ...]:
    """The typed parameters of an action."""
    declared: list[tuple[str, Type]] = [(f"?{p.name}", p.type) for p in action.parameters]
    return typed(declared, names)
