"""Types, annotations and expressions as documents, with the parentheses precedence asks for."""

from collections.abc import Sequence
from enum import IntEnum
from typing import assert_never

from cdlc.frontend import syntax
from cdlc.frontend.trivia import Trivia
from cdlc.frontend.wrapping import Break, Doc, Group, Nest, Text, bracketed, concat, parens


class Level(IntEnum):
    """How tightly an expression holds together, after the rules of cdl.lark."""

    CONDITIONAL = 0
    OR = 1
    AND = 2
    NOT = 3
    COMPARISON = 4
    XOR = 5
    SUM = 6
    PRODUCT = 7
    FACTOR = 8
    POWER = 9
    PRIMARY = 10


_BINARY = {
    "^": Level.XOR,
    "+": Level.SUM,
    "-": Level.SUM,
    "*": Level.PRODUCT,
    "/": Level.PRODUCT,
    "//": Level.PRODUCT,
    "%": Level.PRODUCT,
    "**": Level.POWER,
}


def _level(node: syntax.Expression) -> Level:
    match node:
        case syntax.Conditional():
            return Level.CONDITIONAL
        case syntax.Connective(operator):
            return Level.OR if operator == "or" else Level.AND
        case syntax.Quantified():
            return Level.NOT
        case syntax.Unary(operator):
            return Level.NOT if operator == "not" else Level.FACTOR
        case syntax.Comparison():
            return Level.COMPARISON
        case syntax.Binary(operator):
            return _BINARY[operator]
        case _:
            return Level.PRIMARY


def _is_open(node: syntax.Expression) -> bool:
    """Whether an expression ends in a quantifier, which would take what follows it."""
    while True:
        match node:
            case syntax.Quantified():
                return True
            case syntax.Connective(operator, operands):
                last, least = operands[-1], _OPERAND[operator]
            case syntax.Unary("not", operand):
                last, least = operand, Level.NOT
            case syntax.Conditional(_, _, otherwise):
                last, least = otherwise, Level.CONDITIONAL
            case _:
                return False
        if _level(last) < least:  # in parentheses
            return False
        node = last


_OPERAND = {"or": Level.AND, "and": Level.NOT}


def name(node: syntax.Name) -> Text:
    """A name."""
    return Text(node.text, node.span.start)


def names(nodes: Sequence[syntax.Name]) -> Doc:
    """Names separated by commas; there are no brackets to break the line in."""
    return _listed([name(node) for node in nodes])


def typed_names(written: Trivia, nodes: Sequence[syntax.TypedName]) -> Doc:
    """`x, y: T, z: S`."""
    return _listed([typed_name(written, node) for node in nodes])


def _listed(docs: Sequence[Doc]) -> Doc:
    parts: list[Doc] = []
    for doc in docs:
        parts += (Text(", "), doc)
    return concat(*parts[1:])


def typed_name(written: Trivia, node: syntax.TypedName) -> Doc:
    """`x` or `x: T`."""
    if node.type is None:
        return name(node.name)
    return concat(name(node.name), ": ", type_(written, node.type))


def parameters(written: Trivia, after: syntax.Name, nodes: Sequence[syntax.TypedName]) -> Doc:
    """The parameters that stand after a name."""
    items = [typed_name(written, node) for node in nodes]
    return bracketed("(", items, Text(")", written.closing(after.span.end)))


def type_(written: Trivia, node: syntax.Type) -> Doc:
    """A type; it is broken only where a comment breaks it."""
    match node:
        case syntax.NamedType(text):
            return Text(text, node.span.start)
        case syntax.ListType(element):
            return concat(type_(written, element), bracketed("[", [], Text("]")))
        case syntax.VectorType(constructor, element, length):
            items = [type_(written, element)]
            if length is not None:
                items.append(Text(str(length)))
            closing = Text("]", written.closing(constructor.span.end))
            return concat(name(constructor), bracketed("[", items, closing, reluctant=True))
        case _:
            assert_never(node)


def annotations(written: Trivia, nodes: Sequence[syntax.Annotation]) -> Doc:
    """`[[a, b=1]] `, or nothing."""
    if not nodes:
        return Text("")
    items = [_annotation(written, node) for node in nodes]
    return concat(bracketed("[[", items, Text("]]")), " ")


def _annotation(written: Trivia, node: syntax.Annotation) -> Doc:
    match node.value:
        case None:
            return name(node.name)
        case syntax.Name() as value:
            return concat(name(node.name), "=", name(value))
        case syntax.Literal() as value:
            return concat(name(node.name), "=", _literal(written, value))
        case _:
            assert_never(node.value)


def _literal(written: Trivia, node: syntax.Literal) -> Text:
    return Text(written.spelling(node), node.span.start)


def standing(written: Trivia, node: syntax.Expression) -> Doc:
    """An expression outside brackets; it gets parentheses to be broken in."""
    has_brackets = isinstance(node, syntax.Call | syntax.VectorLiteral) or not _can_break(node)
    return parens(expression(written, node), has_brackets=has_brackets)


def _can_break(node: syntax.Expression) -> bool:
    """Whether lines in an expression would end outside its own brackets."""
    while isinstance(node, syntax.Unary):
        if _level(node.operand) < _level(node):
            return False
        node = node.operand
    return _level(node) not in (Level.PRIMARY, Level.POWER)


def expression(
    written: Trivia,
    node: syntax.Expression,
    least: Level = Level.CONDITIONAL,
    *,
    may_be_open: bool = True,
) -> Doc:
    """An expression for a place that takes a level or tighter, and quantifiers or not."""
    doc = _bare(written, node)
    if _needs_parentheses(node, least, may_be_open=may_be_open):
        return bracketed("(", [doc], Text(")"))
    return doc


