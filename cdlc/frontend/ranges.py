"""The bounds of `for i in range(…)`: known at compile time, and not too many (language.md §5)."""

from math import prod

from cdlc.frontend import errors, syntax
from cdlc.frontend.check_expressions import check_expression
from cdlc.frontend.scope import Context, Scope

MAX_COPIES = 10_000
# Bounds beyond this are over the limit anyway; computing them exactly could take forever.
_MAX_BITS = 256

Bounds = tuple[int, int, int]
_NONE: Bounds = (0, 0, 1)


class _NotConstantError(Exception):
    """A part of a bound that has no value at compile time, and why."""

    def __init__(self, node: syntax.Expression, reason: str) -> None:
        super().__init__(reason)
        self.node = node
        self.reason = reason


def check_range(node: syntax.ForRange, scope: Scope, context: Context) -> Bounds:
    """Start, stop and step of a loop; an empty range where the loop is in error."""
    if node.function.text != "range":
        location = context.location(node.function.span)
        name = node.function.text
        context.found.add(errors.UnknownName(location=location, name=name, known=["range"]))
        return _NONE
    location = context.location(node.span)
    if not 1 <= len(node.arguments) <= 3:
        context.found.add(
            errors.WrongArgumentCount(
                location=location,
                name="range",
                expected=1,
                most=3,
                found=len(node.arguments),
                declared=None,
            )
        )
        return _NONE
    bounds = [_bound(argument, scope, context) for argument in node.arguments]
    known = [bound for bound in bounds if bound is not None]
    if len(known) < len(bounds):
        return _NONE
    start, stop, step = (0, *known, 1) if len(known) == 1 else (*known, 1)[:3]
    if step == 0:
        _report(node.arguments[2], "the step is 0", scope, context)
        return _NONE
    return (start, stop, step) if _is_small(node, (start, stop, step), scope, context) else _NONE


def copies(bounds: Bounds) -> int:
    """How often a loop runs."""
    start, stop, step = bounds
    return max(0, (stop - start + step - (1 if step > 0 else -1)) // step)


def _is_small(node: syntax.ForRange, bounds: Bounds, scope: Scope, context: Context) -> bool:
    """Whether a loop stays within the limit together with the loops around it."""
    own = copies(bounds)
    total = own * prod(loop.copies for loop in scope.loops)
    if total <= MAX_COPIES:
        return True
    location = context.location(node.span)
    context.found.add(
        errors.UnrollLimit(
            location=location,
            variable=node.variable.text,
            copies=total,
            limit=MAX_COPIES,
            around=tuple(loop.location for loop in scope.loops),
        )
    )
    return False


def _bound(node: syntax.Expression, scope: Scope, context: Context) -> int | None:
    try:
        return _value(node, scope)
    except _NotConstantError as problem:
        _report(problem.node, problem.reason, scope, context)
    except RecursionError:
        location = context.location(node.span)
        context.found.add(errors.NestingTooDeep(location=location, limit=150))
    return None


def _report(node: syntax.Expression, reason: str, scope: Scope, context: Context) -> None:
    before = context.found.errors
    check_expression(node, scope, context)
    if context.found.errors == before:
        location = context.location(node.span)
        context.found.add(errors.RangeNotConstant(location=location, reason=reason))


def _value(node: syntax.Expression, scope: Scope) -> int:
    """The value of an integer expression without names."""
    match node:
        case syntax.Literal(value=int(value)) if not isinstance(value, bool):
            return value
        case syntax.Unary(operator="-", operand=operand):
            return -_value(operand, scope)
        case syntax.Binary(operator="^"):
            raise _NotConstantError(node, "not a whole number")
        case syntax.Binary(operator=operator, left=left, right=right):
            return _operate(node, operator, _value(left, scope), _value(right, scope))
        case syntax.Call(name=syntax.Name(text="min" | "max" as name), arguments=arguments) if (
            len(arguments) > 1
        ):
            values = [_value(argument, scope) for argument in arguments]
            return min(values) if name == "min" else max(values)
        case syntax.Call(name=syntax.Name(text="abs"), arguments=(argument,)):
            return abs(_value(argument, scope))
        case syntax.Literal():
            raise _NotConstantError(node, "not a whole number")
        case syntax.NameExpression(name=name) if (local := scope.get(name)) is not None:
            what = "changes in each iteration" if local.kind == "loop" else "varies"
            raise _NotConstantError(node, f"`{name}` {what}")
        case _:
            raise _NotConstantError(node, "depends on the state")


def _operate(node: syntax.Expression, operator: str, left: int, right: int) -> int:
    if operator in ("/", "//", "%") and right == 0:
        raise _NotConstantError(node, "division by zero")
    match operator:
        case "+":
            result = left + right
        case "-":
            result = left - right
        case "*":
            result = left * right
        case "//":
            result = left // right
        case "%":
            result = left % right
        case "**" if right >= 0:
            bits = max(1, left.bit_length()) * right
            if bits > _MAX_BITS and abs(left) > 1:
                raise _NotConstantError(node, "too large to compute")
            # Only 0, 1 and -1 come with a large exponent here.
            result = left ** (right if right < _MAX_BITS else 2 - right % 2)
        case _:
            raise _NotConstantError(node, "not a whole number")
    if result.bit_length() > _MAX_BITS:
        raise _NotConstantError(node, "too large to compute")
    return result
