"""Expressions interned: equal ones are one object, compared with `is`."""

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TypeVar

from cdlc.ir.graph import parts
from crow.program import (
    BOOL,
    Apply,
    Constant,
    Expression,
    Hierarchy,
    Location,
    Object,
    Parameter,
    Quantified,
    Read,
    Scalar,
    Type,
    Variable,
    Vector,
)

_E = TypeVar("_E", bound=Expression)


class Level(StrEnum):
    """How far formulas are simplified (lowering.md §1)."""

    NONE = "none"
    BASIC = "basic"
    FULL = "full"


@dataclass
class Nodes:
    """Expressions that nothing simplifies, each once, with what is known of every one of them."""

    hierarchy: Hierarchy
    level: Level = Level.BASIC
    _nodes: dict[tuple[object, ...], Expression] = field(default_factory=dict)
    _free: dict[int, frozenset[str]] = field(default_factory=dict)
    _heights: dict[int, int] = field(default_factory=dict)
    _fresh: int = 0
    _splits: int = 0

    def __post_init__(self) -> None:
        self.true = self.constant(True, BOOL)  # noqa: FBT003 - a value
        self.false = self.constant(False, BOOL)  # noqa: FBT003 - a value

    def __len__(self) -> int:
        return len(self._nodes)

    # ------------------------------------------------------------------------------------- leaves

    def constant(self, value: Scalar, type_: Type, location: Location | None = None) -> Expression:
        """A literal."""
        key = ("constant", type(value), value, type_)
        return self._intern(key, lambda: Constant(value, type_, location=location))

    def variable(self, name: str, type_: Type) -> Expression:
        """A parameter or bound variable."""
        return self._intern(("variable", name, type_), lambda: Variable(name, type_))

    def named_object(self, name: str, type_: Type) -> Expression:
        """An object constant."""
        return self._intern(("object", name, type_), lambda: Object(name, type_))

    def fresh(self, parameter: Parameter) -> Expression:
        """A variable that occurs nowhere yet; its name cannot be written in CDL."""
        self._fresh += 1
        return self.variable(f"{parameter.name}'{self._fresh}", parameter.type)

    # ----------------------------------------------------------------------------------- compound

    def read(
        self,
        feature: str,
        arguments: tuple[Expression, ...],
        type_: Type,
        location: Location | None = None,
    ) -> Expression:
        """The value of a feature before the transition."""
        key = ("read", feature, *map(id, arguments))
        return self._intern(key, lambda: Read(feature, arguments, type_, location=location))

    def apply(
        self,
        function: str,
        arguments: tuple[Expression, ...],
        type_: Type,
        location: Location | None = None,
    ) -> Expression:
        """A call of an external function, uninterpreted."""
        key = ("apply", function, *map(id, arguments))
        return self._intern(key, lambda: Apply(function, arguments, type_, location=location))

    def vector(self, elements: tuple[Expression, ...], type_: Type) -> Expression:
        """A vector of given elements."""
        key = ("vector", type_, *map(id, elements))
        return self._intern(key, lambda: Vector(elements, type_))

    def _intern(self, key: tuple[object, ...], make: Callable[[], _E]) -> Expression:
        node = self._nodes.get(key)
        if node is None:
            node = self._nodes[key] = make()
            self._free[id(node)] = self._free_in(node)
            self._heights[id(node)] = self._height_of(node)
        return node

    def _free_in(self, node: Expression) -> frozenset[str]:
        if isinstance(node, Variable):
            return frozenset((node.name,))
        inside = [self._free[id(part)] for part in parts(node)]
        free = inside[0].union(*inside[1:]) if inside else frozenset()
        return free - {v.name for v in node.variables} if isinstance(node, Quantified) else free

    def _height_of(self, node: Expression) -> int:
        inner = max((self._heights[id(part)] for part in parts(node)), default=0)
        return inner + isinstance(node, Quantified)

    def free_variables(self, node: Expression) -> frozenset[str]:
        """The names of a pooled expression's variables that no quantifier within binds."""
        return self._free[id(node)]
