"""The ways through a body, one for each triple of a behavior, as behaviors that can be run.

The Hoare model makes a triple of every choice of an `alternative` and of every order of an
`unordered` group (cdlc.ir.hoare); the interpreter runs bodies that leave no choice. These are the
bodies, in the order of choices.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import permutations

from cdlc.ir.behaviors import body_of
from cdlc.ir.hoare import MAX_TRIPLES
from crow.program import Achieve, Assert, Behavior, Call, Group, Program, Statement


@dataclass(frozen=True, slots=True)
class Way:
    """A behavior whose body leaves no choice, with those that it calls."""

    behavior: Behavior
    called: tuple[Behavior, ...] = ()


Ways = tuple[Way, ...]
_Ended = tuple[tuple[Statement, ...], tuple[Behavior, ...]]


def ways(program: Program, behavior: Behavior) -> Ways:
    """The ways through a behavior; at most one more than a Hoare model may have triples."""
    behaviors = {b.name: b for b in program.behaviors}
    return tuple(
        Way(replace(behavior, left=body, promotable=None, right=()), called)
        for body, called in _block(body_of(behavior), behaviors)
    )


def ways_of_triples(program: Program, behavior: Behavior, count: int) -> tuple[Ways, ...]:
    """For each of the behavior's triples the ways it may be of.

    Usually one each, in order. Where the model has seen that orders make no difference, there are
    fewer triples than ways; then each triple is tried in all of them.
    """
    found = ways(program, behavior)
    return tuple((way,) for way in found) if len(found) == count else (found,) * count


def _block(statements: tuple[Statement, ...], behaviors: Mapping[str, Behavior]) -> list[_Ended]:
    found: list[_Ended] = [((), ())]
    for statement in statements:
        ends = _statement(statement, behaviors)
        found = [
            ((*body, *more), (*called, *others))
            for body, called in found[: MAX_TRIPLES + 1]
            for more, others in ends
        ]
    return found[: MAX_TRIPLES + 1]


def _statement(node: Statement, behaviors: Mapping[str, Behavior]) -> list[_Ended]:
    match node:
        case Group(order="alternative", body=body):
            return [end for chosen in body for end in _statement(chosen, behaviors)]
        case Group(order="unordered", body=body) if _order_matters(body):
            orders = zip(permutations(body), range(MAX_TRIPLES + 1), strict=False)
            groups = (replace(node, order="sequential", body=o) for o, _ in orders)
            return [end for group in groups for end in _statement(group, behaviors)]
        case Group(body=body):
            return [
                ((replace(node, body=inner),), called) for inner, called in _block(body, behaviors)
            ]
        case Call(behavior=name):
            return [
                _called(node, behaviors[name], index, inner, called)
                for index, (inner, called) in enumerate(_block(body_of(behaviors[name]), behaviors))
            ]
        case _:
            return [((node,), ())]


def _order_matters(body: tuple[Statement, ...]) -> bool:
    """As cdlc.ir.hoare has it."""
    return sum(not isinstance(s, Achieve | Assert) for s in body) > 1


def _called(
    node: Call,
    behavior: Behavior,
    index: int,
    body: tuple[Statement, ...],
    called: tuple[Behavior, ...],
) -> _Ended:
    """A call of one way through a behavior, under a name that cannot be written in CDL."""
    names = ",".join(b.name for b in called)
    name = f"{behavior.name}'{index}({names})"
    way = replace(behavior, name=name, left=body, promotable=None, right=())
    return (replace(node, behavior=name),), (*called, way)
