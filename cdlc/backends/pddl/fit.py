"""What keeps a program from being PDDL, seen before anything is emitted."""

from collections.abc import Iterator, Sequence

from cdlc.backends.errors import NotDiscrete, NotInPddl, SplitBehavior, UnsetInPddl
from cdlc.backends.pddl.methods import unmodelled_calls
from cdlc.backends.pddl.parts import Part
from cdlc.backends.pddl.problems import unset_cells
from cdlc.diagnostics import Collector
from cdlc.ir.behaviors import statements_of
from cdlc.ir.errors import UnmodelledController
from crow.evaluate import shown_cell
from crow.problem import Problem
from crow.program import Assign, Behavior, Expression, Feature, Location, Program, Read
from crow.program.types import is_boolean, is_number, is_object
from crow.program.walk import expressions_of, subexpressions


def report_unfit(program: Program, found: Collector) -> None:
    """Report features without discrete values, which PDDL has no form for."""
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


def report_unmodelled(program: Program, found: Collector) -> None:
    """Warn of controllers that methods run and nothing describes: planners do not see them."""
    declared = {c.name: c.location for c in program.controllers}
    for _, call in unmodelled_calls(program):
        found.add(
            UnmodelledController(
                location=call.location or Location("", 1, 1, 1, 1),
                controller=call.controller,
                declared=declared[call.controller],
            )
        )


def report_split(behavior: Behavior, parts: Sequence[Part], found: Collector) -> None:
    """Warn of a behavior that becomes a transition a phase."""
    later = [part.behavior.location for part in parts if part.needs is not None]
    if later:
        found.add(
            SplitBehavior(
                location=behavior.location or Location("", 1, 1, 1, 1),
                behavior=behavior.name,
                again=tuple(dict.fromkeys(filter(None, later))),
            )
        )


def report_unplannable(program: Program, found: Collector) -> None:
    """Report what keeps a planner's plan from being one of the program: controllers it cannot see.

    The domain can be emitted, but its plans would leave them out.
    """
    for method, call in unmodelled_calls(program):
        construct = f"`{call.controller}`, which `{method.name}` runs and no effect describes,"
        location = call.location or Location("", 1, 1, 1, 1)
        found.add(NotInPddl(location=location, construct=construct, cure=_UNMODELLED))


_UNMODELLED = "give the controller, or the behavior, an `eff:` section"


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
