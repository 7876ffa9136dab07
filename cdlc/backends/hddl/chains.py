"""The objects of a type one after another, so that tasks can go through all of them.

HDDL has no task for each object. Static facts name the first and the last object of a type and the
one that follows each, in order of declaration, or say that there is none.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from cdlc.backends.pddl.conditions import type_name, typed
from cdlc.backends.pddl.names import Names
from cdlc.backends.pddl.sexpr import SExpr
from crow.problem import World
from crow.program import ObjectType


@dataclass(frozen=True, slots=True)
class Chain:
    """The predicates of one type's objects."""

    type: ObjectType
    first: str
    next: str
    last: str
    empty: str

    def predicates(self, names: Names) -> Iterator[SExpr]:
        """The predicates with their parameters."""
        for name in (self.first, self.last):
            yield (name, *typed([("?x", self.type)], names))
        yield (self.next, *typed([("?x", self.type), ("?y", self.type)], names))
        yield (self.empty,)

    def facts(self, world: World, names: Names) -> Iterator[SExpr]:
        """What holds in a problem."""
        objects = [names.get("object", name) for name in world.objects_of(self.type)]
        if not objects:
            yield (self.empty,)
            return
        yield (self.first, objects[0])
        for one, other in pairwise(objects):
            yield (self.next, one, other)
        yield (self.last, objects[-1])


def chain_of(type_: ObjectType, names: Names) -> Chain:
    """The chain of a type, its predicates named when they are first asked for."""
    kind = type_name(type_, names)
    first, following, last, empty = (
        names.add("chain", f"{word}'{type_}", f"{word}-{kind}")
        for word in ("first", "next", "last", "no")
    )
    return Chain(type_, first, following, last, empty)
