"""Names that are declared and never used."""

from collections.abc import Iterator

from cdlc.diagnostics import Collector
from cdlc.ir.behaviors import body_of, parts_of, statements_of
from cdlc.ir.errors import UnusedDefinition, UnusedParameter, UnusedVariable
from cdlc.ir.lints.subject import Subject
from crow.program import (
    Apply,
    Assign,
    Behavior,
    Bind,
    Controller,
    Do,
    Feature,
    ForEach,
    Function,
    Generator,
    Let,
    ListType,
    NamedType,
    ObjectType,
    Quantified,
    Read,
    Statement,
    Type,
    TypeDefinition,
    Variable,
    VectorType,
)
from crow.program.types import OBJECT
from crow.program.walk import statements_within, subexpressions


def unused_parameters(subject: Subject, found: Collector) -> None:
    """Report parameters of behaviors and derived functions that nothing in them mentions.

    Quiet about names that begin with an underscore, and about controllers and external functions,
    which Python runs.
    """
    program = subject.program
    owners: tuple[Behavior | Function, ...] = (
        *program.behaviors,
        *(f for f in program.functions if f.body is not None),
    )
    for owner in owners:
        used = _names_in(owner)
        for parameter in owner.parameters:
            if parameter.name not in used and not parameter.name.startswith("_"):
                assert parameter.location is not None
                found.add(
                    UnusedParameter(
                        location=parameter.location, name=parameter.name, owner=owner.name
                    )
                )


def unused_variables(subject: Subject, found: Collector) -> None:
    """Report `let` and `bind` variables that nothing mentions, their own condition included.

    A bound variable that only its condition mentions says that something exists.
    """
    program = subject.program
    owners: tuple[Behavior | Function | Controller, ...] = (
        *program.behaviors,
        *program.functions,
        *program.controllers,
    )
    for owner in owners:
        used = _names_in(owner)
        for statement in statements_within(_statements(owner)):
            for variable in _introduced(statement):
                if variable.name not in used and not variable.name.startswith("_"):
                    assert variable.location is not None
                    found.add(UnusedVariable(location=variable.location, name=variable.name))


def _introduced(statement: Statement) -> Iterator[Variable]:
    match statement:
        case Let(variable=variable):
            yield Variable(variable.name, variable.type, location=variable.location)
        case Bind(variables=variables):
            for variable in variables:
                yield Variable(variable.name, variable.type, location=variable.location)
        case _:
            return


def _statements(owner: Behavior | Function | Controller) -> tuple[Statement, ...]:
    match owner:
        case Behavior(effect=effect):
            return (*body_of(owner), *(effect or ()))
        case Function(body=body):
            return body or ()
        case Controller(effect=effect):
            return effect or ()


def _names_in(owner: Behavior | Function | Controller) -> set[str]:
    names = {p.name for p in parts_of(_statements(owner)) if isinstance(p, Variable)}
    if isinstance(owner, Behavior) and owner.goal is not None:
        names |= {p.name for p in subexpressions(owner.goal) if isinstance(p, Variable)}
    return names


# ------------------------------------------------------------------------------------ definitions


def unused_definitions(subject: Subject, found: Collector) -> None:
    """Report features, functions, controllers and types that nothing uses.

    Quiet in a fragment, in files that are included or hold no behavior (libraries), about kinds of
    another type, whose objects problems declare, and about external functions, which programs
    share with their Python.
    """
    if subject.is_fragment:
        return
    candidates = list(_candidates(subject))
    for is_last in (False, True):
        # Initial facts may be very many, and are rarely needed to tell.
        init = subject.problem.init if is_last and subject.problem is not None else ()
        used, types = _used_names(subject, init), set(_used_types(subject))
        candidates = [
            definition
            for definition in candidates
            if definition.name not in (types if isinstance(definition, TypeDefinition) else used)
        ]
        if not candidates:
            return
    for definition in candidates:
        assert definition.location is not None
        kind = _KINDS[type(definition).__name__]
        found.add(UnusedDefinition(location=definition.location, name=definition.name, kind=kind))


_Candidate = TypeDefinition | Feature | Function | Controller


def _candidates(subject: Subject) -> Iterator[_Candidate]:
    """The definitions that have to be used."""
    program = subject.program
    files = {b.location.file for b in program.behaviors if b.location is not None}
    definitions: tuple[_Candidate, ...] = (
        *(t for t in program.types if t.base == OBJECT or not t.is_object),
        *program.features,
        *program.controllers,
        *(f for f in program.functions if f.body is not None),
    )
    for definition in definitions:
        location = definition.location
        if location is not None and location.file in files - subject.included:
            yield definition


_KINDS = {
    "TypeDefinition": "type",
    "Feature": "feature",
    "Function": "function",
    "Controller": "controller",
}


def _used_names(subject: Subject, init: tuple[Statement, ...]) -> set[str]:
    program = subject.program
    names: set[str] = set()
    expressions = [*subject.expressions(), *parts_of(init)]
    for generator in program.generators:
        expressions += subexpressions(generator.goal)
    for expression in expressions:
        match expression:
            case Read(feature=name) | Apply(function=name):
                names.add(name)
            case _:
                continue
    for statement in (*statements_of(program), *statements_within(init)):
        match statement:
            case Assign(feature=name) | Do(controller=name):
                names.add(name)
            case _:
                continue
    return names | set(_read_by_functions(subject))


def _read_by_functions(subject: Subject) -> Iterator[str]:
    """The features that external functions and generators say they read."""
    for declared in (*subject.program.functions, *subject.program.generators):
        for annotation in declared.annotations:
            if annotation.name == "reads" and isinstance(annotation.value, tuple):
                if "all" in annotation.value:
                    yield from (f.name for f in subject.program.features)
                yield from annotation.value


def _used_types(subject: Subject) -> Iterator[str]:
    program = subject.program
    for definition in program.types:
        yield from _names_of(definition.base)
    for constant in program.constants:
        yield from _names_of(constant.type)
    owners: tuple[Feature | Function | Controller | Behavior | Generator, ...] = (
        *program.features, *program.functions, *program.controllers, *program.behaviors,
        *program.generators,
    )  # fmt: skip
    for owner in owners:
        for parameter in owner.parameters:
            yield from _names_of(parameter.type)
        if isinstance(owner, Feature | Function):
            yield from _names_of(owner.type)
    for statement in statements_of(program):
        match statement:
            case Let(variable=variable):
                yield from _names_of(variable.type)
            case Bind(variables=variables) | ForEach(variables=variables):
                for variable in variables:
                    yield from _names_of(variable.type)
            case _:
                continue
    for expression in subject.expressions():
        if isinstance(expression, Quantified):
            for variable in expression.variables:
                yield from _names_of(variable.type)
    if subject.problem is not None:
        for added in subject.problem.objects:
            yield from _names_of(added.type)


def _names_of(type_: Type) -> Iterator[str]:
    match type_:
        case ObjectType(name=name):
            yield name
        case NamedType(name=name, base=base):
            yield name
            yield from _names_of(base)
        case VectorType(element=element) | ListType(element=element):
            yield from _names_of(element)
        case _:
            return
