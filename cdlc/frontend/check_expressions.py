"""Expressions: names resolved, types worked out and checked (language.md §4).

An expression in error gets the unknown type, which fits everywhere, so that one mistake gives one
message. Arithmetic laws are not applied here; see ir/.
"""

from math import isinf
from typing import assert_never

from cdlc.frontend import errors, syntax
from cdlc.frontend.check_types import check_variables, introduce
from cdlc.frontend.operators import (
    are_comparable,
    arithmetic_type,
    common_type,
    is_arithmetic,
    wider,
)
from cdlc.frontend.scope import BUILTIN_FUNCTIONS, MAX_DEPTH, Context, Scope, are_related
from crow.program import (
    BOOL,
    FLOAT64,
    INT32,
    INT64,
    STRING,
    UNKNOWN,
    And,
    Apply,
    Arithmetic,
    Builtin,
    Compare,
    Conditional,
    Constant,
    Expression,
    Feature,
    Function,
    ListType,
    Location,
    Negative,
    Not,
    Object,
    ObjectType,
    Or,
    Parameter,
    Quantified,
    Read,
    Type,
    UnknownType,
    Variable,
    Vector,
    VectorType,
    Xor,
)
from crow.program.types import is_number, underlying


def check_condition(node: syntax.Expression, scope: Scope, context: Context) -> Expression:
    """A Boolean expression; another type is reported."""
    return check_value(node, BOOL, scope, context)


def check_value(
    node: syntax.Expression,
    expected: Type,
    scope: Scope,
    context: Context,
    declared: Parameter | Feature | None = None,
) -> Expression:
    """An expression that must fit a type; `declared` is shown as the reason."""
    expression = check_expression(node, scope, context, expected)
    if not context.declarations.fits(expression.type, expected):
        context.found.add(
            errors.WrongType(
                location=context.location(node.span),
                expected=f"`{expected}`",
                found=expression.type,
                declared=None if declared is None else declared.location,
            )
        )
    elif underlying(expected) == INT32 and not _is_within_int32(expression):
        location = context.location(node.span)
        context.found.add(errors.NumberTooLarge(location=location, bits=32))
    return expression


def _is_within_int32(expression: Expression) -> bool:
    match expression:
        case Constant(value=int(value)):
            return value < 2**31
        case Negative(operand=Constant(value=int(value))):
            return value <= 2**31
        case _:
            return True


def check_expression(
    node: syntax.Expression, scope: Scope, context: Context, expected: Type = UNKNOWN
) -> Expression:
    """The typed form of an expression; `expected` guides vector literals only."""
    context.depth += 1
    try:
        if context.depth <= MAX_DEPTH:
            return _check(node, scope, context, expected)
        if not context.is_too_deep:
            location = context.location(node.span)
            context.found.add(errors.NestingTooDeep(location=location, limit=MAX_DEPTH))
        context.is_too_deep = True
        return _error(node, context)
    finally:
        context.depth -= 1
        context.is_too_deep = context.is_too_deep and context.depth > 0


def _check(node: syntax.Expression, scope: Scope, context: Context, expected: Type) -> Expression:
    match node:
        case syntax.Literal(value=value):
            return _literal(node, value, context)
        case syntax.NameExpression(name=name):
            return _name(node, name, scope, context)
        case syntax.Call():
            return check_call(node, scope, context)
        case _:
            return _check_operation(node, scope, context, expected)


def _check_operation(
    node: syntax.Expression, scope: Scope, context: Context, expected: Type
) -> Expression:
    location = context.location(node.span)
    match node:
        case syntax.Literal() | syntax.NameExpression() | syntax.Call():
            raise AssertionError(node)
        case syntax.Ellipsis_():
            context.found.add(errors.Elision(location=location))
            return _error(node, context)
        case syntax.VectorLiteral(elements=elements):
            return _vector(node, elements, expected, scope, context)
        case syntax.Unary(operator="not", operand=operand):
            return Not(check_condition(operand, scope, context), location=location)
        case syntax.Unary(operand=operand):
            return _negative(node, operand, scope, context)
        case syntax.Connective(operator=operator, operands=operands):
            checked = tuple(check_condition(o, scope, context) for o in operands)
            return (And if operator == "and" else Or)(checked, location=location)
        case syntax.Binary(operator="^", left=left, right=right):
            sides = check_condition(left, scope, context), check_condition(right, scope, context)
            return Xor(*sides, location=location)
        case syntax.Binary():
            return _arithmetic(node, scope, context)
        case syntax.Comparison():
            return _comparison(node, scope, context)
        case syntax.Conditional():
            return _conditional(node, scope, context, expected)
        case syntax.Quantified():
            return _quantified(node, scope, context)
        case syntax.ErrorExpression():
            return _error(node, context)
        case _:
            assert_never(node)


