"""The compiled form of behaviors: what the CROW engine runs.

Every instruction is one object of its own, compared by identity; variables are slots of a tuple.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

from crow.program import Behavior, Expression, Location, Parameter, Statement
from crow.search.effects import Effect
from crow.search.expressions import Compiled, Environment, Slots
from crow.search.states import Snapshot
from crow.text import expression_text
from crow.values import Value


@dataclass(slots=True, eq=False)
class Test:
    """A condition with its compiled form and what a trace says of it."""

    holds: Compiled
    condition: Expression
    slots: Slots
    location: Location | None
    _text: str | None = None

    @property
    def text(self) -> str:
        """The condition as CDL writes it."""
        if self._text is None:
            self._text = expression_text(self.condition)
        return self._text


Variables = tuple[tuple[int, ...], tuple[tuple[Value, ...], ...]] | None
"""Slots, and the tuples of objects they range over."""


# ------------------------------------------------------------------------------- what achieves want


@dataclass(slots=True, eq=False)
class AllOf:
    """`and`, or `forall` where `variables` are slots with the objects they range over."""

    test: Test
    parts: "tuple[Wanted, ...]"
    variables: Variables = None
    acts: bool = False


@dataclass(slots=True, eq=False)
class OneOf:
    """`or`, or `exists`."""

    test: Test
    parts: "tuple[Wanted, ...]"
    variables: Variables = None
    acts: bool = False


Alternatives = tuple[tuple[tuple["Code", tuple[Value, ...]], ...], bool]
"""Behaviors with their arguments, and whether these are only steps on the way."""


@dataclass(slots=True, eq=False)
class Atom:
    """A literal, an equation or a comparison; `alternatives` may raise EvaluationError."""

    test: Test
    alternatives: Callable[[Snapshot, Environment], Alternatives]
    acts: bool = False


@dataclass(slots=True, eq=False)
class Opaque:
    """What can only be true already."""

    test: Test
    acts: bool = False


Wanted = AllOf | OneOf | Atom | Opaque
"""A condition; `acts` says that the L of a behavior that may join its M may act."""


# ----------------------------------------------------------------------------------- instructions


@dataclass(slots=True, eq=False)
class AssertOp:
    """`assert`."""

    test: Test
    is_held: bool


@dataclass(slots=True, eq=False)
class AchieveOp:
    """`achieve`: `test` is what is asserted and held afterwards."""

    wanted: Wanted
    test: Test
    is_held: bool


@dataclass(slots=True, eq=False)
class CallOp:
    """A behavior that runs where it stands."""

    behavior: str
    arguments: tuple[Compiled, ...]
    location: Location | None


@dataclass(slots=True, eq=False)
class DoOp:
    """A controller call, with the controller's own effect if it has one."""

    controller: str
    arguments: tuple[Compiled, ...]
    effect: Effect | None
    location: Location | None


@dataclass(slots=True, eq=False)
class BindOp:
    """`bind`: `choices` are the values of its slots that satisfy its condition."""

    slots: tuple[int, ...]
    choices: Callable[[Snapshot, Environment], "list[tuple[Value, ...]]"]
    test: Test | None
    is_held: bool
    statement: Statement


@dataclass(slots=True, eq=False)
class DrawOp:
    """`bind` of values: variables in its slots, of which `test` is a constraint, if it has one.

    The variables may be parameters that the goal does not mention, which calls may have given.
    """

    slots: tuple[int, ...]
    variables: tuple[Parameter, ...]
    test: Test | None
    location: Location | None
    is_parameter: bool = False


@dataclass(slots=True, eq=False)
class LetOp:
    """`let`, and the assignment of a local."""

    slot: int
    value: Compiled
    expression: Expression
    slots: Slots
    location: Location | None


@dataclass(slots=True, eq=False)
class FixOp:
    """Loop variables of a range get their value."""

    slot: int
    value: Value


@dataclass(slots=True, eq=False)
class IfOp:
    """`if`, decided where it stands."""

    test: Test
    then: "Block"
    otherwise: "Block"


@dataclass(slots=True, eq=False)
class SequenceOp:
    """`sequential:`, and the iterations of a range."""

    body: "Block"


@dataclass(slots=True, eq=False)
class AlternativeOp:
    """`alternative:`."""

    body: "Block"


@dataclass(slots=True, eq=False)
class UnorderedOp:
    """`unordered:`, and `foreach`, whose slots get each tuple of `objects`.

    `shared` are the slots of outer variables that its parts assign.
    """

    body: "Block"
    variables: Variables
    shared: tuple[int, ...]
    commits: bool


@dataclass(slots=True, eq=False)
class CommitOp:
    """`commit`."""

    location: Location | None


Op = (
    AssertOp
    | AchieveOp
    | CallOp
    | DoOp
    | BindOp
    | DrawOp
    | LetOp
    | FixOp
    | IfOp
    | SequenceOp
    | AlternativeOp
    | UnorderedOp
    | CommitOp
)
Block = tuple[Op, ...]


@dataclass(slots=True, eq=False)
class Code:
    """A compiled behavior."""

    behavior: Behavior
    has_effect: bool
    max_nested: int | None
    size: int = 0
    left: Block = ()
    middle: Op | None = None
    right: Block = ()
    effect: Effect | None = None
    effect_slots: Slots = field(default_factory=dict)
    bound: tuple[tuple[str, int], ...] = ()
    middle_acts: bool = False
    commits: tuple[bool, bool] = (False, False)
