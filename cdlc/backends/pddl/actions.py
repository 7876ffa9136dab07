"""Triples to PDDL actions: behaviors with the same triple and calls become one (lowering.md §2).

D.6 has seven behaviors for four operators; one action for each of them would cost planners half as
many operators again.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from cdlc.backends.pddl.conditions import Lowering, NotPddl, SExpr, atom, condition, typed
from cdlc.backends.pddl.names import Names
from cdlc.ir.hoare import Model, Triple
from cdlc.ir.pool import Pool, in_order
from cdlc.ir.symbolic import Executor, Update
from crow.program import BOOL, And, Expression, Parameter, Program, Read, Type, Variable
from crow.program.names import fresh_name


@dataclass(frozen=True, slots=True)
class Source:
    """A behavior an action stands for: its variables by the action's parameter.

    A variable of the behavior that the transition does not depend on has no parameter.
    """

    behavior: str
    variables: tuple[tuple[str, str | None], ...]


@dataclass(frozen=True, slots=True)
class Action:
    """One PDDL action; `sources` are its behaviors in source order."""

    name: str
    parameters: tuple[Parameter, ...]
    precondition: SExpr
    effects: tuple[SExpr, ...]
    sources: tuple[Source, ...]


def actions(model: Model, triples: Sequence[Triple], names: Names) -> tuple[Action, ...]:
    """The actions of a program, in the order of their first behaviors. Raises NotPddl."""
    groups: dict[object, list[_Normal]] = {}
    for triple in triples:
        for conflict in triple.conflicts:
            construct = (
                f"`{conflict.first.feature}`, which iterations of a `foreach` may write twice,"
            )
            raise NotPddl(construct, conflict.first.location)
        normal = _normalise(model, triple)
        groups.setdefault(normal.key, []).append(normal)
    return tuple(_action(model, group, names) for group in groups.values())


# ---------------------------------------------------------------------------------- normal form


@dataclass(frozen=True, slots=True)
class _Normal:
    """A triple whose variables are named by their places in the controller calls."""

    triple: Triple
    renaming: tuple[tuple[str, str | None], ...]
    key: object


def _normalise(model: Model, triple: Triple) -> _Normal:
    """Rename the variables of a triple so that equal transitions become equal data."""
    order = _order(triple)
    names = _parameter_names(model.program, triple, order)
    types = {p.name: p.type for p in triple.parameters}
    pool = model.pool
    variables = {o: pool.variable(names[o], types[o]) for o in order}

    def renamed(node: Expression) -> Expression:
        return pool.substitute(node, variables)

    normal = replace(
        triple,
        parameters=tuple(Parameter(names[o], types[o]) for o in order),
        calls=tuple(
            replace(call, arguments=tuple(map(renamed, call.arguments))) for call in triple.calls
        ),
        pre=tuple(map(renamed, triple.pre)),
        post=tuple(_renamed_update(u, pool, variables) for u in triple.post),
    )
    renaming = tuple((p.name, names.get(p.name)) for p in triple.parameters)
    return _Normal(normal, renaming, _key(normal, Executor(model.program, pool)))


def _renamed_update(update: Update, pool: Pool, variables: dict[str, Expression]) -> Update:
    """An update over the action's variables; its own are named by their places."""
    own = [v for v in update.variables if isinstance(v, Variable)]
    places = {v.name: pool.variable(f"{_base(v)}'q{i}", v.type) for i, v in enumerate(own)}
    values = {**variables, **places}
    return replace(
        update,
        arguments=tuple(pool.substitute(a, values) for a in update.arguments),
        value=pool.substitute(update.value, values),
        guard=pool.substitute(update.guard, values),
        variables=tuple(places.values()),
    )


def _base(variable: Variable) -> str:
    return str(variable.type)[:1].lower()


def _order(triple: Triple) -> list[str]:
    """The variables the transition depends on: those of the calls first, as they stand there."""
    called = dict.fromkeys(_variables(a for call in triple.calls for a in call.arguments))
    formulas = (e for u in triple.post for e in (*u.arguments, u.value, u.guard))
    used = {*called, *_variables((*triple.pre, *formulas))}
    others = [p.name for p in triple.parameters if p.name in used and p.name not in called]
    return [*called, *others]


def _variables(expressions: Iterable[Expression]) -> Iterator[str]:
    for part in in_order(*expressions):
        if isinstance(part, Variable):
            yield part.name


def _parameter_names(program: Program, triple: Triple, order: list[str]) -> dict[str, str]:
    """Names of the action's parameters: the controller's own where one call decides them."""
    chosen: dict[str, str] = {}
    if len(triple.calls) == 1:
        (call,) = triple.calls
        controller = next(c for c in program.controllers if c.name == call.controller)
        for parameter, argument in zip(controller.parameters, call.arguments, strict=True):
            if isinstance(argument, Variable):
                chosen.setdefault(argument.name, parameter.name)
    for name in order:
        if name not in chosen:
            chosen[name] = fresh_name(name, set(chosen.values()))
    return {name: chosen[name] for name in order}


def _key(triple: Triple, executor: Executor) -> object:
    """What two triples must share to be one action; formulas are compared by identity.

    Updates are a set, each with those that overrule it, so that the order of statements that do
    not meet makes no difference.
    """
    calls = tuple((call.controller, *map(id, call.arguments)) for call in triple.calls)
    post = frozenset(
        (_identity(u), frozenset(map(_identity, _overruling(u, triple.post, executor))))
        for u in triple.post
    )
    return (triple.parameters, calls, frozenset(map(id, triple.pre)), post)


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


def _action(model: Model, group: list[_Normal], names: Names) -> Action:
    first = group[0].triple
    lowering = Lowering(names, {p.name: f"?{p.name}" for p in first.parameters})
    executor = Executor(model.program, model.pool)
    return Action(
        names.add("action", _name(first, names)),
        first.parameters,
        condition(model.pool.conjunction(first.pre), lowering),
        tuple(_effects(first.post, lowering, executor)),
        tuple(Source(normal.triple.behavior, normal.renaming) for normal in group),
    )


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
    """The add and the delete of one update.

    An add is needed only where the cell is false before, a delete only where it is true.
    """
    pool = executor.pool
    bound = tuple(Parameter(v.name, v.type) for v in update.variables if isinstance(v, Variable))
    inner = lowering.with_variables(bound)
    cell = pool.read(update.feature, update.arguments, BOOL)
    written = atom(cell, inner) if isinstance(cell, Read) else ()
    known = guard.operands if isinstance(guard, And) else (guard,)
    from_false = pool.given(update.value, (*known, pool.negation(cell)))
    from_true = pool.given(update.value, (*known, cell))
    # Where the cell is true and becomes false, the add must not fire: it would win.
    stays = pool.disjunction((pool.negation(cell), from_true))
    adds = pool.conjunction((guard, from_false, stays))
    deletes = pool.conjunction((guard, pool.negation(from_true)))
    for when, effect in ((adds, written), (deletes, ("not", written))):
        if when is pool.false:
            continue
        clause: SExpr = effect
        if when is not pool.true:
            clause = ("when", condition(when, inner), effect)
        if bound:
            named = [(inner.variables[v.name], v.type) for v in bound]
            clause = ("forall", typed(named, inner.names), clause)
        yield clause


def parameter_list(action: Action, names: Names) -> tuple[SExpr, ...]:
    """The typed parameters of an action."""
    declared: list[tuple[str, Type]] = [(f"?{p.name}", p.type) for p in action.parameters]
    return typed(declared, names)
