"""External Boolean functions whose Python is given, as features that never change (lowering.md §2).

A function of objects that does not read the state has one value for each tuple of objects. Computed
once, these are facts like any others: to PDDL, to the interpreter and to the replayer.
"""

import runpy
from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from typing import Any

from cdlc.backends.errors import FunctionFailed
from cdlc.diagnostics import Collector
from crow.evaluate import shown_cell
from crow.problem import Cell, Problem, State, World
from crow.program import Apply, Feature, Function, Location, Program, Read
from crow.program.location import Node
from crow.program.types import is_boolean, is_object

Functions = Mapping[str, Callable[..., Any]]


class FunctionsError(Exception):
    """A Python file that cannot be run; the message says why."""


def load_functions(path: str) -> Functions:
    """The functions of a Python file, by name. Raises FunctionsError."""
    try:
        names = runpy.run_path(path, run_name="cdlc_functions")
    except OSError as error:
        raise FunctionsError(f"`{path}`: {error.strerror or error}") from error
    except Exception as error:
        raise FunctionsError(f"`{path}`: {type(error).__name__}: {error}") from error
    return {n: f for n, f in names.items() if callable(f) and not n.startswith("_")}


def is_static(function: Function) -> bool:
    """Whether a function can be a table: external, Boolean, over objects, not reading the state."""
    reads = any(a.name == "reads" for a in function.annotations)
    has_objects = all(is_object(p.type) for p in function.parameters)
    return function.body is None and is_boolean(function.type) and has_objects and not reads


def tabulated(program: Program, functions: Functions) -> Program:
    """The program in which static functions that are given are features."""
    given = {f.name: f for f in program.functions if is_static(f) and f.name in functions}
    if not given:
        return program
    rest = tuple(f for f in program.functions if f.name not in given)
    changed: Program = as_reads(replace(program, functions=rest), frozenset(given))
    features = tuple(
        Feature(f.name, f.parameters, f.type, location=f.location) for f in given.values()
    )
    return replace(changed, features=(*changed.features, *features))


def tabulated_problem(
    problem: Problem, program: Program, functions: Functions, found: Collector
) -> Problem:
    """A problem over a tabulated program, the tables in its initial state.

    A function that fails or gives no truth value is reported.
    """
    before = problem.world.program
    static = {f.name: f for f in before.functions} if program is not before else {}
    world = World(program, problem.world.objects)
    cells: dict[Cell, object] = dict(problem.initial.cells)
    for feature in program.features:
        if feature.name in static:
            for where in world.cells(feature):
                if _value(functions[feature.name], feature, where, found):
                    cells[feature.name, where] = True
    names = frozenset(static) & {f.name for f in program.features}
    return problem.changed(
        world=world,
        initial=State(cells),
        goal=as_reads(problem.goal, names),
        minimize=as_reads(problem.minimize, names),
    )


def _value(
    function: Callable[..., Any], feature: Feature, where: tuple[str, ...], found: Collector
) -> bool:
    location = feature.location or Location("", 1, 1, 1, 1)
    call = shown_cell((feature.name, where))
    try:
        value = function(*where)
    except Exception as error:  # noqa: BLE001 - whatever the user's code raises
        reason = f"raised {type(error).__name__}: {error}"
        found.add(FunctionFailed(location=location, call=call, reason=reason))
        return False
    if not isinstance(value, bool):
        reason = f"gave {value!r:.60}, which is no truth value"
        found.add(FunctionFailed(location=location, call=call, reason=reason))
        return False
    return value


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
