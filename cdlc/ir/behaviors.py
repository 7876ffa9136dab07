"""Behaviors looked at as a whole."""

from collections.abc import Iterator
from dataclasses import dataclass, field

from crow.program import (
    Apply,
    Assign,
    Behavior,
    Call,
    Do,
    Expression,
    Function,
    Program,
    Read,
    Statement,
)
from crow.program.walk import expressions_of, statements_within, subexpressions


def body_of(behavior: Behavior) -> tuple[Statement, ...]:
    """The statements of L, M and R."""
    members = () if behavior.promotable is None else behavior.promotable.members
    return (*behavior.left, *members, *behavior.right)


def statements_of(program: Program) -> Iterator[Statement]:
    """Every statement of a program, nested ones too."""
    for function in program.functions:
        yield from statements_within(function.body or ())
    for controller in program.controllers:
        yield from statements_within(controller.effect or ())
    for behavior in program.behaviors:
        yield from statements_within((*body_of(behavior), *(behavior.effect or ())))


def parts_of(statements: tuple[Statement, ...]) -> Iterator[Expression]:
    """Every expression in statements, however deep."""
    for statement in statements_within(statements):
        for expression in expressions_of(statement):
            yield from subexpressions(expression)


def reads_of(function: Function) -> frozenset[str]:
    """The features that an external function says it reads; `all` for all of them."""
    names: set[str] = set()
    for annotation in function.annotations:
        if annotation.name == "reads" and annotation.value is not None:
            value = annotation.value
            names.update(value if isinstance(value, tuple) else (str(value),))
    return frozenset(names)


@dataclass(frozen=True, slots=True)
class Touched:
    """The features that statements may read and write, those of what they call included."""

    reads: set[str] = field(default_factory=set)
    writes: set[str] = field(default_factory=set)

    def disturbs(self, other: "Touched") -> bool:
        """Whether something written here is read or written there."""
        is_all_read = "all" in other.reads and self.writes
        return bool(is_all_read or not self.writes.isdisjoint(other.reads | other.writes))


def touched(program: Program, statements: tuple[Statement, ...]) -> Touched:
    """What some statements of a program may read and write."""
    functions = {f.name: f for f in program.functions}
    controllers = {c.name: c for c in program.controllers}
    behaviors = {b.name: b for b in program.behaviors}
    found = Touched()
    pending = [statements]
    while pending:
        block = pending.pop()
        for statement in statements_within(block):
            match statement:
                case Assign(feature=name, operator=operator):
                    found.writes.add(name)
                    found.reads.update(() if operator == "=" else (name,))
                case Do(controller=name) if controller := controllers.pop(name, None):
                    pending.append(controller.effect or ())
                case Call(behavior=name) if behavior := behaviors.pop(name, None):
                    pending.append((*body_of(behavior), *(behavior.effect or ())))
                case _:
                    pass
        for part in parts_of(block):
            if isinstance(part, Read):
                found.reads.add(part.feature)
            elif isinstance(part, Apply) and (function := functions.pop(part.function, None)):
                found.reads.update(reads_of(function))
                pending.append(function.body or ())
    return found
