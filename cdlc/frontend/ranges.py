"""The bounds of `for i in range(…)`: known at compile time, and not too many (language.md §5)."""

from cdlc.frontend import errors, syntax
from cdlc.frontend.check_expressions import check_expression
from cdlc.frontend.scope import Context, Scope

MAX_COPIES = 10_000


def check_range(node: syntax.ForRange, scope: Scope, context: Context) -> tuple[int, int, int]:
    """Start, stop and step of a loop; an empty range where the loop is in error."""
    if node.function.text != "range":
        location = context.location(node.function.span)
        name = node.function.text
        context.found.add(errors.UnknownName(location=location, name=name, known=["range"]))
        return 0, 0, 1
    bounds = [_constant(argument, scope, context) for argument in node.arguments]
    location = context.location(node.span)
    if not 1 <= len(bounds) <= 3:
        context.found.add(
            errors.WrongArgumentCount(
                location=location, name="range", expected=1, found=len(bounds), declared=None
            )
        )
        return 0, 0, 1
    known = [bound for bound in bounds if bound is not None]
    if len(known) < len(bounds):
        return 0, 0, 1
    start, stop, step = (0, *known, 1) if len(known) == 1 else (*known, 1)[:3]
    if step == 0 or len(range(start, stop, step)) > MAX_COPIES:
        copies = None if step == 0 else (stop - start) // step
        context.found.add(errors.UnrollLimit(location=location, copies=copies, limit=MAX_COPIES))
        return 0, 0, 1
    return start, stop, step


def _constant(node: syntax.Expression, scope: Scope, context: Context) -> int | None:
    """The value of an integer expression without names; other bounds are reported."""
    match node:
        case syntax.Literal(value=bool()):
            pass
        case syntax.Literal(value=int(value)):
            return value
        case syntax.Unary(operator="-", operand=operand):
            inner = _constant(operand, scope, context)
            return None if inner is None else -inner
        case syntax.Binary(operator="+" | "-" | "*" as operator, left=left, right=right):
            a, b = _constant(left, scope, context), _constant(right, scope, context)
            if a is None or b is None:
                return None
            return a + b if operator == "+" else a - b if operator == "-" else a * b
        case _:
            check_expression(node, scope, context)
    context.found.add(errors.RangeNotConstant(location=context.location(node.span)))
    return None
