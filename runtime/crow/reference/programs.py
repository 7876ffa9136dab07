"""Behaviors as partially ordered programs, and the variables of their applications."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import product

from crow.budget import looking
from crow.evaluate import evaluate, holds
from crow.problem import State, World
from crow.program import (
    Behavior,
    Bind,
    Call,
    Expression,
    ForEach,
    ForRange,
    Group,
    If,
    Location,
    Promotable,
    Statement,
)
from crow.program.names import fresh_name
from crow.program.walk import statements_within
from crow.reference.orders import EMPTY, Leaf, Order, Sequence, leaves, sequence, unordered
from crow.values import Value


@dataclass(frozen=True, slots=True, eq=False)
class Application:
    """A behavior applied to arguments; the initial program is one without a behavior.

    `depth` is that of its program, `ancestors` are the behaviors it is applied for, the last of
    them by `cause`.
    """

    behavior: Behavior | None
    arguments: tuple[Value, ...]
    depth: int
    ancestors: tuple[str, ...]
    cause: "Apply | None" = None

    @property
    def has_effect(self) -> bool:
        """Whether conditions of the body are held (semantics.md §2, preconditions)."""
        return self.behavior is not None and self.behavior.effect is not None


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """A block of an application's body; `fixed` are its loop variables."""

    application: Application
    outer: "Frame | None" = None
    fixed: Mapping[str, Value] = field(default_factory=dict)

    def inner(self, fixed: Mapping[str, Value] | None = None) -> "Frame":
        """A block within this one."""
        return Frame(self.application, self, fixed or {})


@dataclass(frozen=True, slots=True)
class Run:
    """A statement to run."""

    statement: Statement
    frame: Frame


@dataclass(frozen=True, slots=True)
class Want:
    """A condition in normal form to achieve in a program of some depth.

    `whole` is what its null refinement asserts, `frame` where its variables are.
    """

    condition: Expression
    frame: Frame
    depth: int
    location: Location | None


@dataclass(frozen=True, slots=True)
class Check:
    """A condition to assert."""

    condition: Expression
    frame: Frame
    location: Location | None


@dataclass(frozen=True, slots=True)
class Apply:
    """A behavior to apply to arguments in a program of some depth, for a condition or by a call.

    `is_step` says that it is only on the way to the condition.
    """

    behavior: Behavior
    arguments: tuple[Value, ...]
    frame: Frame
    depth: int
    cause: Want | Call
    is_step: bool = False


@dataclass(frozen=True, slots=True)
class Finish:
    """The end of a behavior: its effect."""

    application: Application
    frame: Frame


@dataclass(frozen=True, slots=True)
class Undecided:
    """A promotable section whose `if`s are decided when it starts."""

    section: Promotable
    frame: Frame


Values = Mapping[tuple[object, str], Value]
"""The variables of each block, and what is kept about each application."""


def environment(values: Values, frame: Frame | None) -> dict[str, Value]:
    """The variables that a block sees, by name."""
    if frame is None:
        return {}
    own = {name: value for (owner, name), value in values.items() if owner is frame}
    return {**environment(values, frame.outer), **frame.fixed, **own}


def scope_of(values: Values, frame: Frame, name: str) -> Frame:
    """The innermost block around a statement that has a variable of that name."""
    scope: Frame | None = frame
    while scope is not None and (scope, name) not in values:
        scope = scope.outer
    assert scope is not None
    return scope