def _error(node: syntax.Node, context: Context) -> Expression:
    return Constant(False, UNKNOWN, location=context.location(node.span))  # noqa: FBT003


def _literal(
    node: syntax.Expression, value: bool | int | float | str, context: Context
) -> Expression:
    location = context.location(node.span)
    match value:
        case bool():
            return Constant(value, BOOL, location=location)
        case int():
            if abs(value) >= 2**63:
                context.found.add(errors.NumberTooLarge(location=location))
                return _error(node, context)
            return Constant(value, INT64, location=location)
        case float():
            if isinf(value):
                context.found.add(errors.NumberTooLarge(location=location))
                return _error(node, context)
            return Constant(value, FLOAT64, location=location)
        case str():
            return Constant(value, STRING, location=location)
        case _:
            assert_never(value)


def _name(node: syntax.Expression, name: str, scope: Scope, context: Context) -> Expression:
    location = context.location(node.span)
    declared = context.declarations
    local = scope.get(name)
    if local is not None:
        return Variable(name, local.variable.type, location=location)
    if name in declared.objects:
        known = declared.objects[name]
        return Object(name, known.type, location=location)
    if name in declared.features:
        return _read(declared.features[name], (), node, scope, context)
    if (kind := declared.kind(name)) is not None:
        context.found.add(_wrong_kind(node, name, kind, "value", context))
    else:
        known_names = context.known_values(scope)
        context.found.add(errors.UnknownName(location=location, name=name, known=known_names))
    return _error(node, context)


def _wrong_kind(
    node: syntax.Node, name: str, kind: str, wanted: str, context: Context
) -> "errors.WrongKind":
    advice = {
        "function": f"call it: `{name}(…)`",
        "controller": f"controllers are run in a body: `do {name}(…)`",
        "behavior": f"behaviors are called in a body: `{name}(…)`",
    }
    return errors.WrongKind(
        location=context.location(node.span),
        name=name,
        is_a=kind,
        wanted=wanted,
        advice=advice.get(kind, ""),
        defined=context.declarations.places.get(name),
    )


def check_call(node: syntax.Call, scope: Scope, context: Context) -> Expression:
    """A read of a feature or a call of a function."""
    name, declared = node.name.text, context.declarations
    location = context.location(node.name.span)
    if name in declared.features:
        return _read(declared.features[name], node.arguments, node, scope, context)
    if name in declared.functions and not node.bracketed:
        return _apply(declared.functions[name], node, scope, context)
    local = scope.get(name)
    if name in BUILTIN_FUNCTIONS and not node.bracketed and local is None:
        return _builtin(node, scope, context)
    kind = "variable" if local is not None else declared.kind(name)
    if kind is None:
        known = [*declared.features, *declared.functions, *BUILTIN_FUNCTIONS]
        context.found.add(errors.UnknownFeature(location=location, name=name, known=known))
    else:
        wanted = "feature" if node.bracketed else "feature or function"
        context.found.add(_wrong_kind(node.name, name, kind, wanted, context))
    for argument in node.arguments:
        if not isinstance(argument, syntax.Ellipsis_):
            check_expression(argument, scope, context)
    return _error(node, context)


def _read(
    feature: Feature,
    arguments: tuple[syntax.Expression, ...],
    node: syntax.Expression,
    scope: Scope,
    context: Context,
) -> Expression:
    if (
        not feature.parameters
        and len(arguments) == 1
        and isinstance(arguments[0], syntax.Ellipsis_)
    ):
        arguments = ()
    checked = check_arguments(
        feature.name, feature.parameters, feature.location, arguments, node, scope, context
    )
    return Read(feature.name, checked, feature.type, location=context.location(node.span))


def _apply(function: Function, node: syntax.Call, scope: Scope, context: Context) -> Expression:
    checked = check_arguments(
        function.name,
        function.parameters,
        function.location,
        node.arguments,
        node,
        scope,
        context,
    )
    location = context.location(node.span)
    return Apply(function.name, checked, function.type, location=location)


