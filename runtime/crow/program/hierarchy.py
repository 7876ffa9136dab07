"""The object types as a tree with root `object` (language.md §2)."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from crow.program.definitions import TypeDefinition
from crow.program.types import OBJECT, ObjectType, Type


@dataclass(frozen=True, slots=True)
class Hierarchy:
    """The parent of each object type but `object`."""

    parents: Mapping[str, str]

    @staticmethod
    def of(types: Iterable[TypeDefinition]) -> "Hierarchy":
        """The hierarchy that a program's type definitions make."""
        return Hierarchy({t.name: str(t.base) for t in types if t.is_object})

    def ancestors(self, name: str) -> tuple[str, ...]:
        """The type itself, its parent, and so on up to `object`."""
        chain = [name]
        while (name := self.parents.get(name, OBJECT.name)) not in chain:
            chain.append(name)
        return tuple(chain)

    def is_subtype(self, lower: Type, upper: Type) -> bool:
        """Whether every object of the first type is one of the second; false of value types."""
        match lower, upper:
            case ObjectType(name), ObjectType(other):
                return other in self.ancestors(name)
            case _:
                return False

    def may_share_objects(self, left: Type, right: Type) -> bool:
        """Whether one object can be of both types: one is a kind of the other."""
        return self.is_subtype(left, right) or self.is_subtype(right, left)