class Programs:
    """The orders of the statements of one world's behaviors."""

    def __init__(self, world: World) -> None:
        self.world = world

    def sequence(self, statements: tuple[Statement, ...], frame: Frame) -> Iterator[Order]:
        """A block in its order; one for each way to choose in its `alternative` groups."""
        choices = [tuple(self.order(statement, frame)) for statement in statements]
        return map(sequence, product(*choices))

    def order(self, node: Statement, frame: Frame) -> Iterator[Order]:
        """The order of what a statement stands for."""
        match node:
            case Group(order="sequential", body=body):
                yield from self.sequence(body, frame.inner())
            case Group(order="unordered", body=body):
                inner = frame.inner()
                choices = [tuple(self.order(part, inner)) for part in body]
                yield from map(unordered, product(*choices))
            case Group(body=body):
                for chosen in body:
                    yield from self.order(chosen, frame.inner())
            case ForEach():
                blocks = [
                    tuple(self.sequence(node.body, frame.inner(fixed)))
                    for fixed in self._objects(node)
                ]
                yield from map(unordered, product(*blocks))
            case ForRange(variable=variable):
                numbers = range(node.start, node.stop, node.step)
                blocks = [
                    tuple(self.sequence(node.body, frame.inner({variable.name: number})))
                    for number in numbers
                ]
                yield from map(sequence, product(*blocks))
            case _:
                yield Leaf(Run(node, frame))

    def _objects(self, node: ForEach) -> Iterator[dict[str, Value]]:
        names = [v.name for v in node.variables]
        domains = [self.world.objects_of(v.type) for v in node.variables]
        return (dict(zip(names, chosen, strict=True)) for chosen in looking(product(*domains)))

    def started(self, order: Order, state: State, values: Values) -> Iterator[Order]:
        """M when it starts: sections are opened, their `if`s decided here (semantics.md §2).

        May raise EvaluationError.
        """
        match order:
            case Leaf(content=Undecided(section=section, frame=frame)):
                group = Group(section.order, section.members)
                for opened in self.order(group, frame):
                    yield from self._decided(opened, state, values)
            case Leaf():
                yield order
            case _:
                choices = [tuple(self.started(part, state, values)) for part in order.parts]
                yield from map(_maker(order), product(*choices))

    def _decided(self, order: Order, state: State, values: Values) -> Iterator[Order]:
        match order:
            case Leaf(content=Run(statement=If() as node, frame=frame)):
                for block in self.chosen(node, frame, state, values):
                    yield from self._decided(block, state, values)
            case Leaf():
                yield order
            case _:
                choices = [tuple(self._decided(part, state, values)) for part in order.parts]
                yield from map(_maker(order), product(*choices))

    def chosen(self, node: If, frame: Frame, state: State, values: Values) -> Iterator[Order]:
        """The block of an `if` that a state chooses."""
        is_true = holds(self.world, state, node.condition, environment(values, frame))
        return self.sequence(node.then if is_true else node.otherwise, frame.inner())

    def value(self, node: Expression, frame: Frame, state: State, values: Values) -> Value:
        """The value of an expression in a block. May raise EvaluationError."""
        return evaluate(self.world, state, node, environment(values, frame))


def _maker(order: Order) -> Callable[[Iterable[Order]], Order]:
    """What puts the parts of an order together again."""
    return sequence if isinstance(order, Sequence) else unordered


def section_of(behavior: Behavior, frame: Frame) -> Order:
    """The M of a behavior."""
    if behavior.promotable is None:
        return EMPTY
    return Leaf(Undecided(behavior.promotable, frame))


def is_undecided(middle: Order) -> bool:
    """Whether a promotable section in M has not started."""
    return any(isinstance(leaf.content, Undecided) for leaf in leaves(middle))


def bind_names(behavior: Behavior) -> dict[int, tuple[str, ...]]:
    """The names that a plan gives the variables of each `bind`, by the identity of the statement.

    A variable that has the name of another gets a number, as in the Hoare model. Those of a
    `foreach` have as many values as there are objects, and no name.
    """
    names: dict[int, tuple[str, ...]] = {}
    taken = {p.name for p in behavior.parameters}
    repeated = {
        id(inner)
        for loop in statements_within(behavior.body)
        if isinstance(loop, ForEach | ForRange)
        for inner in statements_within(loop.body)
    }
    for statement in statements_within(behavior.body):
        if isinstance(statement, Bind) and id(statement) not in repeated:
            own = []
            for variable in statement.variables:
                own.append(fresh_name(variable.name, taken))
                taken.add(own[-1])
            names[id(statement)] = tuple(own)
    return names
