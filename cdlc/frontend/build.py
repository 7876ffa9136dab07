"""From the parser's reductions to syntax nodes: one method a rule of cdl.lark."""

import ast
from dataclasses import replace
from typing import Any, cast

from lark import Token, Transformer, v_args

from cdlc.frontend import syntax
from cdlc.source import Span


def token_span(token: Token) -> Span:
    """Where a token stands; one read in place of another stands where that did."""
    start = token.start_pos or 0
    return Span(start, start + len(token) if token.end_pos is None else token.end_pos)


def _span(first: Any, last: Any = None) -> Span:
    last = first if last is None else last
    start = token_span(first) if isinstance(first, Token) else first.span
    end = token_span(last) if isinstance(last, Token) else last.span
    return Span(start.start, end.end)


def string_value(token: Token) -> str:
    """The text a string token stands for."""
    try:
        return cast("str", ast.literal_eval(str(token)))
    except (SyntaxError, ValueError):  # an escape Python does not know: take it as it stands
        return str(token)[1:-1]


def integer_value(token: str) -> int:
    """The value of a whole number; one with more digits than any width holds is 10**40."""
    # int() is quadratic and Python refuses over 4,300.
    return int(token) if len(token) <= 40 else 10**40


@v_args(inline=True)
class Builder(Transformer[Token, Any]):
    """Callbacks of the LALR parser; stateless, so one instance serves every thread."""

    # names and types

    def name(self, token: Token) -> syntax.Name:
        return syntax.Name(str(token), span=token_span(token))

    variable = name

    def names(self, *names: syntax.Name) -> tuple[syntax.Name, ...]:
        return names

    def named_type(self, name: syntax.Name) -> syntax.Type:
        return syntax.NamedType(name.text, span=name.span)

    def vector_type(
        self, name: syntax.Name, element: syntax.Type, n: Token | None = None
    ) -> syntax.Type:
        length = None if n is None else integer_value(n)
        return syntax.VectorType(name, element, length, span=_span(name, n or element))

    def list_of_named(self, name: syntax.Name) -> syntax.Type:
        return self.list_type(syntax.NamedType(name.text, span=name.span))

    def list_type(self, element: syntax.Type) -> syntax.Type:
        return syntax.ListType(element, span=element.span)

    def parameter(self, name: syntax.Name, type_: syntax.Type | None) -> syntax.TypedName:
        return syntax.TypedName(name, type_, span=_span(name, type_))

    def parameters(self, *parameters: syntax.TypedName | None) -> tuple[syntax.TypedName, ...]:
        return tuple(p for p in parameters if p is not None)

    def last_typed(self, name: syntax.Name, type_: syntax.Type) -> tuple[syntax.TypedName, ...]:
        return (self.parameter(name, type_),)

    def last_untyped(self, name: syntax.Name) -> tuple[syntax.TypedName, ...]:
        return (self.parameter(name, None),)

    def typed_then(
        self, name: syntax.Name, type_: syntax.Type, rest: tuple[syntax.TypedName, ...]
    ) -> tuple[syntax.TypedName, ...]:
        return (self.parameter(name, type_), *rest)

    def untyped_then(
        self, name: syntax.Name, rest: tuple[syntax.TypedName, ...]
    ) -> tuple[syntax.TypedName, ...]:
        return (self.parameter(name, None), *rest)

    # expressions

    def integer(self, token: Token) -> syntax.Expression:
        return syntax.Literal(integer_value(token), span=token_span(token))

    def float(self, token: Token) -> syntax.Expression:
        return syntax.Literal(float(token), span=token_span(token))

    def string(self, token: Token) -> syntax.Expression:
        return syntax.Literal(string_value(token), span=token_span(token))

    def true(self, token: Token) -> syntax.Expression:
        return syntax.Literal(True, span=token_span(token))  # noqa: FBT003 - a value

    def false(self, token: Token) -> syntax.Expression:
        return syntax.Literal(False, span=token_span(token))  # noqa: FBT003 - a value

    def negative_integer(self, minus: Token, token: Token) -> syntax.Expression:
        return syntax.Literal(-integer_value(token), span=_span(minus, token))

    def negative_float(self, minus: Token, token: Token) -> syntax.Expression:
        return syntax.Literal(-float(token), span=_span(minus, token))

    def name_expression(self, name: syntax.Name) -> syntax.Expression:
        return syntax.NameExpression(name.text, span=name.span)

    def arguments(self, *arguments: syntax.Expression | None) -> tuple[syntax.Expression, ...]:
        return tuple(a for a in arguments if a is not None)

    def ellipsis(self, token: Token) -> syntax.Expression:
        return syntax.Ellipsis_(span=token_span(token))

    def call(
        self,
        name: syntax.Name,
        _open: Token,
        arguments: tuple[syntax.Expression, ...],
        close: Token,
    ) -> syntax.Call:
        return syntax.Call(name, arguments, False, span=_span(name, close))  # noqa: FBT003

    def index(
        self, open_: Token, elements: tuple[syntax.Expression, ...], close: Token
    ) -> syntax.VectorLiteral:
        return syntax.VectorLiteral(elements, span=_span(open_, close))

    def vector(self, index: syntax.VectorLiteral) -> syntax.Expression:
        return index

    def call_expression(self, call: syntax.Call) -> syntax.Expression:
        return call

    def index_expression(self, name: syntax.Name, index: syntax.VectorLiteral) -> syntax.Call:
        return syntax.Call(name, index.elements, True, span=_span(name, index))  # noqa: FBT003

    def not_(self, word: Token, operand: syntax.Expression) -> syntax.Expression:
        return syntax.Unary("not", operand, span=_span(word, operand))

    def negative(self, minus: Token, operand: syntax.Expression) -> syntax.Expression:
        return syntax.Unary("-", operand, span=_span(minus, operand))

    def and_(self, *operands: syntax.Expression) -> syntax.Expression:
        return _connective("and", operands)

    def or_(self, *operands: syntax.Expression) -> syntax.Expression:
        return _connective("or", operands)

    def xor(self, left: syntax.Expression, right: syntax.Expression) -> syntax.Expression:
        return syntax.Binary("^", left, right, span=_span(left, right))

    def binary(
        self, left: syntax.Expression, operator: Token, right: syntax.Expression
    ) -> syntax.Expression:
        return syntax.Binary(cast("Any", str(operator)), left, right, span=_span(left, right))

    def comparison_operator(self, token: Token) -> str:
        return str(token)

    def comparison(self, *parts: Any) -> syntax.Expression:
        return syntax.Comparison(parts[1::2], parts[::2], span=_span(parts[0], parts[-1]))

    def conditional(
        self, then: syntax.Expression, condition: syntax.Expression, otherwise: syntax.Expression
    ) -> syntax.Expression:
        return syntax.Conditional(condition, then, otherwise, span=_span(then, otherwise))

    def quantified(
        self,
        word: Token,
        variables: tuple[syntax.TypedName, ...],
        where: syntax.Expression | None,
        body: syntax.Expression,
    ) -> syntax.Expression:
        kind = cast("Any", str(word))
        return syntax.Quantified(kind, variables, where, body, span=_span(word, body))

    def error(self, token: Token) -> syntax.ErrorStatement:
        return syntax.ErrorStatement(span=token_span(token))

    def broken_block(self, token: Token, _statements: Any) -> syntax.ErrorStatement:
        return self.error(token)

    # annotations

    def annotation_item(self, name: syntax.Name, value: Any) -> syntax.Annotation:
        return syntax.Annotation(name, value, span=_span(name, value))

    def annotation(self, *items: syntax.Annotation | None) -> tuple[syntax.Annotation, ...]:
        return tuple(item for item in items if item is not None)

    def annotations(self, *lists: tuple[syntax.Annotation, ...]) -> tuple[syntax.Annotation, ...]:
        return tuple(item for items in lists for item in items)

    # statements

    def suite(self, *parts: Any) -> tuple[syntax.Statement, ...]:
        return tuple(s for part in parts for s in (part if isinstance(part, tuple) else (part,)))

    def simple_statements(
        self, *statements: syntax.Statement | None
    ) -> tuple[syntax.Statement, ...]:
        return tuple(s for s in statements if s is not None)

    def statement(self, *parts: Any) -> tuple[syntax.Statement, ...]:
        if len(parts) == 1:
            return cast("tuple[syntax.Statement, ...]", parts[0])
        return (self.simple_statement(*parts),)

    def simple_statement(
        self, annotations: tuple[syntax.Annotation, ...], statement: Any
    ) -> syntax.Statement:
        if not annotations:
            return cast("syntax.Statement", statement)
        return cast("syntax.Statement", _annotate(statement, annotations))

    def let(
        self, word: Token, name: syntax.Name, type_: syntax.Type | None, value: syntax.Expression
    ) -> syntax.Statement:
        return syntax.Let(name, type_, value, span=_span(word, value))

    def assert_(self, word: Token, condition: syntax.Expression) -> syntax.Statement:
        return syntax.Assert(condition, span=_span(word, condition))

    def achieve(self, word: Token, condition: syntax.Expression) -> syntax.Statement:
        return syntax.Achieve(condition, False, span=_span(word, condition))  # noqa: FBT003

    def achieve_once(self, word: Token, condition: syntax.Expression) -> syntax.Statement:
        return syntax.Achieve(condition, True, span=_span(word, condition))  # noqa: FBT003

    def do(self, word: Token, call: syntax.Call) -> syntax.Statement:
        return syntax.CallStatement(call, True, span=_span(word, call))  # noqa: FBT003

    def call_statement(self, call: syntax.Call) -> syntax.Statement:
        return syntax.CallStatement(call, False, span=call.span)  # noqa: FBT003

    def assignment_operator(self, token: Token) -> str:
        return str(token)

    def call_assignment(
        self, target: syntax.Call, operator: Any, value: syntax.Expression
    ) -> syntax.Statement:
        return syntax.Assignment(target, operator, value, span=_span(target, value))

    def name_assignment(
        self, name: syntax.Name, operator: Any, value: syntax.Expression
    ) -> syntax.Statement:
        target = syntax.NameExpression(name.text, span=name.span)
        return syntax.Assignment(target, operator, value, span=_span(name, value))

    def index_assignment(
        self,
        name: syntax.Name,
        index: syntax.VectorLiteral,
        operator: Any,
        value: syntax.Expression,
    ) -> syntax.Statement:
        target = self.index_expression(name, index)
        return syntax.Assignment(target, operator, value, span=_span(name, value))

    def bind(self, word: Token, variables: tuple[syntax.TypedName, ...]) -> syntax.Statement:
        return syntax.Bind(variables, "free", None, span=_span(word, variables[-1]))

    def bind_where(
        self, word: Token, variables: tuple[syntax.TypedName, ...], condition: syntax.Expression
    ) -> syntax.Statement:
        return syntax.Bind(variables, "where", condition, span=_span(word, condition))

    def bind_equal(
        self, word: Token, variables: tuple[syntax.TypedName, ...], value: syntax.Expression
    ) -> syntax.Statement:
        return syntax.Bind(variables, "equal", value, span=_span(word, value))

    def bind_call(self, word: Token, name: syntax.Name, call: syntax.Call) -> syntax.Statement:
        return syntax.Bind(self.last_untyped(name), "call", call, span=_span(word, call))

    def condition_block(self, condition: Any) -> syntax.Expression:
        return _expression(condition)

    def commit(self, word: Token) -> syntax.Statement:
        return syntax.Word(cast("Any", str(word)), span=token_span(word))

    break_ = continue_ = pass_ = commit

    def return_(self, word: Token, value: syntax.Expression) -> syntax.Statement:
        return syntax.Return(value, span=_span(word, value))

    def group_order(self, token: Token) -> Token:
        return token

    def group(self, order: Token, body: tuple[syntax.Statement, ...]) -> syntax.Statement:
        return syntax.Group(cast("Any", str(order)), body, span=token_span(order))

    def promotable(
        self, word: Token, order: Token | None, body: tuple[syntax.Statement, ...]
    ) -> syntax.Statement:
        kind = None if order is None else cast("Any", str(order))
        return syntax.Promotable(kind, body, span=_span(word, order))

    def foreach(self, word: Token, *parts: Any) -> syntax.Statement:
        variables, body = parts[-2:]
        return syntax.ForEach(variables, body, span=_span(word, variables[-1]))

    def for_range(
        self,
        word: Token,
        variable: syntax.Name,
        function: syntax.Name,
        arguments: tuple[syntax.Expression, ...],
        body: tuple[syntax.Statement, ...],
    ) -> syntax.Statement:
        end = arguments[-1] if arguments else function
        return syntax.ForRange(variable, function, arguments, body, span=_span(word, end))

    def elif_(self, condition: syntax.Expression, body: Any) -> Any:
        return (condition, body)

    def if_(
        self, word: Token, condition: syntax.Expression, body: Any, *rest: Any
    ) -> syntax.Statement:
        branches = ((condition, body), *rest[:-1])
        return syntax.If(branches, rest[-1], span=_span(word, condition))

    # definitions

    def title(self, word: Token, text: Token) -> syntax.Definition:
        return syntax.Title(cast("Any", str(word)), string_value(text), span=_span(word, text))

    def include(self, word: Token, path: Token) -> syntax.Definition:
        return syntax.Include(string_value(path), span=_span(word, path))

    def typedef(
        self, word: Token, annotations: Any, name: syntax.Name, base: syntax.Type | None
    ) -> syntax.Definition:
        return syntax.TypeDefinition(
            name, base, annotations=annotations, span=_span(word, base or name)
        )

    def object_constant(self, word: Token, annotations: Any, *rest: Any) -> syntax.Definition:
        span = _span(word, rest[-1])
        return syntax.ObjectConstant(rest[:-1], rest[-1], annotations=annotations, span=span)

    def feature(
        self, word: Token, annotations: Any, name: syntax.Name, parameters: Any, type_: Any
    ) -> syntax.Definition:
        span = _span(word, type_ or name)
        return syntax.Feature(name, parameters, type_, annotations=annotations, span=span)

    def function(
        self, word: Token, annotations: Any, name: syntax.Name, parameters: Any, *rest: Any
    ) -> syntax.Definition:
        type_, body = (*rest, None)[:2]
        span = _span(word, type_ or name)
        return syntax.Function(name, parameters, type_, body, annotations=annotations, span=span)

    def procedure(
        self, word: Token, annotations: Any, name: syntax.Name, parameters: Any, sections: Any = ()
    ) -> syntax.Definition:
        keyword, span = cast("Any", str(word)), _span(word, name)
        return syntax.Procedure(
            keyword, name, parameters, sections, annotations=annotations, span=span
        )

    controller = behavior = generator = procedure

    def sections(self, *sections: syntax.Section) -> tuple[syntax.Section, ...]:
        return sections

    def goal(self, word: Token, condition: Any) -> syntax.Definition:
        if isinstance(condition, tuple):
            return syntax.Goal(*condition, span=_span(word, condition[1]))
        return syntax.Goal(_expression(condition), None, span=_span(word, condition))

    def equation(self, left: syntax.Expression, right: syntax.Expression) -> Any:
        return (left, right)

    def body(self, word: Token, statements: tuple[syntax.Statement, ...]) -> syntax.Section:
        return syntax.Body(statements, span=token_span(word))

    def eff(self, word: Token, statements: tuple[syntax.Statement, ...]) -> syntax.Section:
        return syntax.Effect(statements, span=token_span(word))

    def inputs(self, word: Token, names: tuple[syntax.Name, ...] | None) -> syntax.Section:
        return syntax.Direction(cast("Any", str(word)), names or (), span=token_span(word))

    outputs = inputs

    # problem files

    def objects(self, word: Token, *lines: Any) -> syntax.Definition:
        return syntax.Objects(lines, span=token_span(word))

    def objects_line(
        self, names: tuple[syntax.Name, ...], type_: syntax.Type
    ) -> syntax.ObjectsLine:
        return syntax.ObjectsLine(names, type_, span=_span(names[0], type_))

    def init(self, word: Token, statements: tuple[syntax.Statement, ...]) -> syntax.Definition:
        return syntax.Init(statements, span=token_span(word))

    def minimize(self, word: Token, expression: Any) -> syntax.Definition:
        return syntax.Minimize(_expression(expression), span=_span(word, expression))

    def file(self, *definitions: syntax.Definition) -> tuple[syntax.Definition, ...]:
        return definitions


def _expression(node: Any) -> syntax.Expression:
    if isinstance(node, syntax.ErrorStatement):
        return syntax.ErrorExpression(span=node.span)
    return cast("syntax.Expression", node)


def _connective(operator: Any, operands: tuple[syntax.Expression, ...]) -> syntax.Expression:
    """`a and b and …` as one node, also where the first part is in parentheses."""
    span = _span(operands[0], operands[-1])
    first = operands[0]
    if isinstance(first, syntax.Connective) and first.operator == operator:
        operands = (*first.operands, *operands[1:])
    return syntax.Connective(operator, operands, span=span)


def _annotate(statement: syntax.Annotated, annotations: tuple[syntax.Annotation, ...]) -> Any:
    return replace(statement, annotations=annotations)
