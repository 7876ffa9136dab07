"""Behaviors looked at as a whole."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from crow.program import (
    Achieve,
    Apply,
    Assign,
    Behavior,
    Call,
    Compare,
    Conditional,
    Do,
    Expression,
    Function,
    Program,
    Read,
    Statement,
    Xor,
)
from crow.program.walk import children, expressions_of, statements_within, subexpressions


def body_of(behavior: Behavior) -> tuple[Statement, ...]:
    """The statements of L, M and R."""
    members = () if behavior.promotable is None else behavior.promotable.members
    return (*behavior.left, *members, *behavior.right)


def called_by_transitions(program: Program) -> set[str]:
    """The behaviors that those with an effect call: what they run is part of their callers."""
    return {
        statement.behavior
        for behavior in program.behaviors
        if behavior.effect is not None
        for statement in statements_within(body_of(behavior))
        if isinstance(statement, Call)
    }


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


@dataclass(frozen=True, slots=True)
class _Wanted:
    """What conditions name: features and functions that goals match, and what comparisons read."""

    named: set[str] = field(default_factory=set)
    compared: set[str] = field(default_factory=set)


def applied_for(program: Program, conditions: Iterable[Expression]) -> tuple[Behavior, ...]:
    """The behaviors that plans for some conditions may apply, in source order; perhaps some more.

    Names decide: a behavior may be applied for a condition if its goal names the same, or, for a
    comparison, if it writes what that reads (semantics.md §2).
    """
    writes = {b.name: _all_touched(program, b).writes for b in program.behaviors}
    reached: set[str] = set()
    pending = [_wanted(program, conditions)]
    while pending:
        wanted = pending.pop()
        for behavior in program.behaviors:
            if behavior.name in reached or behavior.goal is None:
                continue
            goal = _wanted(program, (behavior.goal,), is_goal=True).named
            if goal & wanted.named or writes[behavior.name] & wanted.compared:
                reached.add(behavior.name)
                pending.append(_wanted(program, achieved_in(program, body_of(behavior))))
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


def _all_touched(program: Program, behavior: Behavior) -> Touched:
    return touched(program, (*body_of(behavior), *(behavior.effect or ())))


def _wanted(
    program: Program, expressions: Iterable[Expression], *, is_goal: bool = False
) -> _Wanted:
    """What expressions name; functions are unfolded, but in a goal."""
    functions = {f.name: f for f in program.functions}
    found = _Wanted()
    pending = [(expression, False) for expression in expressions]
    while pending:
        node, is_compared = pending.pop()
        is_compared = is_compared or isinstance(node, Compare | Xor | Conditional)
        name = node.feature if isinstance(node, Read) else ""
        if isinstance(node, Apply):
            name = node.function
            reads = reads_of(functions[name])
            found.compared.update((f.name for f in program.features) if "all" in reads else reads)
            if name not in found.named and not is_goal:
                parts = functions[name].body or ()
                pending += [(e, True) for s in statements_within(parts) for e in expressions_of(s)]
        if name:
            found.named.add(name)
            found.compared.update((name,) if is_compared else ())
        pending += [(c, is_compared) for c in children(node) if isinstance(c, Expression)]
    return found
