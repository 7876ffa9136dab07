"""Simultaneous effects of PDDL as the statements of an `eff:`, which run one after another.

What a statement reads must still be as it was before: conditions that could change are remembered
first, and loops stand in an order in which none reads what an earlier one wrote. Where PDDL adds
and deletes a fact, it is added.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from graphlib import CycleError, TopologicalSorter

from cdlc.frontend.pddl.analysis import Patterns, atoms, renamed, renamed_number
from cdlc.frontend.pddl.nodes import TRUE, Atom, Effect, Quantified, Typed


class EffectsConflictError(Exception):
    """No order of the statements means what the simultaneous effects mean."""


@dataclass(frozen=True, slots=True)
class Block:
    """Effects that one loop carries out, or none where `variables` is empty; deletes first."""

    variables: tuple[Typed, ...]
    effects: tuple[Effect, ...]

    @property
    def reads(self) -> list[Atom]:
        """What a loop reads while it runs; what plain effects read is remembered before."""
        return list(reads_of(self.effects)) if self.variables else []

    @property
    def writes(self) -> list[Atom]:
        """What it changes."""
        return [e.cell for e in self.effects]

    @property
    def deletes(self) -> list[Atom]:
        """What it makes false."""
        return [e.cell for e in self.effects if e.value is False]

    @property
    def adds(self) -> list[Atom]:
        """What it makes true, and the numbers it changes."""
        return [e.cell for e in self.effects if e.value is not False]


def reads_of(effects: Iterable[Effect]) -> Iterator[Atom]:
    """What the conditions and values of effects read."""
    for effect in effects:
        yield from atoms(effect.condition)
        if not isinstance(effect.value, bool):
            yield from atoms(effect.value)


def one_a_cell(effects: tuple[Effect, ...]) -> tuple[Effect, ...]:
    """The effects with only those variables that tell cells apart.

    `for all y where c(x, y), not p(x)` becomes `for all x where some y has c(x, y)`. Then two
    iterations of a loop write different cells.
    """
    return tuple(_one_a_cell(effect, index) for index, effect in enumerate(effects, 2))


def _one_a_cell(effect: Effect, index: int) -> Effect:
    others = tuple(v for v in effect.variables if v.name not in effect.cell.arguments)
    if not others:
        return effect
    own = tuple(v for v in effect.variables if v not in others)
    if effect.condition == TRUE:
        return replace(effect, variables=own)
    # The other effects of one `forall` share the variables, which may be theirs to loop over.
    fresh = {v.name: f"{v.name}'{index}" for v in others}
    condition = renamed(effect.condition, fresh)
    inner = tuple(Typed(fresh[v.name], v.type) for v in others)
    return replace(effect, variables=own, condition=Quantified("exists", inner, condition))


def blocks(effects: tuple[Effect, ...], patterns: Patterns) -> tuple[Block, ...]:
    """The effects in an order in which running them equals PDDL's simultaneous assignment.

    Raises EffectsConflictError where there is none.
    """
    made = list(_blocks(effects))
    after: dict[int, set[int]] = {index: set() for index in range(len(made))}
    for i, first in enumerate(made):
        for j, second in enumerate(made):
            # A delete comes before an add, and who reads before who writes.
            if i != j and (
                patterns.may_meet(first.deletes, second.adds)
                or patterns.may_meet(first.reads, second.writes)
            ):
                after[j].add(i)
    try:
        return tuple(made[index] for index in TopologicalSorter(after).static_order())
    except CycleError:
        raise EffectsConflictError from None


def _blocks(effects: tuple[Effect, ...]) -> Iterator[Block]:
    plain = [e for e in effects if not e.variables]
    yield from _block((), [e for e in plain if e.value is False])
    groups: dict[tuple[str, ...], list[Effect]] = {}
    for effect in effects:
        if effect.variables:
            groups.setdefault(tuple(v.type for v in effect.variables), []).append(effect)
    for grouped in groups.values():
        variables = grouped[0].variables
        shared = [_with_variables(effect, variables) for effect in grouped]
        deletes = [e for e in shared if e.value is False]
        others = [e for e in shared if e.value is not False]
        if _may_clash(deletes, others, {v.name for v in variables}):
            yield from _block(variables, deletes)
            yield from _block(variables, others)
        else:
            yield from _block(variables, [*deletes, *others])
    yield from _block((), [e for e in plain if e.value is not False])


def _block(variables: tuple[Typed, ...], effects: list[Effect]) -> Iterator[Block]:
    if effects:
        yield Block(variables, tuple(effects))


def _with_variables(effect: Effect, variables: tuple[Typed, ...]) -> Effect:
    """The effect with the variables of its group in place of its own."""
    pairs = zip(effect.variables, variables, strict=True)
    names = {own.name: shared.name for own, shared in pairs}
    cell = Atom(effect.cell.name, tuple(names.get(a, a) for a in effect.cell.arguments))
    value = effect.value
    return replace(
        effect,
        variables=variables,
        condition=renamed(effect.condition, names),
        cell=cell,
        value=value if isinstance(value, bool) else renamed_number(value, names),
    )


def _may_clash(deletes: list[Effect], others: list[Effect], names: set[str]) -> bool:
    """Whether one iteration may add the very fact that another deletes."""
    for first in deletes:
        for second in others:
            if first.cell.name != second.cell.name:
                continue
            pairs = zip(first.cell.arguments, second.cell.arguments, strict=True)
            if not names <= {a for a, b in pairs if a == b}:
                return True
    return False
