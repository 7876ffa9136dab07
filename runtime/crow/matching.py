"""Which behaviors achieve a literal, an equation or a comparison (semantics.md §2, unification)."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import product

from crow.budget import looking
from crow.conditions import MIRRORED, plain
from crow.evaluate import EvaluationError
from crow.problem import World
from crow.program import (
    Apply,
    Behavior,
    Compare,
    Constant,
    Do,
    Expression,
    Not,
    Object,
    ObjectType,
    Parameter,
    Quantified,
    Read,
    Type,
    Variable,
)
from crow.program.dependencies import features_read, features_written
from crow.program.expressions import ComparisonOperator
from crow.program.types import BOOL, is_number, underlying
from crow.program.walk import statements_within
from crow.unknowns import Unknown
from crow.values import Value, ValueRangeError, converted

Evaluate = Callable[[Expression], Value]
"""The value of an expression where a condition stands. May raise EvaluationError."""

Bindings = dict[str, Value]


@dataclass(frozen=True, slots=True)
class Term:
    """A side of a condition: what it reads, at which arguments, and its value if it has one."""

    name: str | None
    arguments: tuple[Value, ...]
    value: Value
    has_value: bool


class Matching:
    """The behaviors of one world by what they achieve."""

    def __init__(self, world: World) -> None:
        self.world = world
        self.goals = [(b, plain(b.goal)) for b in world.program.behaviors if b.goal is not None]
        self._literals: dict[tuple[str, bool], list[tuple[Behavior, tuple[Expression, ...]]]] = {}
        for behavior, goal in self.goals:
            atom = goal.operand if isinstance(goal, Not) else goal
            if isinstance(atom, Read | Apply):
                key = (_name(atom), not isinstance(goal, Not))
                self._literals.setdefault(key, []).append((behavior, atom.arguments))

    def alternatives(
        self, wanted: Expression, evaluate: Evaluate
    ) -> list[tuple[Behavior, tuple[Value, ...]]]:
        """Each behavior that achieves a condition, in source order, with its arguments.

        An object parameter that the goal does not mention is each object of its type. Raises
        EvaluationError when an argument of the condition has no value.
        """
        found = {}
        for behavior, bindings in self._matches(plain(wanted), evaluate):
            for arguments in self._completed(behavior, bindings):
                found[behavior.name, arguments] = (behavior, arguments)
        return list(found.values())

    def _matches(
        self, wanted: Expression, evaluate: Evaluate
    ) -> Iterator[tuple[Behavior, Bindings]]:
        match wanted:
            case Read() | Apply():
                yield from self._literal(wanted, evaluate, positive=True)
            case Not(operand=Read() | Apply() as atom):
                yield from self._literal(atom, evaluate, positive=False)
            case Compare(operator=op, left=left, right=right):
                sides = _term(left, evaluate), _term(right, evaluate)
                for behavior, goal in self.goals:
                    if isinstance(goal, Compare):
                        for bindings in self._equations(goal, op, *sides):
                            yield behavior, bindings
            case _:
                return

    def _literal(
        self, atom: Read | Apply, evaluate: Evaluate, *, positive: bool
    ) -> Iterator[tuple[Behavior, Bindings]]:
        arguments = tuple(map(evaluate, atom.arguments))
        for behavior, patterns in self._literals.get((_name(atom), positive), ()):
            bindings: Bindings = {}
            if self._all(patterns, arguments, bindings):
                yield behavior, bindings

    def _equations(
        self, goal: Compare, op: ComparisonOperator, left: Term, right: Term
    ) -> Iterator[Bindings]:
        """The ways in which a goal is this comparison, as it stands and the other way round."""
        for operator, first, second in ((op, left, right), (MIRRORED[op], right, left)):
            bindings: Bindings = {}
            if (
                goal.operator == operator
                and self._term(goal.left, first, bindings)
                and self._term(goal.right, second, bindings)
            ):
                yield bindings

    def _term(self, pattern: Expression, term: Term, bindings: Bindings) -> bool:
        if isinstance(pattern, Read | Apply):
            return _name(pattern) == term.name and self._all(
                pattern.arguments, term.arguments, bindings
            )
        return term.has_value and self._argument(pattern, term.value, bindings)

    def _all(
        self, patterns: tuple[Expression, ...], values: tuple[Value, ...], bindings: Bindings
    ) -> bool:
        pairs = zip(patterns, values, strict=True)
        return all(self._argument(pattern, value, bindings) for pattern, value in pairs)

    def _argument(self, pattern: Expression, value: Value, bindings: Bindings) -> bool:
        match pattern:
            case Variable(name=name, type=type_):
                fitted = self._fitted(value, type_)
                if fitted is None or (name in bindings and bindings[name] != fitted):
                    return False
                bindings[name] = fitted
                return True
            case Object(name=name):
                return bool(name == value)
            case Constant(value=constant):
                is_bool = isinstance(constant, bool)
                return bool(constant == value) and is_bool == isinstance(value, bool)
            case _:
                return False

    def _fitted(self, value: Value, type_: Type) -> Value | None:
        """A value as a parameter of a type has it; None where it is none of that type."""
        if isinstance(type_, ObjectType):
            return value if self.world.is_of(value, type_) else None
        if type(value) is Unknown:
            return converted(value, type_) if underlying(value.type) == underlying(type_) else None
        if isinstance(value, bool) != (underlying(type_) == BOOL):
            return None
        if is_number(type_) != isinstance(value, int | float) and underlying(type_) != BOOL:
            return None
        try:
            return converted(value, type_)
        except (ValueRangeError, TypeError):
            return None

    def _completed(self, behavior: Behavior, bindings: Bindings) -> Iterator[tuple[Value, ...]]:
        """The arguments of a behavior; what its goal leaves open is each object of its type.

        A value that the goal leaves open is None: it is bound where the body begins.
        """
        choices = [
            (bindings[p.name],) if p.name in bindings else self._open(p)
            for p in behavior.parameters
        ]
        return looking(product(*choices))

    def _open(self, parameter: Parameter) -> tuple[Value, ...]:
        is_object = isinstance(parameter.type, ObjectType)
        return self.world.objects_of(parameter.type) if is_object else (None,)

    # ------------------------------------------------------------------------------ what no goal is

    def writers(self, wanted: Expression) -> tuple[Behavior, ...]:
        """The behaviors whose effects write a feature that a comparison reads."""
        read = features_read(self.world.program, (wanted,))
        return tuple(b for b in self.world.program.behaviors if self.written[b.name] & read)

    @cached_property
    def written(self) -> dict[str, frozenset[str]]:
        """The features that a behavior and the controllers it calls may change."""
        return {b.name: frozenset(self._written(b)) for b in self.world.program.behaviors}

    def _written(self, behavior: Behavior) -> Iterator[str]:
        calls = [s.controller for s in statements_within(behavior.body) if isinstance(s, Do)]
        effects = [behavior.effect, *(self.world.controllers[name].effect for name in calls)]
        for effect in effects:
            yield from features_written(self.world.program, effect or ())

    def applications(
        self, wanted: Expression, evaluate: Evaluate
    ) -> tuple[list[tuple[Behavior, tuple[Value, ...]]], bool]:
        """What may achieve a condition, and whether that is only on the way to it.

        A comparison that no goal is may be reached by any behavior that writes what it reads.
        """
        found = self.alternatives(wanted, evaluate)
        if found or not isinstance(wanted, Compare):
            return found, False
        open_ = (
            behavior
            for behavior in self.writers(wanted)
            if all(isinstance(p.type, ObjectType) for p in behavior.parameters)
        )
        steps = [(b, arguments) for b in open_ for arguments in self._completed(b, {})]
        return steps, True


def _name(atom: Read | Apply) -> str:
    return atom.feature if isinstance(atom, Read) else atom.function


def _term(side: Expression, evaluate: Evaluate) -> Term:
    name, arguments = None, tuple[Value, ...]()
    if isinstance(side, Read | Apply):
        name, arguments = _name(side), tuple(map(evaluate, side.arguments))
    try:
        return Term(name, arguments, evaluate(side), has_value=True)
    except EvaluationError:
        return Term(name, arguments, None, has_value=False)


def instances(world: World, condition: Quantified) -> Iterator[dict[str, Value]]:
    """Each choice of objects for the variables of a quantifier, in order of declaration."""
    names = [v.name for v in condition.variables]
    domains = [world.objects_of(v.type) for v in condition.variables]
    return (dict(zip(names, chosen, strict=True)) for chosen in looking(product(*domains)))
