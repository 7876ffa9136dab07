"""Messages about types."""

from collections.abc import Sequence
from dataclasses import dataclass

from cdlc.diagnostics import Diagnostic, Help, Label, Replacement
from crow.program import STRING, Location, ObjectType, Type


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class WrongArgumentCount(Diagnostic):
    """A call or read with more or fewer arguments than declared.

        feature on(x: block, y: block)
        achieve on(x)

    The label shows the declaration.
    """

    name: str
    expected: int
    found: int
    declared: Location | None
    most: int | None = None

    def message(self) -> str:
        plural = "" if self.expected == 1 and self.most is None else "s"
        wanted = f"{self.expected}" if self.most is None else f"{self.expected} to {self.most}"
        return f"`{self.name}` takes {wanted} argument{plural}, not {self.found}"

    def labels(self) -> tuple[Label, ...]:
        return () if self.declared is None else (Label(self.declared, "declared here"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class WrongArgumentType(Diagnostic):
    """An argument whose type is not that of the parameter.

        controller attach(x: Object)
        do attach(pose)

    An object may be of a more special type than the parameter, never of a more general one.
    """

    name: str
    expected: Type
    found: Type
    declared: Location | None
    fitting: str | None = None

    def message(self) -> str:
        return f"wrong argument type in call of `{self.name}`"

    def label(self) -> str:
        return f"expected `{self.expected}`, found `{self.found}`"

    def labels(self) -> tuple[Label, ...]:
        return () if self.declared is None else (Label(self.declared, "declared here"),)

    def help(self) -> tuple[Help, ...]:
        if self.fitting is None and self.found == STRING and isinstance(self.expected, ObjectType):
            return (Help("objects are written as names, without quotes"),)
        if self.fitting is None:
            return ()
        return (Help(f"did you mean `{self.fitting}`?", Replacement(self.location, self.fitting)),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class WrongType(Diagnostic):
    """A value of another type than its place wants.

        on_table[x] = 1          # a feature of type bool

    An int may stand where a float is wanted, never the reverse; a bool is no number; two value
    typedefs do not convert into each other.
    """

    expected: str
    found: Type
    reason: str = ""
    declared: Location | None = None

    def message(self) -> str:
        return f"expected {self.expected}, found `{self.found}`"

    def labels(self) -> tuple[Label, ...]:
        return () if self.declared is None else (Label(self.declared, "declared here"),)

    def notes(self) -> tuple[str, ...]:
        return (self.reason,) if self.reason else ()


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class NotComparable(Diagnostic):
    """A comparison of values that have nothing to compare.

        x == 1                   # `x` is an object

    Objects compare by `==` and `!=` when one type is a kind of the other; numbers compare with
    numbers, and other values with values of their own type.
    """

    operator: str
    left: Type
    right: Type

    def message(self) -> str:
        return f"`{self.left}` and `{self.right}` do not compare by `{self.operator}`"


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class NotAnObjectType(Diagnostic):
    """A quantifier, `foreach` or `objects:` line over a value type.

        forall p: Pose: …

    There are finitely many objects and endlessly many values. Quantify over an object type.
    """

    type: Type

    def message(self) -> str:
        return f"`{self.type}` is not an object type"

    def label(self) -> str:
        return "only objects can be counted through"


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class ValueIndex(Diagnostic):
    """A feature indexed by a value instead of objects.

        feature level(n: int64) -> float32
        level[count(x) + 1]

    Features are tables over the finitely many objects of a problem, and which cell is read or
    written cannot depend on a computed value (data-obliviousness, Appendix D.1). Introduce an
    object type for the index, or write `f(x) if v == 0 else g(x)` for a few values.
    """

    type: Type
    feature: str | None = None
    declared: Location | None = None

    def message(self) -> str:
        if self.feature is None:
            return f"a feature cannot be indexed by `{self.type}`"
        return f"`{self.feature}` is indexed by objects, not by `{self.type}`"

    def label(self) -> str:
        return "not an object"

    def labels(self) -> tuple[Label, ...]:
        return () if self.declared is None else (Label(self.declared, "declared here"),)

    def notes(self) -> tuple[str, ...]:
        return ("which cell is read cannot depend on a computed value: CDL is data-oblivious",)

    def help(self) -> tuple[Help, ...]:
        return (Help("introduce an object type for what it counts: `typedef T: object`"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class TypeCycle(Diagnostic):
    """A `typedef` that is based on itself.

        typedef a: b
        typedef b: a

    Base one of them on `object`, or on a value type.
    """

    chain: Sequence[str]

    def message(self) -> str:
        return f"type is based on itself: {' → '.join(self.chain)}"


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class UninferableParameter(Diagnostic):
    """A parameter without a type that its uses do not decide.

        behavior r(x):
          eff: pass

    Give the type: `x: block`.
    """

    name: str
    candidates: Sequence[str]

    def message(self) -> str:
        return f"cannot infer the type of `{self.name}`"

    def label(self) -> str:
        if not self.candidates:
            return "no use says what it is"
        return f"its uses want {' and '.join(f'`{c}`' for c in self.candidates)}"

    def help(self) -> tuple[Help, ...]:
        return (Help(f"give its type: `{self.name}: T`"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class MissingType(Diagnostic):
    """A parameter or variable whose type has to be given.

        feature on(x, y: block)

    Only parameters of behaviors and generators are inferred from their use.
    """

    name: str

    def message(self) -> str:
        return f"`{self.name}` has no type"

    def help(self) -> tuple[Help, ...]:
        return (Help(f"write `{self.name}: T`"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class NumberTooLarge(Diagnostic):
    """A literal that its type cannot hold: int64 ends at 2**63 - 1, int32 at 2**31 - 1.

        feature count() -> int32
        init:
          count = 3000000000

    Use a wider type, or a smaller unit.
    """

    bits: int = 64

    def message(self) -> str:
        return f"number does not fit into {self.bits} bits"