def _needs_parentheses(node: syntax.Expression, least: Level, *, may_be_open: bool) -> bool:
    return _level(node) < least or (not may_be_open and _is_open(node))


def _is_short(node: syntax.Expression) -> bool:
    """Whether several of a kind share a line; strings are often the rows of something."""
    match node:
        case syntax.Literal(str()):
            return False
        case _:
            return _level(node) == Level.PRIMARY


def _bare(written: Trivia, node: syntax.Expression) -> Doc:
    match node:
        case syntax.Literal():
            return _literal(written, node)
        case syntax.NameExpression(text):
            return Text(text, node.span.start)
        case syntax.Ellipsis_():
            return Text("...", node.span.start)
        case syntax.Call():
            return _call(written, node)
        case syntax.VectorLiteral(elements):
            fill = all(map(_is_short, elements))
            closing = Text("]", _last(node))
            return bracketed("[", _arguments(written, elements), closing, fill=fill)
        case syntax.Unary():
            return _unary(written, node)
        case syntax.Connective(operator, operands):
            return _connective(written, operator, operands)
        case syntax.Binary():
            return _binary(written, node)
        case syntax.Comparison(operators, operands):
            first, *others = (
                _operand(written, operand, Level.XOR, may_be_open=False) for operand in operands
            )
            return _chain(first, list(zip(operators, others, strict=True)))
        case syntax.Conditional():
            return _conditional(written, node)
        case syntax.Quantified():
            return _quantified(written, node)
        case syntax.ErrorExpression():
            raise ValueError("an expression in error has no text")
        case _:
            assert_never(node)


def _last(node: syntax.Call | syntax.VectorLiteral) -> int | None:
    """The place of the closing bracket."""
    return node.span.end - 1 if node.span.end else None


def _call(written: Trivia, node: syntax.Call) -> Doc:
    opening, closing = "[]" if node.bracketed else "()"
    items = _arguments(written, node.arguments)
    return concat(name(node.name), bracketed(opening, items, Text(closing, _last(node))))


def _arguments(written: Trivia, nodes: Sequence[syntax.Expression]) -> list[Doc]:
    return [expression(written, node) for node in nodes]


def arguments(written: Trivia, after: syntax.Name, nodes: Sequence[syntax.Expression]) -> Doc:
    """The arguments that stand after a name."""
    closing = Text(")", written.closing(after.span.end))
    return bracketed("(", _arguments(written, nodes), closing)


def _unary(written: Trivia, node: syntax.Unary) -> Doc:
    if node.operator == "not":
        return concat(Text("not ", node.span.start), expression(written, node.operand, Level.NOT))
    operand = expression(written, node.operand, Level.FACTOR, may_be_open=False)
    return concat(Text("-", node.span.start), operand)


def _operand(
    written: Trivia, node: syntax.Expression, least: Level, *, may_be_open: bool = False
) -> Doc:
    """An operand; one that is broken itself is indented more than the operators around it."""
    doc = expression(written, node, least, may_be_open=may_be_open)
    if _needs_parentheses(node, least, may_be_open=may_be_open) or not _has_operands(node):
        return doc
    return Nest(doc)


def _has_operands(node: syntax.Expression) -> bool:
    """Whether the lines an expression is broken in begin with operators."""
    while isinstance(node, syntax.Unary):
        node = node.operand
    return _can_break(node) and not isinstance(node, syntax.Quantified)


def _chain(first: Doc, others: Sequence[tuple[str, Doc]]) -> Doc:
    """Operands with operators between them, which begin the lines if there are several."""
    parts = [first]
    for operator, operand in others:
        parts += (Break(" "), Text(f"{operator} "), operand)
    return Group(concat(*parts))


def _connective(written: Trivia, operator: str, operands: tuple[syntax.Expression, ...]) -> Doc:
    least, last = _OPERAND[operator], len(operands) - 1
    first, *others = (
        _operand(written, operand, least, may_be_open=index == last)
        for index, operand in enumerate(operands)
    )
    return _chain(first, [(operator, other) for other in others])


def _binary(written: Trivia, node: syntax.Binary) -> Doc:
    """Arithmetic, which groups to the left; a chain of one level is broken as a whole."""
    level = _level(node)
    if level == Level.POWER:
        base = expression(written, node.left, Level.PRIMARY, may_be_open=False)
        exponent = expression(written, node.right, Level.FACTOR, may_be_open=False)
        return concat(base, " ** ", exponent)
    others: list[tuple[str, Doc]] = []
    left: syntax.Expression = node
    while isinstance(left, syntax.Binary) and _level(left) == level:
        others.append((left.operator, _operand(written, left.right, Level(level + 1))))
        left = left.left
    return _chain(_operand(written, left, level), others[::-1])


def _conditional(written: Trivia, node: syntax.Conditional) -> Doc:
    then = _operand(written, node.then, Level.OR)
    condition = _operand(written, node.condition, Level.OR)
    otherwise = _operand(written, node.otherwise, Level.CONDITIONAL, may_be_open=True)
    return _chain(then, [("if", condition), ("else", otherwise)])


def _quantified(written: Trivia, node: syntax.Quantified) -> Doc:
    head: list[Doc] = [Text(f"{node.quantifier} ", node.span.start)]
    head.append(typed_names(written, node.variables))
    if node.where is not None:
        head += (Text(" where "), expression(written, node.where, may_be_open=False))
    return Group(concat(*head, ":", Nest(concat(Break(" "), expression(written, node.body)))))
