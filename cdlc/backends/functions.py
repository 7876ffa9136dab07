"""External Boolean functions whose Python is given, as features that never change (lowering.md §2).

A function of objects that does not read the state has one value for each tuple of objects. Computed
once, these are facts like any others: to PDDL, to the interpreter and to the replayer.
"""

from dataclasses import fields, replace
from typing import Any

from cdlc.backends.errors import FunctionFailed, NotInPddl, WrongFunction
from cdlc.diagnostics import Collector
from crow.calls import FunctionError
from crow.externals import ExternalFunction
from crow.functions import FunctionsError, Registered
from crow.problem import Cell, Problem, State
from crow.program import Apply, Feature, Function, Location, Program, Read
from crow.program.location import Node
from crow.program.types import is_boolean, is_object
from crow.registration import registered


def checked(program: Program, given: object, found: Collector) -> Registered | None:
    """The Python that is given, bound to a program; None, with diagnostics, if it does not fit.

    Raises crow.FunctionsError for what cannot be run, or gives no functions at all.
    """
    try:
        return registered(program, given)
    except FunctionsError as error:
        if not error.mistakes:
            raise
        for mistake in error.mistakes:
            location = mistake.location or Location(program.name, 1, 1, 1, 1)
            found.add(WrongFunction(location=location, wrong=mistake.message, cure=mistake.help))
        return None


def failed(error: FunctionError) -> FunctionFailed:
    """A call of the user's Python that failed, as a diagnostic."""
    location = error.location or Location("", 1, 1, 1, 1)
    return FunctionFailed(
        location=location, call=error.call, reason=error.reason, traceback=error.traceback
    )


def report_simulated(program: Program, given: Registered, found: Collector) -> None:
    """Report the controllers whose effects Python computes: PDDL has none of that."""
    for controller in program.controllers:
        if controller.name in given.effects:
            location = controller.location or Location(program.name, 1, 1, 1, 1)
            construct = f"the effect of `{controller.name}`, which Python computes,"
            found.add(NotInPddl(location=location, construct=construct))


def is_static(function: Function) -> bool:
    """Whether a function can be a table: external, Boolean, over objects, not reading the state."""
    reads = any(a.name == "reads" for a in function.annotations)
    has_objects = all(is_object(p.type) for p in function.parameters)
    return function.body is None and is_boolean(function.type) and has_objects and not reads


def tabulated(program: Program, given: Registered) -> Program:
    """The program in which static functions that are given are features."""
    static = {f.name: f for f in program.functions if is_static(f) and f.name in given.functions}
    if not static:
        return program
    rest = tuple(f for f in program.functions if f.name not in static)
    changed: Program = as_reads(replace(program, functions=rest), frozenset(static))
    features = tuple(
        Feature(f.name, f.parameters, f.type, location=f.location) for f in static.values()
    )
    return replace(changed, features=(*changed.features, *features))


def tabulated_problem(problem: Problem) -> Problem:
    """A problem over the tabulated program, the tables in its initial state.

    Raises crow.FunctionError for a function that fails or gives no truth value.
    """
    before = problem.world
    program = tabulated(before.program, before.registered)
    names = frozenset(f.name for f in program.features) & before.externals.functions.keys()
    if not names:
        return problem
    cells: dict[Cell, object] = dict(problem.initial.cells)
    for name in sorted(names):
        cells |= _table(problem, before.externals.functions[name])
    return problem.changed(
        world=replace(before, program=program),
        initial=State(cells),
        goal=as_reads(problem.goal, names),
        minimize=as_reads(problem.minimize, names),
    )


def _table(problem: Problem, function: ExternalFunction) -> dict[Cell, object]:
    """The true cells of a function as a feature. Raises FunctionError."""
    declared = function.declared
    feature = Feature(declared.name, declared.parameters, declared.type)
    rows = list(problem.world.cells(feature))
    values = function.values({}, rows, declared.location)
    return {(declared.name, row): True for row, value in zip(rows, values, strict=True) if value}


def as_reads(node: Any, names: frozenset[str]) -> Any:
    """A node, or a tuple of some, with calls of the named functions as reads of features."""
    if isinstance(node, tuple):
        return tuple(as_reads(part, names) for part in node)
    if not isinstance(node, Node | Program):
        return node
    parts = {f.name: getattr(node, f.name) for f in fields(node)}
    changed = {name: as_reads(part, names) for name, part in parts.items()}
    differs = {name: new for name, new in changed.items() if new is not parts[name]}
    made = replace(node, **differs) if differs else node
    if isinstance(made, Apply) and made.function in names:
        return Read(made.function, made.arguments, made.type, location=made.location)
    return made
