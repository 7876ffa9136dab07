"""Behaviors that are the same transition (lowering.md §2): equal calls, conditions and effects.

Two triples are compared with the variables of one renamed to those of the other: by their places in
the controller calls, and the rest in every order. z3 decides what the pool has not already made
one.
"""

import time
from collections.abc import Iterator, Sequence
from itertools import permutations

from cdlc.ir.hoare import Model
from cdlc.ir.updates import NotModelled
from cdlc.verify.question import Question
from cdlc.verify.smt.ask import refute
from cdlc.verify.smt.solver import Answer
from crow.program import Expression, Parameter, Variable
from crow.program.triples import Triple, Update

# Variables besides those of the calls, of which every order is tried.
_MOST_ORDERED = 4


def same_transitions(
    model: Model, triples: Sequence[Triple], time_limit: float
) -> tuple[tuple[str, ...], ...]:
    """Groups of behaviors, in source order, whose only triples are equivalent."""
    groups: list[list[Triple]] = []
    for triple in triples:
        for group in groups:
            if _is_same(model, group[0], triple, time_limit):
                group.append(triple)
                break
        else:
            groups.append([triple])
    return tuple(tuple(t.behavior for t in group) for group in groups if len(group) > 1)


def _is_same(model: Model, one: Triple, other: Triple, time_limit: float) -> bool:
    if {u.feature for u in one.post} != {u.feature for u in other.post} or not one.post:
        return False
    deadline = time.monotonic() + time_limit
    return any(
        _is_equivalent(model, one, renamed, deadline) for renamed in _renamings(model, one, other)
    )


def _renamings(model: Model, one: Triple, other: Triple) -> Iterator[Triple]:
    """The other triple over the variables of the one, in every way that makes the calls equal."""
    if [c.controller for c in one.calls] != [c.controller for c in other.calls]:
        return
    if len(one.parameters) != len(other.parameters):
        return
    names: dict[str, str] = {}
    for call, match in zip(other.calls, one.calls, strict=True):
        for argument, wanted in zip(call.arguments, match.arguments, strict=True):
            if isinstance(argument, Variable) and isinstance(wanted, Variable):
                if names.setdefault(argument.name, wanted.name) != wanted.name:
                    return
            elif argument is not wanted:
                return
    if len(set(names.values())) < len(names):
        return
    rest = [p for p in other.parameters if p.name not in names]
    free = [p for p in one.parameters if p.name not in names.values()]
    if len(rest) > _MOST_ORDERED:
        return
    for order in permutations(free):
        whole = {**names, **{a.name: b.name for a, b in zip(rest, order, strict=True)}}
        if _types_fit(one, other, whole):
            yield _renamed(model, other, whole, one.parameters)


def _types_fit(one: Triple, other: Triple, names: dict[str, str]) -> bool:
    types = {p.name: p.type for p in one.parameters}
    return all(types[names[p.name]] == p.type for p in other.parameters)


def _renamed(
    model: Model, triple: Triple, names: dict[str, str], parameters: tuple[Parameter, ...]
) -> Triple:
    pool = model.pool
    types = {p.name: p.type for p in triple.parameters}
    values = {old: pool.variable(new, types[old]) for old, new in names.items()}

    def new(node: Expression) -> Expression:
        return pool.substitute(node, values)

    post = tuple(
        Update(
            u.feature, tuple(map(new, u.arguments)), new(u.value), new(u.guard), u.variables,
            u.location,
        )
        for u in triple.post
    )  # fmt: skip
    return Triple(
        triple.behavior, parameters, triple.goal, triple.calls, tuple(map(new, triple.pre)), post
    )


def _is_equivalent(model: Model, one: Triple, other: Triple, deadline: float) -> bool:
    """Whether two triples over the same variables have equal conditions and equal effects."""
    pool = model.pool
    differences = [
        pool.exclusive(pool.conjunction(one.pre), pool.conjunction(other.pre)),
        *_different_cells(model, one, other),
    ]
    for index, difference in enumerate(differences):
        if difference is pool.false:
            continue
        # The effects need to agree only where the behaviors can be applied.
        assumed = one if index else _without_conditions(one)
        try:
            solved = refute(Question(model, assumed, (difference,), ends=False), deadline)
        except NotModelled:
            return False
        if solved.answer is not Answer.UNSAT:
            return False
    return True


def _without_conditions(triple: Triple) -> Triple:
    return Triple(triple.behavior, triple.parameters, None, (), (), ())


def _different_cells(model: Model, one: Triple, other: Triple) -> Iterator[Expression]:
    """For each feature, that some cell of it differs after the two."""
    pool = model.pool
    features = {f.name: f for f in model.program.features}
    for name in dict.fromkeys(u.feature for u in one.post):
        feature = features[name]
        where = tuple(pool.fresh(p) for p in feature.parameters)
        cell = pool.read(name, where, feature.type)
        try:
            after = [model.weakest_precondition(cell, t) for t in (one, other)]
        except NotModelled:
            yield pool.true
            return
        yield pool.negation(pool.equal(*after))
