"""What keeps a program from being PDDL, seen before anything is emitted."""

from collections.abc import Iterator

from cdlc.backends.errors import NotDiscrete, NotInPddl, UnsetInPddl
from cdlc.backends.pddl.problems import unset_cells
from cdlc.diagnostics import Collector
from cdlc.ir.behaviors import statements_of
from crow.evaluate import shown_cell
from crow.problem import Problem
from crow.program import Assign, Behavior, Do, Expression, Feature, Location, Program, Read
from crow.program.types import is_boolean, is_number, is_object
from crow.program.walk import expressions_of, statements_within, subexpressions


def report_unfit(program: Program, found: Collector) -> None:
    """Report features without discrete values, and methods whose controllers no action runs."""
    for feature in program.features:
        if not (is_boolean(feature.type) or is_number(feature.type) or is_object(feature.type)):
            found.add(
                NotDiscrete(
                    location=feature.location or Location("", 1, 1, 1, 1),
                    feature=feature.name,
                    type=feature.type,
                    uses=tuple(uses(program, feature)),
                )
            )
    for behavior in program.behaviors:
        if behavior.effect is None:
            for call in _calls(behavior):
                location = call.location or Location("", 1, 1, 1, 1)
                construct = f"`{call.controller}` run by `{behavior.name}`, which has no effect,"
                found.add(NotInPddl(location=location, construct=construct))


def _calls(behavior: Behavior) -> Iterator[Do]:
    return (s for s in statements_within(behavior.body) if isinstance(s, Do))


def uses(program: Program, feature: Feature) -> Iterator[Location]:
    """Where a feature is read or written, in source order of statements."""
    for statement in statements_of(program):
        if isinstance(statement, Assign) and statement.feature == feature.name:
            yield from filter(None, (statement.location,))
        for expression in expressions_of(statement):
            yield from _reads(expression, feature)
    for behavior in program.behaviors:
        if behavior.goal is not None:
            yield from _reads(behavior.goal, feature)


def _reads(expression: Expression, feature: Feature) -> Iterator[Location]:
    for part in subexpressions(expression):
        if isinstance(part, Read) and part.feature == feature.name and part.location is not None:
            yield part.location


def report_unset(problem: Problem, found: Collector) -> None:
    """Report object-valued features that the initial state leaves without a value."""
    for feature, cells in unset_cells(problem.world, problem.initial):
        found.add(
            UnsetInPddl(
                location=feature.location or Location("", 1, 1, 1, 1),
                feature=feature.name,
                cells=tuple(map(shown_cell, cells)),
                problem=problem.name,
            )
        )
