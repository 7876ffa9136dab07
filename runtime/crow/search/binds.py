"""Object binds: the objects that satisfy a condition, found through indexes where it allows."""

from collections.abc import Callable, Iterable, Iterator
from itertools import product
from typing import TYPE_CHECKING

from crow.budget import looking
from crow.program import And, Bind, Expression, Object, Read, Variable
from crow.program.types import BOOL, underlying
from crow.search.code import Test
from crow.search.expressions import Environment, Slots
from crow.search.points import holds
from crow.search.states import Snapshot
from crow.values import Value

if TYPE_CHECKING:
    from crow.search.compile import Programs

Choices = Callable[[Snapshot, Environment], list[tuple[Value, ...]]]


def candidates(programs: "Programs", node: Bind, test: Test | None, slots: Slots) -> Choices:
    """A function for the tuples of objects that satisfy a bind, in order of declaration.

    Its slots are the last ones in use. A tuple for which the condition has no value is left out.
    """
    names = [v.name for v in node.variables]
    domains = [programs.world.objects_of(v.type) for v in node.variables]
    first = slots[names[0]]
    every = Indexed(programs, node, slots).rows() if test is not None else None

    def choices(state: Snapshot, values: Environment) -> list[tuple[Value, ...]]:
        found: Iterable[tuple[Value, ...]]
        found = looking(product(*domains) if every is None else every(state, values))
        if test is None:
            return list(found)
        before, after = values[:first], values[first + len(names) :]
        return [chosen for chosen in found if holds(test, state, (*before, *chosen, *after))]

    return choices


class Indexed:
    """Finds a true Boolean feature in a condition that bounds the variables of a bind."""

    def __init__(self, programs: "Programs", node: Bind, slots: Slots) -> None:
        self.programs = programs
        self.node = node
        self.slots = slots
        self.names = [v.name for v in node.variables]
        self.domains = [programs.world.objects_of(v.type) for v in node.variables]
        self.ranks = [{o: i for i, o in enumerate(domain)} for domain in self.domains]

    def rows(self) -> Callable[[Snapshot, Environment], list[tuple[Value, ...]]] | None:
        """A function for the tuples of objects that may satisfy the condition, or None."""
        assert self.node.condition is not None
        conjuncts = _conjuncts(self.node.condition)
        reads = [c for c in conjuncts if isinstance(c, Read) and self._is_usable(c)]
        if not reads:
            return None
        # The one with the most variables known before, and then the most variables of its own.
        read = max(reads, key=lambda r: (bool(self._fixed(r)), self._own(r)))
        return self._enumerated(read)

    def _is_usable(self, read: Read) -> bool:
        feature = self.programs.world.features[read.feature]
        plain = all(isinstance(a, Variable | Object) for a in read.arguments)
        return underlying(feature.type) == BOOL and plain and self._own(read) > 0

    def _own(self, read: Read) -> int:
        return len({a.name for a in read.arguments if isinstance(a, Variable)} & set(self.names))

    def _fixed(self, read: Read) -> list[int]:
        """The positions of arguments that are known before the bind."""
        return [
            i
            for i, a in enumerate(read.arguments)
            if isinstance(a, Object) or (isinstance(a, Variable) and a.name not in self.names)
        ]

    def _enumerated(self, read: Read) -> Callable[[Snapshot, Environment], list[tuple[Value, ...]]]:
        feature = read.feature
        fixed = self._fixed(read)
        known = None
        if fixed:
            known = self.programs.compiler.expression(read.arguments[fixed[0]], self.slots)
        places = [self._place(read, name) for name in self.names]

        def rows(state: Snapshot, values: Environment) -> list[tuple[Value, ...]]:
            found = (
                state.store.all_rows(state, feature)
                if known is None
                else state.store.rows(state, feature, fixed[0], known(state, values))
            )
            return self._ordered(found, places)

        return rows

    def _place(self, read: Read, name: str) -> int | None:
        """Where a variable of the bind stands in a feature, if it does."""
        for index, argument in enumerate(read.arguments):
            if isinstance(argument, Variable) and argument.name == name:
                return index
        return None

    def _ordered(
        self, found: Iterator[tuple[str, ...]], places: list[int | None]
    ) -> list[tuple[Value, ...]]:
        """The objects in the arguments found, any for other variables, as they were declared."""
        tuples: set[tuple[Value, ...]] = set()
        known = [place for place in places if place is not None]
        for row in looking(found):
            if len(known) == len(places):
                tuples.add(tuple([row[place] for place in known]))
            else:
                domains = [
                    domain if place is None else (row[place],)
                    for place, domain in zip(places, self.domains, strict=True)
                ]
                tuples.update(looking(product(*domains)))
        ranked = [
            (tuple(ranks[o] for ranks, o in zip(self.ranks, chosen, strict=True)), chosen)
            for chosen in tuples
            if all(o in ranks for ranks, o in zip(self.ranks, chosen, strict=True))
        ]
        ranked.sort()
        return [chosen for _, chosen in ranked]


def _conjuncts(condition: Expression) -> list[Expression]:
    if isinstance(condition, And):
        return [part for operand in condition.operands for part in _conjuncts(operand)]
    return [condition]