def check_arguments(
    name: str,
    parameters: tuple[Parameter, ...],
    declared: Location | None,
    arguments: tuple[syntax.Expression, ...],
    node: syntax.Node,
    scope: Scope,
    context: Context,
) -> tuple[Expression, ...]:
    """Check the arguments of a call or read against the parameters, their number first."""
    elided = [a for a in arguments if isinstance(a, syntax.Ellipsis_)]
    for ellipsis in elided:
        context.found.add(errors.Elision(location=context.location(ellipsis.span)))
    if len(arguments) != len(parameters) and not elided:
        context.found.add(
            errors.WrongArgumentCount(
                location=context.location(node.span),
                name=name,
                expected=len(parameters),
                found=len(arguments),
                declared=declared,
            )
        )
    checked = []
    for index, argument in enumerate(arguments):
        if isinstance(argument, syntax.Ellipsis_):
            continue
        expected = parameters[index] if index < len(parameters) else None
        checked.append(_argument(name, expected, argument, scope, context))
    return tuple(checked)


def _argument(
    name: str,
    expected: Parameter | None,
    argument: syntax.Expression,
    scope: Scope,
    context: Context,
) -> Expression:
    wanted = UNKNOWN if expected is None else expected.type
    expression = check_expression(argument, scope, context, wanted)
    if context.declarations.fits(expression.type, wanted):
        return expression
    if name in context.declarations.features and not isinstance(expression.type, ObjectType):
        context.found.add(
            errors.ValueIndex(
                location=context.location(argument.span),
                type=expression.type,
                feature=name,
                declared=None if expected is None else expected.location,
            )
        )
    else:
        context.found.add(
            errors.WrongArgumentType(
                location=context.location(argument.span),
                name=name,
                expected=wanted,
                found=expression.type,
                declared=None if expected is None else expected.location,
                fitting=_only_fitting(wanted, scope, context),
            )
        )
    return expression


def _only_fitting(wanted: Type, scope: Scope, context: Context) -> str | None:
    """The one local that would have fitted, for a suggestion."""
    fits = context.declarations.fits
    names = [n for n, local in scope.locals.items() if fits(local.variable.type, wanted)]
    return names[0] if len(names) == 1 else None


def _builtin(node: syntax.Call, scope: Scope, context: Context) -> Expression:
    name = node.name.text
    location = context.location(node.span)
    arguments = tuple(check_number(a, scope, context) for a in node.arguments)
    if (name == "abs") != (len(arguments) == 1) or not arguments:
        context.found.add(
            errors.WrongArgumentCount(
                location=location,
                name=name,
                expected=1 if name == "abs" else 2,
                found=len(arguments),
                declared=None,
            )
        )
        return _error(node, context)
    type_ = arguments[0].type
    for written, argument in zip(node.arguments[1:], arguments[1:], strict=True):
        if not are_related(type_, argument.type):
            place = context.location(written.span)
            context.found.add(
                errors.WrongType(location=place, expected=f"`{type_}`", found=argument.type)
            )
            return _error(node, context)
        type_ = wider(type_, argument.type)
    assert name in ("min", "max", "abs")
    return Builtin(name, arguments, type_, location=location)  # type: ignore[arg-type]


def check_number(node: syntax.Expression, scope: Scope, context: Context) -> Expression:
    """An expression that is a number; another type is reported."""
    expression = check_expression(node, scope, context)
    if not is_number(expression.type) and not isinstance(expression.type, UnknownType):
        location = context.location(node.span)
        context.found.add(
            errors.WrongType(location=location, expected="a number", found=expression.type)
        )
        return _error(node, context)
    return expression


def _negative(
    node: syntax.Expression, operand: syntax.Expression, scope: Scope, context: Context
) -> Expression:
    if isinstance(operand, syntax.Literal) and operand.value == 2**63:
        return Constant(-(2**63), INT64, location=context.location(node.span))
    checked = check_expression(operand, scope, context)
    location = context.location(node.span)
    vector = isinstance(underlying(checked.type), VectorType)
    if not vector and not is_number(checked.type) and checked.type != UNKNOWN:
        context.found.add(
            errors.WrongType(location=location, expected="a number", found=checked.type)
        )
        return _error(node, context)
    return Negative(checked, checked.type, location=location)


