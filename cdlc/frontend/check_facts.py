"""Plain facts of `init:`, `f[a, b] = True`, checked in one go, since there may be very many.

Whatever is out of the ordinary is left to the general way; a test holds the two against each other.
"""

from cdlc.frontend import syntax
from cdlc.frontend.scope import Context
from crow.program import BOOL, Assign, Constant, Expression, Location, Object


def check_fact(node: syntax.Statement, context: Context) -> Assign | None:
    """A truth value for a Boolean feature of declared objects; None where it is anything else."""
    match node:
        case syntax.Assignment(
            target=syntax.Call(name=name, arguments=written, bracketed=True),
            operator="=",
            value=syntax.Literal(value=bool() as value) as literal,
            annotations=(),
        ):
            pass
        case _:
            return None
    declared = context.declarations
    feature = declared.features.get(name.text)
    if feature is None or feature.type is not BOOL or len(feature.parameters) != len(written):
        return None
    whole = context.location(node.span)
    if whole.line != whole.end_line:
        return None
    file, line, offset = whole.file, whole.line, node.span.start - whole.column
    arguments: list[Expression] = []
    for argument, parameter in zip(written, feature.parameters, strict=True):
        known = declared.objects.get(getattr(argument, "name", ""))
        if known is None or not isinstance(argument, syntax.NameExpression):
            return None
        if not declared.fits(known.type, parameter.type):
            return None
        start, end = argument.span
        place = Location(file, line, start - offset, line, end - offset)
        arguments.append(Object(known.name, known.type, location=place))
    start, end = literal.span
    place = Location(file, line, start - offset, line, end - offset)
    constant = Constant(value, BOOL, location=place)
    return Assign(feature.name, tuple(arguments), "=", constant, location=whole)
