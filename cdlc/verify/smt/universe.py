"""Which objects there are: a few, each known by name, or any number of them.

Over a few objects a quantifier is a conjunction, so z3 decides every question about truth values
and linear numbers, and an answer is a state that can be shown. Over any number it can prove, and
may not come to an end.

An object has a kind: the type it was declared with. Objects without a kind do not exist; they are
there because a sort of z3 is never empty.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from itertools import count, product
from typing import Any

import z3

from cdlc.verify.smt.solver import context
from crow.program import OBJECT, Hierarchy, Type

NO_KIND = -1
# A quantifier over more tuples of objects than this is not written out.
MOST_INSTANCES = 4_096
_NUMBERS = count()


class TooLarge(Exception):  # noqa: N818 - the search stops there, nothing is wrong
    """A quantifier over too many tuples of objects to be written out."""


class Universe(ABC):
    """Objects as one sort of z3, the kind of each, and quantifiers over a type."""

    ctx: Any
    sort: Any

    def __init__(self, hierarchy: Hierarchy, kinds: Sequence[str]) -> None:
        self.hierarchy = hierarchy
        self.kinds = tuple(kinds)
        self.ctx = context()
        # Universes share a context, and sorts of one name in it are one.
        self._number = next(_NUMBERS)

    def _add_kinds(self) -> None:
        self.kind = z3.Function("kind", self.sort, z3.IntSort(self.ctx))

    def _sort_name(self) -> str:
        return f"object:{self._number}"

    def is_of(self, term: Any, type_: Type) -> Any:
        """That an object exists and is of a type."""
        kind = self.kind(term)
        if str(type_) == OBJECT.name:
            return kind != NO_KIND
        below = (i for i, name in enumerate(self.kinds) if self._is_below(name, str(type_)))
        return z3.Or([kind == i for i in below] + [z3.BoolVal(False, self.ctx)])  # noqa: FBT003

    def _is_below(self, name: str, type_: str) -> bool:
        return type_ in self.hierarchy.ancestors(name)

    def _kind_of(self, type_: Type) -> int:
        return self.kinds.index(str(type_))

    def _is_kind(self, term: Any) -> Any:
        kind = self.kind(term)
        return z3.And(kind >= NO_KIND, kind < len(self.kinds))

    @abstractmethod
    def constant(self, name: str) -> Any:
        """An object that every world has."""

    @abstractmethod
    def axioms(self) -> list[Any]:
        """What is true of the objects."""

    @abstractmethod
    def for_all(self, variables: list[Any], types: list[Type], body: Any, pattern: Any) -> Any:
        """`body` for all objects of the types; `pattern`, if any, is a term to instantiate by."""

    def exists(self, variables: list[Any], types: list[Type], body: Any) -> Any:
        """`body` for some objects of the types."""
        return z3.Not(self.for_all(variables, types, z3.Not(body), None))

    def _all_of(self, terms: Sequence[Any], types: list[Type]) -> Any:
        pairs = zip(terms, types, strict=True)
        return z3.And([self.is_of(t, type_) for t, type_ in pairs])


class Few(Universe):
    """The constants and `size` more objects, whose kinds z3 chooses."""

    def __init__(
        self, hierarchy: Hierarchy, kinds: Sequence[str], constants: Mapping[str, Type], size: int
    ) -> None:
        super().__init__(hierarchy, kinds)
        self.constants = constants
        number = self._number
        names = [f"c:{number}:{name}" for name in constants]
        names += [f"o:{number}:{i}" for i in range(size)]
        # A sort has at least one element; this one has no kind.
        self.sort, terms = z3.EnumSort(self._sort_name(), names or [f"n:{number}"], ctx=self.ctx)
        self.terms = list(terms) if names else []
        self.named = dict(zip(constants, terms, strict=False))
        self.others = self.terms[len(constants) :]
        self._nothing = None if names else terms[0]
        self._add_kinds()

    def constant(self, name: str) -> Any:
        """An object that every world has."""
        return self.named[name]

    def axioms(self) -> list[Any]:
        """Constants are of their types; the kinds of the others rise, for they have no names."""
        kind = self.kind
        known = [kind(self.named[n]) == self._kind_of(t) for n, t in self.constants.items()]
        exist = [z3.And(kind(o) >= 0, kind(o) < len(self.kinds)) for o in self.others]
        rise = [kind(a) <= kind(b) for a, b in zip(self.others[:-1], self.others[1:], strict=True)]
        none = [] if self._nothing is None else [kind(self._nothing) == NO_KIND]
        return [*known, *exist, *rise, *none]

    def for_all(self, variables: list[Any], types: list[Type], body: Any, pattern: Any) -> Any:  # noqa: ARG002
        """The conjunction over every tuple of objects."""
        if len(self.terms) ** len(variables) > MOST_INSTANCES:
            raise TooLarge
        instances = [
            z3.Implies(
                self._all_of(chosen, types),
                z3.substitute(body, *zip(variables, chosen, strict=True)),
            )
            for chosen in product(self.terms, repeat=len(variables))
        ]
        return z3.And([*instances, z3.BoolVal(True, self.ctx)])  # noqa: FBT003 - a value


class Unbounded(Universe):
    """Any number of objects: an uninterpreted sort, and quantifiers as z3 has them."""

    def __init__(
        self, hierarchy: Hierarchy, kinds: Sequence[str], constants: Mapping[str, Type]
    ) -> None:
        super().__init__(hierarchy, kinds)
        self.constants = constants
        self.sort = z3.DeclareSort(self._sort_name(), self.ctx)
        self.named = {name: z3.Const(f"c:{name}", self.sort) for name in constants}
        self._add_kinds()

    def constant(self, name: str) -> Any:
        """An object that every world has."""
        return self.named[name]

    def axioms(self) -> list[Any]:
        """Constants differ and are of their types; every object is of one kind or of none."""
        known = [self.kind(self.named[n]) == self._kind_of(t) for n, t in self.constants.items()]
        apart = [z3.Distinct(*self.named.values())] if len(self.named) > 1 else []
        some = z3.Const("any", self.sort)
        kinds = z3.ForAll([some], self._is_kind(some), patterns=[self.kind(some)])
        return [*known, *apart, kinds]

    def for_all(self, variables: list[Any], types: list[Type], body: Any, pattern: Any) -> Any:
        """A quantifier of z3."""
        whole = z3.Implies(self._all_of(variables, types), body)
        patterns = [] if pattern is None else [pattern]
        return z3.ForAll(variables, whole, patterns=patterns)
