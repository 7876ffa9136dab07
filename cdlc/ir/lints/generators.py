"""Generators that are never asked, and variables that no generator can give a value."""

from collections.abc import Iterator

from cdlc.diagnostics import Collector
from cdlc.ir.behaviors import body_of, parts_of
from cdlc.ir.errors import MissingGenerator, UnmatchedGenerator
from cdlc.ir.lints.subject import Subject
from crow.program import (
    BOOL,
    Achieve,
    Apply,
    Behavior,
    Bind,
    Call,
    Compare,
    Expression,
    Generator,
    ObjectType,
    Parameter,
    Read,
    Statement,
    Variable,
)
from crow.program.types import underlying
from crow.program.walk import expressions_of, statements_within, subexpressions


def unmatched_generators(subject: Subject, found: Collector) -> None:
    """Report generators whose function or feature occurs nowhere in the program.

    Quiet in a fragment. By name only: which arguments are known where is for the run.
    """
    if subject.is_fragment or not subject.program.generators:
        return
    used = set(_called(subject.expressions()))
    for generator in subject.program.generators:
        wanted = set(_called(subexpressions(generator.goal)))
        if not wanted & used and generator.goal.location is not None:
            found.add(
                UnmatchedGenerator(location=generator.goal.location, generator=generator.name)
            )


def _called(expressions: Iterator[Expression]) -> Iterator[str]:
    for part in expressions:
        match part:
            case Apply(function=name) | Read(feature=name):
                yield name
            case _:
                continue


def missing_generators(subject: Subject, found: Collector) -> None:
    """Report bound variables of a value type that no generator could ever supply.

    Quiet in a program without generators, about variables that an equation or another behavior may
    decide, and about types that some generator yields a value for in a constraint on the variable.
    """
    generators = subject.program.generators
    if not generators:
        return
    for behavior in subject.program.behaviors:
        for statement in statements_within(body_of(behavior)):
            if isinstance(statement, Bind):
                for variable in statement.variables:
                    if not _is_supplied(variable, statement, behavior, generators):
                        assert variable.location is not None
                        found.add(
                            MissingGenerator(
                                location=variable.location,
                                variable=variable.name,
                                type=variable.type,
                            )
                        )


def _is_supplied(
    variable: Parameter, bind: Bind, behavior: Behavior, generators: tuple[Generator, ...]
) -> bool:
    if isinstance(variable.type, ObjectType) or underlying(variable.type) == BOOL:
        return True
    body = body_of(behavior)
    if bind.condition is None or _is_passed_on(variable.name, body):
        return True
    names = {name for generator in generators for name in _supplies(generator)}
    for part in parts_of(body):
        match part:
            case Compare(operator="==") if _mentions(part, variable.name):
                return True
            case Apply(function=name) | Read(feature=name) if name in names:
                if _mentions(part, variable.name):
                    return True
            case _:
                continue
    return False


def _supplies(generator: Generator) -> Iterator[str]:
    """The functions and features that a generator can find arguments or a value for."""
    return _called(subexpressions(generator.goal))


def _is_passed_on(name: str, body: tuple[Statement, ...]) -> bool:
    """Whether other behaviors get to see a variable, and may constrain it."""
    return any(
        _mentions(expression, name)
        for statement in statements_within(body)
        if isinstance(statement, Achieve | Call)
        for expression in expressions_of(statement)
    )


def _mentions(expression: Expression, name: str) -> bool:
    return any(isinstance(p, Variable) and p.name == name for p in subexpressions(expression))
