"""Definitions to declarations: every name of a domain with its type, before any body is read."""

from collections.abc import Iterable, Iterator
from dataclasses import replace

from crow.program import (
    BOOL,
    OBJECT,
    Controller,
    Feature,
    Function,
    NamedType,
    Object,
    ObjectConstant,
    ObjectType,
    Parameter,
    Type,
    TypeDefinition,
    UnknownType,
)

from cdlc.diagnostics import Collector
from cdlc.frontend import errors, syntax
from cdlc.frontend.annotations import Owner, check_annotations
from cdlc.frontend.check_types import check_parameters, resolve_type
from cdlc.frontend.scope import BUILTIN_FUNCTIONS, Context, Declarations, Signature
from cdlc.source import SourceFile

Sourced = tuple[SourceFile, syntax.Definition]


def declare(definitions: Iterable[Sourced], found: Collector) -> Declarations:
    """The declarations of a domain; clashes and unknown types are reported to `found`."""
    declared = Declarations()
    listed = list(definitions)
    _declare_types(listed, declared, found)
    for source, node in listed:
        _declare_value(node, Context(source, declared, found))
    return declared


def type_definitions(
    definitions: Iterable[Sourced], declared: Declarations, found: Collector
) -> Iterator[TypeDefinition]:
    """The type definitions of the program, in source order."""
    for source, node in definitions:
        if not isinstance(node, syntax.TypeDefinition):
            continue
        context = Context(source, declared, found)
        location = context.location(node.span)
        if declared.type_places.get(node.name.text) != context.location(node.name.span):
            continue
        type_ = declared.types[node.name.text]
        owner: Owner = "object type" if isinstance(type_, ObjectType) else "value type"
        annotations = check_annotations(node.annotations, owner, context)
        match type_:
            case ObjectType(name=name):
                base: Type = ObjectType(declared.parents.get(name, OBJECT.name))
                yield TypeDefinition(
                    name, base, is_object=True, annotations=annotations, location=location
                )
            case NamedType(name=name, base=base):
                yield TypeDefinition(
                    name, base, is_object=False, annotations=annotations, location=location
                )
            case _:
                continue


# ---------------------------------------------------------------------------------------- types


def _declare_types(listed: list[Sourced], declared: Declarations, found: Collector) -> None:
    """Types may be used before they are defined, so each is resolved on demand."""
    pending: dict[str, tuple[Context, syntax.TypeDefinition]] = {}
    for source, node in listed:
        if isinstance(node, syntax.TypeDefinition):
            context = Context(source, declared, found)
            if _claim_type(node.name, context):
                pending[node.name.text] = (context, node)
    for name in pending:
        _resolve(name, pending, (), declared)


def _claim_type(name: syntax.Name, context: Context) -> bool:
    declared = context.declarations
    location = context.location(name.span)
    if name.text in declared.types and name.text not in declared.type_places:
        context.found.add(errors.HidesDefinition(location=location, name=name.text, defined=None))
        return False
    first = declared.type_places.get(name.text)
    if first is not None:
        context.found.add(
            errors.DuplicateDefinition(location=location, name=name.text, first=first)
        )
        return False
    declared.type_places[name.text] = location
    return True


def _resolve(
    name: str,
    pending: dict[str, tuple[Context, syntax.TypeDefinition]],
    chain: tuple[str, ...],
    declared: Declarations,
) -> None:
    """Put one type definition, and first those it is based on, into the declarations."""
    if name in declared.types:
        return
    context, node = pending[name]
    chain = (*chain, name)
    for needed in _names_in(node.base):
        if needed in chain:
            location = context.location(node.span)
            cycle = (*chain[chain.index(needed) :], needed)
            context.found.add(errors.TypeCycle(location=location, chain=cycle))
            declared.types[name] = UnknownType()
            return
        if needed in pending:
            _resolve(needed, pending, chain, declared)
    base = OBJECT if node.base is None else resolve_type(node.base, context)
    match base:
        case ObjectType(name=parent):
            declared.types[name] = ObjectType(name)
            declared.parents[name] = parent
        case UnknownType():
            declared.types[name] = base
        case _:
            declared.types[name] = NamedType(name, base)


def _names_in(written: syntax.Type | None) -> Iterator[str]:
    match written:
        case None:
            return
        case syntax.NamedType(name=name):
            yield name
        case syntax.VectorType(element=element) | syntax.ListType(element=element):
            yield from _names_in(element)


