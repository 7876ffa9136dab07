"""Triples to PDDL actions: behaviors with the same triple and calls become one (lowering.md §2).

D.6 has seven behaviors for four operators; one action for each of them would cost planners half as
many operators again.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from crow.program import (
    Expression,
    Hierarchy,
    Parameter,
    Program,
    Read,
    Type,
    Variable,
)
from crow.program.names import fresh_name
from crow.program.rewrite import substitute
from crow.program.types import BOOL
from crow.program.walk import subexpressions

from cdlc.backends.pddl.conditions import Lowering, SExpr, atom, condition, typed
from cdlc.backends.pddl.names import Names
from cdlc.ir.hoare import Triple, Update
from cdlc.ir.logic import FALSE, TRUE, conjunction, equality, negation


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


def actions(program: Program, triples: Sequence[Triple], names: Names) -> tuple[Action, ...]:
    """The actions of a program, in the order of their first behaviors. Raises NotPddl."""
    groups: dict[object, list[_Normal]] = {}
    for triple in triples:
        normal = _normalise(program, triple)
        groups.setdefault(normal.key, []).append(normal)
    return tuple(_action(program, group, names) for group in groups.values())


# ---------------------------------------------------------------------------------- normal form


@dataclass(frozen=True, slots=True)
class _Normal:
    """A triple whose variables are named by their places in the controller calls."""

    triple: Triple
    renaming: tuple[tuple[str, str | None], ...]
    key: object


def _normalise(program: Program, triple: Triple) -> _Normal:
    """Rename the variables of a triple so that equal transitions become equal data."""
    order = _order(triple)
    names = _parameter_names(program, triple, order)
    types = {p.name: p.type for p in triple.parameters}
    variables: dict[str, Expression] = {o: Variable(names[o], types[o]) for o in order}
    renamed = replace(
        triple,
        parameters=tuple(Parameter(names[o], types[o]) for o in order),
        calls=tuple(
            replace(call, arguments=_substituted(call.arguments, variables))
            for call in triple.calls
        ),
        pre=_substituted(triple.pre, variables),
        post=tuple(
            replace(
                u,
                arguments=_substituted(u.arguments, variables),
                value=substitute(u.value, variables),
            )
            for u in triple.post
        ),
    )
    renaming = tuple((p.name, names.get(p.name)) for p in triple.parameters)
    return _Normal(renamed, renaming, _key(renamed, Hierarchy.of(program.types)))


def _substituted(
    expressions: tuple[Expression, ...], variables: dict[str, Expression]
) -> tuple[Expression, ...]:
    return tuple(substitute(e, variables) for e in expressions)


def _order(triple: Triple) -> list[str]:
    """The variables the transition depends on: those of the calls first, as they stand there."""
    in_calls = (a for call in triple.calls for a in call.arguments)
    rest = (*triple.pre, *(e for u in triple.post for e in (*u.arguments, u.value)))
    used = dict.fromkeys((*_variables(in_calls), *_variables(rest)))
    called = dict.fromkeys(_variables(a for call in triple.calls for a in call.arguments))
    others = [p.name for p in triple.parameters if p.name in used and p.name not in called]
    return [*called, *others]


def _variables(expressions: Iterable[Expression]) -> Iterator[str]:
    for expression in expressions:
        for part in subexpressions(expression):
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


def _key(triple: Triple, hierarchy: Hierarchy) -> object:
    """What two triples must share to be one action.

    Updates are a set where no two can write one cell; where some can, their order counts.
    """
    post: object = tuple(triple.post)
    if not any(_may_meet(a, b, hierarchy) for a, b in _pairs(triple.post)):
        post = frozenset(triple.post)
    elif all(u.value in (TRUE, FALSE) for u in triple.post):
        post = frozenset((u, _last_wins(u, triple.post, hierarchy)) for u in triple.post)
    return (triple.parameters, triple.calls, frozenset(triple.pre), post)


def _pairs(post: tuple[Update, ...]) -> Iterator[tuple[Update, Update]]:
    for index, earlier in enumerate(post):
        for later in post[index + 1 :]:
            yield earlier, later


def _alias(earlier: Update, later: Update, hierarchy: Hierarchy) -> Expression:
    """When two updates write one cell."""
    if earlier.feature != later.feature:
        return FALSE
    pairs = zip(earlier.arguments, later.arguments, strict=True)
    return conjunction(equality(a, b, hierarchy) for a, b in pairs)


def _may_meet(earlier: Update, later: Update, hierarchy: Hierarchy) -> bool:
    return _alias(earlier, later, hierarchy) != FALSE


def _last_wins(update: Update, post: tuple[Update, ...], hierarchy: Hierarchy) -> frozenset[Update]:
    """The later updates that undo one where they meet it."""
    later = post[post.index(update) + 1 :]
    return frozenset(
        u for u in later if u.value != update.value and _may_meet(update, u, hierarchy)
    )


# --------------------------------------------------------------------------------------- actions


def _action(program: Program, group: list[_Normal], names: Names) -> Action:
    first = group[0].triple
    lowering = Lowering(names, {p.name: f"?{p.name}" for p in first.parameters})
    hierarchy = Hierarchy.of(program.types)
    return Action(
        names.add("action", _name(first, names)),
        first.parameters,
        condition(conjunction(first.pre), lowering),
        tuple(_effects(first.post, lowering, hierarchy)),
        tuple(Source(normal.triple.behavior, normal.renaming) for normal in group),
    )


def _name(triple: Triple, names: Names) -> str:
    """The only controller's name if it is free, else the behavior's."""
    if len(triple.calls) == 1:
        name = triple.calls[0].controller
        if not names.has("action", name):
            return name
    return triple.behavior


def _effects(post: tuple[Update, ...], lowering: Lowering, hierarchy: Hierarchy) -> Iterator[SExpr]:
    """The clauses of an effect: simultaneous, with PDDL's add after delete.

    An earlier update is guarded against a later one in the same cell, except where the later one
    adds: then both fire, and the add wins.
    """
    for index, update in enumerate(post):
        guard = conjunction(
            negation(_alias(update, later, hierarchy))
            for later in post[index + 1 :]
            if later.value != TRUE and later.value != update.value
        )
        cell = atom(Read(update.feature, update.arguments, BOOL), lowering)
        if update.value != FALSE:
            yield from _when(conjunction((guard, update.value)), cell, lowering)
        if update.value != TRUE:
            yield from _when(conjunction((guard, negation(update.value))), ("not", cell), lowering)


def _when(guard: Expression, effect: SExpr, lowering: Lowering) -> Iterator[SExpr]:
    if guard == TRUE:
        yield effect
    elif guard != FALSE:
        yield ("when", condition(guard, lowering), effect)


def parameter_list(action: Action, names: Names) -> tuple[SExpr, ...]:
    """The typed parameters of an action."""
    declared: list[tuple[str, Type]] = [(f"?{p.name}", p.type) for p in action.parameters]
    return typed(declared, names)
