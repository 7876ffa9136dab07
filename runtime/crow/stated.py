"""Problems stated in Python: objects, feature values and a goal, checked against a program."""

import re
from collections.abc import Mapping
from difflib import get_close_matches

from crow.domain import Domain
from crow.evaluate import EvaluationError, check_bounds, check_unset
from crow.functions import NOTHING, Registered
from crow.outside import taken_in
from crow.problem import Cell, State, World
from crow.program import Expression, Feature, ObjectType, Parameter, Program
from crow.reading import WrongValueError, read_json
from crow.values import Value, default_value, stored

CellName = str | tuple[str, tuple[str, ...]]
"""A cell, `"on(a, b)"` or `("on", ("a", "b"))`; a feature without objects has one: `"fuel"`."""

_CELL = re.compile(r"\s*(\w+)\s*(?:[(\[]([^()\[\]]*)[)\]])?\s*")


class ProblemError(ValueError):
    """A problem that does not fit its domain; the message says what, and often the cure."""


def world_of(
    program: Program, objects: Mapping[str, str], registered: Registered = NOTHING
) -> World:
    """The world of a program with objects by their types. Raises ProblemError."""
    types = {t.name: t for t in program.types}
    known = {constant.name for constant in program.constants}
    stated = []
    for name, type_ in objects.items():
        if type_ not in types and type_ != "object":
            raise ProblemError(f"object `{name}`: no object type `{type_}`{_meant(type_, types)}")
        if not name.isidentifier():
            raise ProblemError(f"`{name}` is no name for an object")
        if name in known:
            raise ProblemError(f"object `{name}` is a constant of the domain already")
        stated.append(Parameter(name, ObjectType(type_)))
    return World.of(program, tuple(stated), registered)


def state_of(world: World, init: Mapping[CellName, Value]) -> State:
    """The state with some cells set and all others at their defaults.

    Raises ProblemError for what is no cell or no value of its feature, and for a cell that is not
    set and whose default is out of bounds.
    """
    cells: dict[Cell, Value] = {}
    for name, value in init.items():
        feature, cell = cell_of(world, name)
        try:
            own = stored(taken_in(value, feature.type, world), feature.type)
            check_bounds(world, cell, own)
        except (WrongValueError, EvaluationError, ArithmeticError) as error:
            raise ProblemError(f"`{_shown(name)}`: {error}") from None
        if own != default_value(feature.type):
            cells[cell] = own
    try:
        check_unset(world, cells)
    except EvaluationError as error:
        raise ProblemError(f"{error}; `init` has to set it") from None
    return State(cells)


def cell_of(world: World, name: object) -> tuple[Feature, Cell]:
    """The cell of a name, with its feature; `("on", "a", "b")` is `("on", ("a", "b"))` as well.

    Raises ProblemError.
    """
    if isinstance(name, str):
        match = _CELL.fullmatch(name)
        if match is None:
            raise ProblemError(f"`{name}` is no cell, such as `on(a, b)`")
        inside = (match[2] or "").strip()
        arguments = tuple(part.strip() for part in inside.split(",")) if inside else ()
        called = match[1]
    else:
        called, arguments = _parts(name)
    feature = world.features.get(called)
    if feature is None:
        raise ProblemError(f"no feature `{called}`{_meant(called, world.features)}")
    if len(arguments) != len(feature.parameters):
        count = len(feature.parameters)
        raise ProblemError(f"`{called}` takes {count} objects, not {len(arguments)}")
    for argument, parameter in zip(arguments, feature.parameters, strict=True):
        try:
            read_json(argument, parameter.type, world)
        except WrongValueError as error:
            hint = _meant(argument, error.known)
            raise ProblemError(f"`{_shown(name)}`: {error}{hint}") from None
    return feature, (called, arguments)


def _parts(name: object) -> tuple[str, tuple[str, ...]]:
    match name:
        case (str(called), tuple(arguments)):
            return called, arguments
        case (str(called), *rest):
            return called, tuple(map(str, rest))
        case _:
            raise ProblemError(f"`{name!r:.60}` is no cell, such as `on(a, b)`")


def expression_of(
    domain: Domain,
    what: str | Expression,
    world: World,
    values: Mapping[str, Value],
    *,
    is_number: bool = False,
) -> Expression:
    """A goal, or what to minimize, given as text or as an expression. Raises ProblemError."""
    if not isinstance(what, str):
        return what
    if domain.language is None:
        raise ProblemError(
            "a domain that was loaded from a compiled program takes goals as expressions;"
            " `cdlc.load` gives one that takes text"
        )
    return domain.language.expression(what, world, values, is_number=is_number)


def _meant(name: str, known: object) -> str:
    close = get_close_matches(name, list(known), 1)  # type: ignore[call-overload]
    return f"; did you mean `{close[0]}`?" if close else ""


def _shown(name: object) -> str:
    if isinstance(name, str):
        return name
    called, arguments = _parts(name)
    return f"{called}({', '.join(map(str, arguments))})"
