"""Which constraints clash: those that a conflict came from, without those it does not need."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Final

from crow.constraints.constraint import Conflict, Constraint, Core
from crow.constraints.propagation import Clash, Marker, Propagation
from crow.constraints.store import Requirement, Store
from crow.unknowns import Unknown
from crow.values import Value

if TYPE_CHECKING:
    from crow.constraints.solver import Solutions

_MOST_TRIES: Final = 40
_MOST_CONSTRAINTS: Final = 60
_MOST_NODES: Final = 10_000


def conflict_of(clash: Clash) -> Conflict:
    """The conflict that ended a propagation."""
    return Conflict(clash.reason, lambda: _smallest(clash))


def _smallest(clash: Clash) -> Core:
    """What a clash came from, smaller by leaving out what it does not need."""
    core, values = behind(clash)
    knowledge = clash.run.knowledge
    index = tries = 0
    while index < len(core) and tries < _MOST_TRIES and len(core) > 1:
        tries += 1
        found = _clash(Store(knowledge), (*core[:index], *core[index + 1 :]), values)
        if found is None:
            index += 1
            continue
        smaller, values = behind(found)
        core = tuple(c for c in core if c in smaller)
    return core, values


def _clash(
    empty: Store, constraints: Iterable[Constraint], values: dict[Unknown, Value]
) -> Clash | None:
    run = Propagation(empty)
    try:
        for constraint in constraints:
            run.take(constraint)
        for unknown, value in values.items():
            run.choose(unknown, value)
        run.finished()
    except Clash as clash:
        return clash
    return None


def behind(clash: Clash) -> tuple[tuple[Constraint, ...], dict[Unknown, Value]]:
    """The constraints and the chosen values that a clash came from, in the order they came in."""
    run = clash.run
    found: dict[Requirement, None] = dict.fromkeys(clash.requirements)
    chosen: dict[Unknown, Value] = {}
    pending = list(found)
    seen: set[Unknown] = set()
    while pending:
        requirement = pending.pop()
        for unknown in (*requirement.unknowns, *requirement.parents):
            if unknown in seen or unknown not in run.values:
                continue
            seen.add(unknown)
            origins = run.origins.get(unknown, ())
            if not origins and not isinstance(unknown, Marker):
                chosen[unknown] = run.values.get(unknown)
            for origin in origins:
                if origin not in found:
                    found[origin] = None
                    pending.append(origin)
    ordered = sorted(found, key=lambda r: r.number)
    return tuple({r.source: None for r in ordered}), chosen


def unsolvable_core(solutions: "Solutions") -> Conflict:
    """Constraints without solution, each of which is needed for that as far as it was found out."""
    if solutions.is_proved:
        return Conflict("there is no solution", lambda: _needed(solutions))
    told = "; ".join(sorted(map(str, solutions.cuts)))
    return Conflict(f"no solution was found: {told}", lambda: (tuple(solutions.store.given), {}))


def _needed(solutions: "Solutions") -> Core:
    """The constraints but those without which there is no solution either."""
    from crow.constraints.solver import solved_without

    kept = tuple(solutions.store.given)
    left = _MOST_NODES if len(kept) <= _MOST_CONSTRAINTS else 0
    nodes = 2 * solutions.nodes + 10
    for constraint in kept:
        if left < nodes:
            break
        left -= nodes
        if solved_without(solutions, constraint, kept, nodes) is False:
            kept = tuple(c for c in kept if c is not constraint)
    return kept, {}
