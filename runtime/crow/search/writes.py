"""What the refinements of a condition may write, within a depth: an upper bound, on patterns.

A pattern is a feature with arguments, of which None stands for any object, and the truth value that
is written, or None. Bound variables may be any object; states play no part, so it is computed once.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final

from crow.conditions import Wanted, plain
from crow.matching import Matching
from crow.problem import World
from crow.program import (
    Achieve,
    And,
    Apply,
    Assign,
    Behavior,
    Call,
    Compare,
    Constant,
    Do,
    Expression,
    Not,
    Object,
    Or,
    Quantified,
    Read,
    Simulate,
    Statement,
    Variable,
)
from crow.program.walk import statements_within
from crow.values import Value

Pattern = tuple[Value, ...]
Names = Mapping[str, Value]
"""The variables whose values are known."""

Writes = Mapping[str, frozenset[tuple[Pattern, bool | None]]]
"""Patterns by feature."""

NO_WRITES: Final[Writes] = {}
MOST_DEPTH: Final = 8
"""Beyond this, everything may be written."""


@dataclass(frozen=True, slots=True)
class Literal:
    """A Boolean cell that is wanted true or false."""

    feature: str
    arguments: Pattern
    value: bool


class Writers:
    """The bounds of one world, remembered."""

    def __init__(self, world: World, conditions: Wanted, matching: Matching) -> None:
        self.world = world
        self.conditions = conditions
        self.matching = matching
        self._known: dict[tuple[str, Pattern, int], Writes] = {}

    @cached_property
    def everything(self) -> Writes:
        """Any write at all."""
        return {
            f.name: frozenset(((tuple(None for _ in f.parameters), None),))
            for f in self.world.program.features
        }

    def condition(self, condition: Expression, names: Names, depth: int) -> Writes:
        """What achieving a condition in normal form may write within a depth."""
        if depth < 1:
            return NO_WRITES
        found: dict[str, set[tuple[Pattern, bool | None]]] = {}
        for behavior, arguments in self._applications(condition, names):
            _add(found, self.behavior(behavior, arguments, depth))
        return _frozen(found)

    def behavior(self, behavior: Behavior, arguments: Pattern, depth: int) -> Writes:
        """What a behavior may write that is applied at one of the next `depth` levels."""
        if depth < 1:
            return NO_WRITES
        if depth > MOST_DEPTH:
            return self.everything
        key = (behavior.name, arguments, depth)
        if key not in self._known:
            found: dict[str, set[tuple[Pattern, bool | None]]] = {}
            names = dict(zip((p.name for p in behavior.parameters), arguments, strict=True))
            _add(found, self.body(behavior.body, names, depth - 1))
            _add(found, self.effect(behavior.effect or (), names))
            self._known[key] = _frozen(found)
        return self._known[key]

    def body(self, statements: tuple[Statement, ...], names: Names, depth: int) -> Writes:
        """What statements may write whose achieves may be refined `depth` levels down."""
        found: dict[str, set[tuple[Pattern, bool | None]]] = {}
        hidden = declared(statements)
        known = {name: value for name, value in names.items() if name not in hidden}
        for statement in statements_within(statements):
            match statement:
                case Achieve(condition=condition):
                    normal = self.conditions.normal(condition)
                    _add(found, self.condition(normal, known, depth))
                case Do(controller=name, arguments=arguments):
                    controller = self.world.controllers[name]
                    own = tuple(_known(a, known) for a in arguments)
                    inner = dict(zip((p.name for p in controller.parameters), own, strict=True))
                    _add(found, self.effect(controller.effect or (), inner))
                case Call(behavior=name, arguments=arguments):
                    own = tuple(_known(a, known) for a in arguments)
                    _add(found, self.behavior(self.world.behaviors[name], own, depth))
                case _:
                    pass
        return _frozen(found)

    def effect(self, statements: tuple[Statement, ...], names: Names) -> Writes:
        """What an effect may write."""
        found: dict[str, set[tuple[Pattern, bool | None]]] = {}
        hidden = declared(statements)
        known = {name: value for name, value in names.items() if name not in hidden}
        for statement in statements_within(statements):
            if isinstance(statement, Simulate):
                return self.everything
            if isinstance(statement, Assign):
                arguments = tuple(_known(a, known) for a in statement.arguments)
                value = statement.value
                is_fixed = isinstance(value, Constant) and isinstance(value.value, bool)
                written = value.value if is_fixed and isinstance(value, Constant) else None
                assert written is None or isinstance(written, bool)
                found.setdefault(statement.feature, set()).add((arguments, written))
        return _frozen(found)

    def _applications(
        self, condition: Expression, names: Names
    ) -> Iterator[tuple[Behavior, Pattern]]:
        """The behaviors that achieving a condition may apply, with what is known of arguments."""
        match condition:
            case And(operands=operands) | Or(operands=operands):
                for operand in operands:
                    yield from self._applications(operand, names)
            case Quantified(variables=variables, body=body):
                hidden = {v.name for v in variables}
                inner = {n: v for n, v in names.items() if n not in hidden}
                yield from self._applications(body, inner)
            case Compare():
                yield from self._comparing(condition)
            case Read() | Apply() as atom:
                yield from self._literal(atom, names, positive=True)
            case Not(operand=Read() | Apply() as atom):
                yield from self._literal(atom, names, positive=False)
            case _:
                return

    def _comparing(self, condition: Compare) -> Iterator[tuple[Behavior, Pattern]]:
        sides = (condition.left, condition.right)
        wanted = {_name(side) for side in sides if isinstance(side, Read | Apply)}
        found = list(self.matching.writers(condition))
        for behavior, goal in self.matching.goals:
            if isinstance(goal, Compare):
                own = (goal.left, goal.right)
                if wanted & {_name(side) for side in own if isinstance(side, Read | Apply)}:
                    found.append(behavior)
        for behavior in found:
            yield behavior, tuple(None for _ in behavior.parameters)

    def _literal(
        self, atom: Read | Apply, names: Names, *, positive: bool
    ) -> Iterator[tuple[Behavior, Pattern]]:
        values = tuple(_known(a, names) for a in atom.arguments)
        for behavior, goal in self.matching.goals:
            inner = goal.operand if isinstance(goal, Not) else goal
            if isinstance(goal, Not) == positive or not isinstance(inner, Read | Apply):
                continue
            if _name(inner) == _name(atom):
                bound: dict[str, Value] = {}
                if all(map(_fits, inner.arguments, values, [bound] * len(values))):
                    yield behavior, tuple(bound.get(p.name) for p in behavior.parameters)


def _fits(pattern: Expression, value: Value, bound: dict[str, Value]) -> bool:
    """Whether an argument of a goal can be a value; None is any."""
    match pattern:
        case Variable(name=name) if value is not None:
            return bool(bound.setdefault(name, value) == value)
        case Object(name=name) if value is not None:
            return bool(name == value)
        case _:
            return True


def _known(argument: Expression, names: Names) -> Value:
    match argument:
        case Object(name=name):
            return name
        case Variable(name=name):
            return names.get(name)
        case _:
            return None


def declared(statements: tuple[Statement, ...]) -> set[str]:
    """The variables that statements declare or assign, which may hide others of their name."""
    found = set()
    for statement in statements_within(statements):
        variables = getattr(statement, "variables", ())
        found |= {v.name for v in variables}
        variable = getattr(statement, "variable", None)
        if variable is not None:
            found.add(variable if isinstance(variable, str) else variable.name)
    return found


def _name(atom: Read | Apply) -> str:
    return atom.feature if isinstance(atom, Read) else atom.function


def _add(found: dict[str, set[tuple[Pattern, bool | None]]], more: Writes) -> None:
    for feature, patterns in more.items():
        found.setdefault(feature, set()).update(patterns)


def _frozen(found: dict[str, set[tuple[Pattern, bool | None]]]) -> Writes:
    return {feature: frozenset(patterns) for feature, patterns in found.items()}


def may_write(writes: Writes, wanted: Literal) -> bool:
    """Whether a literal may be made true."""
    for arguments, value in writes.get(wanted.feature, ()):
        if (value is None or value == wanted.value) and all(
            a is None or b is None or a == b
            for a, b in zip(arguments, wanted.arguments, strict=True)
        ):
            return True
    return False


def literals(condition: Expression, names: Names) -> Iterator[Literal]:
    """The literals that a condition needs, with arguments that are known."""
    match condition:
        case And(operands=operands):
            for operand in operands:
                yield from literals(operand, names)
        case Read(feature=feature, arguments=arguments):
            yield from _literal(feature, arguments, names, value=True)
        case Not(operand=Read(feature=feature, arguments=arguments)):
            yield from _literal(feature, arguments, names, value=False)
        case _:
            simple = plain(condition)
            if simple is not condition:
                yield from literals(simple, names)


def _literal(
    feature: str, arguments: tuple[Expression, ...], names: Names, *, value: bool
) -> Iterator[Literal]:
    known = tuple(_known(a, names) for a in arguments)
    if None not in known:
        yield Literal(feature, known, value)
