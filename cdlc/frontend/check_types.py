"""Types as written to types of the program, and lists of typed names to parameters."""

from cdlc.frontend import errors, syntax
from cdlc.frontend.scope import Context, LocalKind, Scope
from crow.program import (
    UNKNOWN,
    ListType,
    ObjectType,
    Parameter,
    Type,
    UnknownType,
    VectorType,
)


def resolve_type(written: syntax.Type, context: Context) -> Type:
    """The type that was written; an unknown name is reported and gives the unknown type."""
    match written:
        case syntax.NamedType(name=name):
            return _named(name, written, context)
        case syntax.ListType(element=element):
            return ListType(resolve_type(element, context))
        case syntax.VectorType(constructor=constructor, element=element, length=length):
            if constructor.text != "vector":
                known = ["vector"]
                _unknown_type(constructor.text, constructor, known, context)
                return UNKNOWN
            return VectorType(resolve_type(element, context), length)


def _named(name: str, node: syntax.Node, context: Context) -> Type:
    types = context.declarations.types
    if name not in types:
        _unknown_type(name, node, list(types), context)
        return UNKNOWN
    return types[name]


def _unknown_type(name: str, node: syntax.Node, known: list[str], context: Context) -> None:
    location = context.location(node.span)
    context.found.add(errors.UnknownType(location=location, name=name, known=known))


def check_parameters(
    written: tuple[syntax.TypedName, ...], context: Context, *, inferred: bool = False
) -> tuple[Parameter, ...]:
    """The parameters of a definition; a name without a type is reported unless it is inferred."""
    parameters: list[Parameter] = []
    for item in written:
        type_: Type = UNKNOWN
        if item.type is not None:
            type_ = resolve_type(item.type, context)
        elif not inferred:
            location = context.location(item.span)
            context.found.add(errors.MissingType(location=location, name=item.name.text))
        parameters.append(_parameter(item.name, type_, parameters, context))
    return tuple(parameters)


def check_variables(
    written: tuple[syntax.TypedName, ...], context: Context, *, only_objects: bool
) -> tuple[Parameter, ...]:
    """The variables of a quantifier, `foreach` or `bind`: in `x, y: T` both have type `T`."""
    variables: list[Parameter] = []
    pending: list[syntax.Name] = []
    for item in written:
        pending.append(item.name)
        if item.type is None:
            continue
        type_ = resolve_type(item.type, context)
        if only_objects and not isinstance(type_, ObjectType | UnknownType):
            location = context.location(item.type.span)
            context.found.add(errors.NotAnObjectType(location=location, type=type_))
            type_ = UNKNOWN
        for name in pending:
            variables.append(_parameter(name, type_, variables, context))
        pending.clear()
    return tuple(variables)


def introduce(
    variables: tuple[Parameter, ...], kind: LocalKind, scope: Scope, context: Context
) -> Scope:
    """Add variables to the scope, warning of earlier ones they shadow."""
    inner = scope
    for variable in variables:
        earlier = scope.get(variable.name)
        if earlier is not None and variable.location is not None:
            context.found.add(
                errors.Shadowing(
                    location=variable.location,
                    name=variable.name,
                    first=earlier.variable.location,
                )
            )
        inner = inner.add(variable, kind)
    return inner


def _parameter(
    name: syntax.Name, type_: Type, earlier: list[Parameter], context: Context
) -> Parameter:
    location = context.location(name.span)
    for other in earlier:
        if other.name == name.text and other.location is not None:
            context.found.add(
                errors.DuplicateDefinition(location=location, name=name.text, first=other.location)
            )
    check_not_hiding(name, context)
    return Parameter(name.text, type_, location=location)


def check_not_hiding(name: syntax.Name, context: Context) -> None:
    """Report a parameter or local that has the name of a definition."""
    declared = context.declarations
    if declared.kind(name.text) is not None:
        location = context.location(name.span)
        defined = declared.places.get(name.text)
        context.found.add(
            errors.HidesDefinition(location=location, name=name.text, defined=defined)
        )