# --------------------------------------------------------------------------------------- values


def _declare_value(node: syntax.Definition, context: Context) -> None:
    declared = context.declarations
    match node:
        case syntax.Feature(name=name) if _claim(name, context):
            declared.features[name.text] = _feature(node, context)
        case syntax.Function(name=name) if _claim(name, context):
            declared.functions[name.text] = _function(node, context)
        case syntax.ObjectConstant(names=names):
            type_ = _object_type(node.type, context)
            annotations = check_annotations(node.annotations, "object constant", context)
            for name in names:
                if declare_object(name, type_, context):
                    declared.object_annotations[name.text] = annotations
        case syntax.Procedure(keyword="controller", name=name) if _claim(name, context):
            parameters = check_parameters(node.parameters, context)
            declared.controllers[name.text] = Controller(name.text, parameters, None)
        case syntax.Procedure(keyword="behavior" | "action", name=name) if _claim(name, context):
            parameters = check_parameters(node.parameters, context, inferred=True)
            declared.behaviors[name.text] = Signature(name.text, parameters)
        case syntax.Procedure(keyword="generator", name=name) if _claim(name, context):
            parameters = check_parameters(node.parameters, context, inferred=True)
            declared.generators[name.text] = Signature(name.text, parameters)
        case _:
            return


def declare_object(name: syntax.Name, type_: Type, context: Context) -> bool:
    """Add an object or constant; False when its name is taken."""
    if not _claim(name, context):
        return False
    location = context.location(name.span)
    context.declarations.objects[name.text] = Object(name.text, type_, location=location)
    return True


def _claim(name: syntax.Name, context: Context) -> bool:
    """Take a name for a definition; a second claim is reported and refused."""
    declared = context.declarations
    location = context.location(name.span)
    if name.text in BUILTIN_FUNCTIONS:
        context.found.add(errors.HidesDefinition(location=location, name=name.text, defined=None))
        return False
    first = declared.places.get(name.text)
    if first is not None:
        context.found.add(
            errors.DuplicateDefinition(location=location, name=name.text, first=first)
        )
        return False
    declared.places[name.text] = location
    return True


def _object_type(written: syntax.Type, context: Context) -> Type:
    type_ = resolve_type(written, context)
    if not isinstance(type_, ObjectType | UnknownType):
        location = context.location(written.span)
        context.found.add(errors.NotAnObjectType(location=location, type=type_))
        return UnknownType()
    return type_


def _feature(node: syntax.Feature, context: Context) -> Feature:
    parameters = check_parameters(node.parameters, context)
    for index, (written, parameter) in enumerate(zip(node.parameters, parameters, strict=True)):
        if written.type is not None and not isinstance(parameter.type, ObjectType | UnknownType):
            location = context.location(written.type.span)
            context.found.add(errors.ValueIndex(location=location, type=parameter.type))
            unknown = replace(parameter, type=UnknownType())
            parameters = (*parameters[:index], unknown, *parameters[index + 1 :])
    type_ = BOOL if node.type is None else resolve_type(node.type, context)
    return Feature(
        node.name.text,
        parameters,
        type_,
        annotations=check_annotations(node.annotations, "feature", context, type_),
        location=context.location(node.name.span),
    )


def _function(node: syntax.Function, context: Context) -> Function:
    return Function(
        node.name.text,
        check_parameters(node.parameters, context),
        BOOL if node.type is None else resolve_type(node.type, context),
        None,
        location=context.location(node.name.span),
    )


def constants(declared: Declarations) -> tuple[ObjectConstant, ...]:
    """The object constants declared so far, in source order."""
    return tuple(
        ObjectConstant(
            o.name,
            o.type,
            annotations=declared.object_annotations.get(o.name, ()),
            location=o.location,
        )
        for o in declared.objects.values()
    )


def objects_of(node: syntax.Objects, context: Context) -> Iterator[Parameter]:
    """Declare the objects of a problem file and yield them."""
    for line in node.lines:
        if isinstance(line, syntax.ErrorStatement):
            continue
        type_ = _object_type(line.type, context)
        for name in line.names:
            if declare_object(name, type_, context):
                yield Parameter(name.text, type_, location=context.location(name.span))
