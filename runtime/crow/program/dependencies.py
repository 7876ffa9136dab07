"""Which features expressions read, through every function that they call, and effects write."""

from collections.abc import Iterable, Iterator

from crow.program.definitions import Function, Generator, Program
from crow.program.expressions import Apply, Expression, Read
from crow.program.statements import Assign, Simulate, Statement
from crow.program.walk import expressions_of, statements_within, subexpressions

EVERYTHING = "all"


def declared_reads(program: Program, function: Function) -> frozenset[str] | None:
    """The features that an external function declares to read; None if it reads no state."""
    return _annotated(program, (function,))


def generator_reads(program: Program, generator: Generator) -> frozenset[str] | None:
    """The features that a generator may read: its own, and those of functions in its goal."""
    applied = {p.function for p in subexpressions(generator.goal) if isinstance(p, Apply)}
    functions = [f for f in program.functions if f.name in applied and f.body is None]
    return _annotated(program, (*functions, generator))


def _annotated(
    program: Program, definitions: Iterable[Function | Generator]
) -> frozenset[str] | None:
    found: frozenset[str] | None = None
    for definition in definitions:
        for annotation in definition.annotations:
            if annotation.name == "reads" and isinstance(annotation.value, tuple):
                names = frozenset(annotation.value)
                if EVERYTHING in names:
                    names = frozenset(feature.name for feature in program.features)
                found = names | (found or frozenset())
    return found


def features_read(program: Program, expressions: Iterable[Expression]) -> frozenset[str]:
    """The features that expressions read, also within the functions that they call."""
    functions = {f.name: f for f in program.functions}
    found, seen = set[str](), set[str]()
    pending = list(expressions)
    while pending:
        for part in subexpressions(pending.pop()):
            if isinstance(part, Read):
                found.add(part.feature)
            elif isinstance(part, Apply) and part.function not in seen:
                seen.add(part.function)
                function = functions[part.function]
                found |= declared_reads(program, function) or frozenset()
                for statement in statements_within(function.body or ()):
                    pending.extend(expressions_of(statement))
    return frozenset(found)


def features_written(program: Program, statements: Iterable[Statement]) -> Iterator[str]:
    """The features that an effect may write; what a simulator computes may be any."""
    for statement in statements_within(statements):
        match statement:
            case Assign(feature=name):
                yield name
            case Simulate():
                yield from (feature.name for feature in program.features)
            case _:
                pass