def _vector(
    node: syntax.Expression,
    elements: tuple[syntax.Expression, ...],
    expected: Type,
    scope: Scope,
    context: Context,
) -> Expression:
    location = context.location(node.span)
    match underlying(expected):
        case VectorType(element, length):
            checked = tuple(check_value(e, element, scope, context) for e in elements)
            if length is not None and length != len(checked):
                found = VectorType(element, len(checked))
                context.found.add(
                    errors.WrongType(location=location, expected=f"`{expected}`", found=found)
                )
            return Vector(checked, expected, location=location)
        case ListType(element):
            checked = tuple(check_value(e, element, scope, context) for e in elements)
            return Vector(checked, expected, location=location)
        case _:
            checked = tuple(check_expression(e, scope, context) for e in elements)
            type_ = _element_type(checked, context)
            if isinstance(type_, UnknownType):
                return _error(node, context)
            if is_number(type_):
                return Vector(checked, VectorType(type_, len(checked)), location=location)
            return Vector(checked, ListType(type_), location=location)


def _element_type(elements: tuple[Expression, ...], context: Context) -> Type:
    """The type that all elements of a literal fit; the first that does not fit is reported."""
    type_: Type = elements[0].type if elements else FLOAT64
    for element in elements[1:]:
        common = common_type(type_, element.type, context.declarations)
        if common is None:
            assert element.location is not None
            context.found.add(
                errors.WrongType(
                    location=element.location,
                    expected=f"`{type_}`",
                    found=element.type,
                    reason="the elements of a vector or list have one type",
                )
            )
            return UNKNOWN
        type_ = common
    return type_


def _arithmetic(node: syntax.Binary, scope: Scope, context: Context) -> Expression:
    left = check_expression(node.left, scope, context)
    right = check_expression(node.right, scope, context)
    location = context.location(node.span)
    type_ = arithmetic_type(node.operator, left.type, right.type, context.declarations)
    if type_ is None:
        wrong = left if not is_arithmetic(left.type) else right
        other = right if wrong is left else left
        expected = f"`{other.type}`" if is_arithmetic(wrong.type) else "a number"
        context.found.add(
            errors.WrongType(
                location=wrong.location or location, expected=expected, found=wrong.type
            )
        )
        return _error(node, context)
    assert node.operator != "^"
    return Arithmetic(node.operator, left, right, type_, location=location)


def _comparison(node: syntax.Comparison, scope: Scope, context: Context) -> Expression:
    operands = _check_alike(node.operands, scope, context)
    parts: list[Expression] = []
    for operator, left, right in zip(node.operators, operands, operands[1:], strict=False):
        location = context.location(node.span)
        if not are_comparable(operator, left.type, right.type, context.declarations):
            context.found.add(
                errors.NotComparable(
                    location=location, operator=operator, left=left.type, right=right.type
                )
            )
        parts.append(Compare(operator, left, right, location=location))
    if len(parts) == 1:
        return parts[0]
    return And(tuple(parts), location=context.location(node.span))


def _check_alike(
    nodes: tuple[syntax.Expression, ...], scope: Scope, context: Context
) -> list[Expression]:
    """Check operands so that a vector literal takes the type of the other side."""
    checked = {
        index: check_expression(node, scope, context)
        for index, node in enumerate(nodes)
        if not isinstance(node, syntax.VectorLiteral)
    }
    expected = next((e.type for e in checked.values()), UNKNOWN)
    return [
        checked[index] if index in checked else check_expression(node, scope, context, expected)
        for index, node in enumerate(nodes)
    ]


def _conditional(
    node: syntax.Conditional, scope: Scope, context: Context, expected: Type
) -> Expression:
    condition = check_condition(node.condition, scope, context)
    then = check_expression(node.then, scope, context, expected)
    otherwise = check_expression(node.otherwise, scope, context, expected)
    location = context.location(node.span)
    type_ = common_type(then.type, otherwise.type, context.declarations)
    if type_ is None:
        context.found.add(
            errors.WrongType(
                location=context.location(node.otherwise.span),
                expected=f"`{then.type}`",
                found=otherwise.type,
                reason="both branches of a conditional have one type",
            )
        )
        return _error(node, context)
    return Conditional(condition, then, otherwise, type_, location=location)


def _quantified(node: syntax.Quantified, scope: Scope, context: Context) -> Expression:
    variables = check_variables(node.variables, context, only_objects=True)
    scope = introduce(variables, "quantified", scope, context)
    location = context.location(node.span)
    body = check_condition(node.body, scope, context)
    if node.where is not None:
        where = check_condition(node.where, scope, context)
        if node.quantifier == "exists":
            body = And((where, body), location=location)
        else:
            body = Or((Not(where, location=where.location), body), location=location)
    return Quantified(node.quantifier, variables, body, location=location)
