"""Behaviors looked at as a whole."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from crow.program import (
    Achieve,
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


def applied_for(program: Program, conditions: Iterable[Expression]) -> tuple[Behavior, ...]:
    """The behaviors that plans for some conditions may apply, in source order; perhaps some more.

    What a condition names decides: a behavior may be applied for it if its goal names the same, or
    if it writes what the condition reads, as it may for a comparison (semantics.md §2).
    """
    about = {b.name: _about(program, b) for b in program.behaviors}
    reached: set[str] = set()
    pending = [_named(program, conditions)]
    while pending:
        names = pending.pop()
        for behavior in program.behaviors:
            if behavior.name not in reached and not about[behavior.name].isdisjoint(names):
                reached.add(behavior.name)
                pending.append(_named(program, achieved_in(program, body_of(behavior))))
    return tuple(b for b in program.behaviors if b.name in reached)


def achieved_in(program: Program, statements: tuple[Statement, ...]) -> Iterator[Expression]:
    """The conditions that statements achieve, those of what they call included."""
    behaviors = {b.name: b for b in program.behaviors}
    pending = [statements]
    while pending:
        for statement in statements_within(pending.pop()):
            match statement:
                case Achieve(condition=condition):
                    yield condition
                case Call(behavior=name) if behavior := behaviors.pop(name, None):
                    pending.append(body_of(behavior))
                case _:
                    pass


def disturbed(
    program: Program, statements: tuple[Statement, ...], conditions: Iterable[Expression]
) -> bool:
    """Whether plans for conditions may change what some statements read."""
    changed = Touched()
    for behavior in applied_for(program, conditions):
        changed.writes.update(_all_touched(program, behavior).writes)
    return changed.disturbs(Touched(touched(program, statements).reads))


def _about(program: Program, behavior: Behavior) -> set[str]:
    """What a behavior can be applied for: the names in its goal, and what it writes."""
    if behavior.goal is None:
        return set()
    goal = {
        part.feature if isinstance(part, Read) else part.function
        for part in subexpressions(behavior.goal)
        if isinstance(part, Read | Apply)
    }
    return goal | _all_touched(program, behavior).writes


def _all_touched(program: Program, behavior: Behavior) -> Touched:
    return touched(program, (*body_of(behavior), *(behavior.effect or ())))


def _named(program: Program, expressions: Iterable[Expression]) -> set[str]:
    """Features and functions in expressions, derived functions unfolded."""
    functions = {f.name: f for f in program.functions}
    names: set[str] = set()
    pending = list(expressions)
    while pending:
        for part in subexpressions(pending.pop()):
            if isinstance(part, Read):
                names.add(part.feature)
            elif isinstance(part, Apply) and part.function not in names:
                names.add(part.function)
                function = functions[part.function]
                reads = reads_of(function)
                names |= {f.name for f in program.features} if "all" in reads else reads
                for statement in statements_within(function.body or ()):
                    pending += expressions_of(statement)
    return names
