"""Definitions and statements as lines: what stands on one, and how far it is indented."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import assert_never

from cdlc.frontend import syntax
from cdlc.frontend.print_expressions import (
    annotations,
    arguments,
    expression,
    name,
    names,
    parameters,
    standing,
    type_,
    typed_names,
)
from cdlc.frontend.trivia import Trivia
from cdlc.frontend.wrapping import INDENT, WIDTH, Doc, Text, concat, flat_text


@dataclass(frozen=True, slots=True)
class Line:
    """A logical line of the output; `start` is where the source has its first token.

    A line that is apart has exactly one blank line before it, others keep what they have.
    """

    level: int
    doc: Doc
    start: int
    is_apart: bool = False


def print_module(written: Trivia, module: syntax.Module) -> list[Line]:
    """The lines of a file in order."""
    printer = _Printer(written)
    previous: str | None = None
    for definition in module.definitions:
        kind = _one_line_kind(definition)
        printer.is_apart = kind is None or kind != previous
        printer.definition(definition)
        previous = kind
    return printer.lines


def _one_line_kind(node: syntax.Definition) -> str | None:
    """Of what kind a definition on a line of its own is; None for one with a block."""
    match node:
        case syntax.Function(body=None):
            return "def"
        case syntax.Procedure(keyword, sections=()):
            return keyword
        case syntax.Function() | syntax.Procedure():
            return None
        case syntax.Objects() | syntax.Init() | syntax.Goal() | syntax.Minimize():
            return None
        case _:
            return type(node).__name__


class _Printer:
    """Gathers lines; `is_apart` is said of the next one."""

    def __init__(self, written: Trivia) -> None:
        self.written = written
        self.lines: list[Line] = []
        self.is_apart = False

    def _line(self, level: int, doc: Doc, start: int) -> None:
        self.lines.append(Line(level, doc, start, self.is_apart))
        self.is_apart = False

    def _is_short(self, level: int, doc: Doc, start: int, end: int) -> bool:
        """Whether what the source has between two places fits on a line, comments and all."""
        if self.written.has_comment(start, self.written.line_end(end)):
            return False
        return level * INDENT + len(flat_text(doc)) <= WIDTH

    # -------------------------------------------------------------------------------- definitions

    def definition(self, node: syntax.Definition) -> None:
        """Print a definition, at the outermost level."""
        start = node.span.start
        match node:
            case syntax.Procedure():
                self._procedure(node)
            case syntax.Function():
                head = self._signature(Text("def ", start), node, node.type)
                if node.body is None:
                    self._line(0, head, start)
                else:
                    self._suite(0, head, start, node.body)
            case syntax.Objects():
                self._objects(node)
            case syntax.Init(statements):
                self._suite(0, Text("init", start), start, statements)
            case syntax.Goal():
                self._goal(0, node, is_block=True)
            case syntax.Minimize(value):
                doc = standing(self.written, value)
                self._labelled(0, Text("minimize", start), start, doc, value.span.start)
            case syntax.ErrorStatement():
                raise ValueError("a definition in error has no text")
            case _:
                self._line(0, self._one_line(node), start)

    def _one_line(
        self,
        node: syntax.Title
        | syntax.Include
        | syntax.TypeDefinition
        | syntax.ObjectConstant
        | syntax.Feature,
    ) -> Doc:
        written, start = self.written, node.span.start
        match node:
            case syntax.Title(keyword):
                return Text(f"{keyword} {written.string(node)}", start)
            case syntax.Include():
                return Text(f"include {written.string(node)}", start)
            case syntax.TypeDefinition(base=base):
                notes = annotations(written, node.annotations)
                head = concat(Text("typedef ", start), notes, name(node.name))
                return head if base is None else concat(head, ": ", type_(written, base))
            case syntax.ObjectConstant(nodes, kind):
                notes = annotations(written, node.annotations)
                head = concat(Text("object_constant ", start), notes, names(nodes))
                return concat(head, ": ", type_(written, kind))
            case syntax.Feature():
                return self._signature(Text("feature ", start), node, node.type)
            case _:
                assert_never(node)

    def _signature(
        self,
        keyword: Text,
        node: syntax.Feature | syntax.Function | syntax.Procedure,
        result: syntax.Type | None,
    ) -> Doc:
        """`keyword [[annotations]] name(parameters) -> T`."""
        written = self.written
        inputs = parameters(written, node.name, node.parameters)
        head = concat(keyword, annotations(written, node.annotations), name(node.name), inputs)
        return head if result is None else concat(head, " -> ", type_(written, result))

    def _procedure(self, node: syntax.Procedure) -> None:
        start = node.span.start
        head = self._signature(Text(f"{node.keyword} ", start), node, None)
        if not node.sections:
            self._line(0, head, start)
            return
        self._line(0, concat(head, ":"), start)
        for section in node.sections:
            self._section(section)

    def _section(self, node: syntax.Section) -> None:
        start = node.span.start
        match node:
            case syntax.Goal():
                self._goal(1, node, is_block=False)
            case syntax.Body(statements):
                self._suite(1, Text("body", start), start, statements)
            case syntax.Effect(statements):
                self._suite(1, Text("eff", start), start, statements)
            case syntax.Direction(keyword, nodes):
                listed = concat(" ", names(nodes)) if nodes else ""
                self._line(1, concat(Text(f"{keyword}:", start), listed), start)
            case syntax.ErrorStatement():
                raise ValueError("a section in error has no text")
            case _:
                assert_never(node)

    def _goal(self, level: int, node: syntax.Goal, *, is_block: bool) -> None:
        head, at = Text("goal", node.span.start), node.condition.span.start
        value: Doc = standing(self.written, node.condition)
        if node.equals is not None:
            value = concat(value, " = ", standing(self.written, node.equals))
        self._labelled(level, head, node.span.start, value, at, is_block=is_block)

    def _objects(self, node: syntax.Objects) -> None:
        head, start = Text("objects", node.span.start), node.span.start
        lines = [line for line in node.lines if isinstance(line, syntax.ObjectsLine)]
        docs = [concat(names(line.names), ": ", type_(self.written, line.type)) for line in lines]
        if len(docs) == 1:
            self._labelled(0, head, start, docs[0], lines[0].span.start)
            return
        self._line(0, concat(head, ":"), start)
        for line, doc in zip(lines, docs, strict=True):
            self._line(1, doc, line.span.start)

    def _labelled(
        self, level: int, head: Doc, start: int, value: Doc, at: int, *, is_block: bool = True
    ) -> None:
        """`head: value`, on one line where it was, by default unless `is_block`, and if it fits."""
        is_on_one_line = self.written.is_on_one_line(start, at)
        if is_on_one_line is None:
            is_on_one_line = not is_block
        line = concat(head, ": ", value)
        if is_on_one_line and self._is_short(level, line, start, at):
            self._line(level, line, start)
        else:
            self._line(level, concat(head, ":"), start)
            self._line(level + 1, value, self.written.first(at))

    # --------------------------------------------------------------------------------- statements

    def _suite(self, level: int, head: Doc, start: int, body: Sequence[syntax.Statement]) -> None:
        """A header with its block, which stays on its line if it was there and fits."""
        if len(body) == 1:
            first = self._start(body[0])
            doc = self._simple(body[0])
            if doc is not None and self.written.is_on_one_line(start, first):
                line = concat(head, ": ", doc)
                if self._is_short(level, line, start, first):
                    self._line(level, line, start)
                    return
        self._line(level, concat(head, ":"), start)
        for statement in body:
            self._statement(level + 1, statement)

    def _start(self, node: syntax.Statement) -> int:
        return self.written.first(node.span.start)

    def _statement(self, level: int, node: syntax.Statement) -> None:
        written, start = self.written, self._start(node)
        notes = annotations(written, node.annotations)
        match node:
            case syntax.Group(order, body):
                self._suite(level, concat(notes, Text(order, node.span.start)), start, body)
            case syntax.Promotable(order, body):
                words = "promotable" if order is None else f"promotable {order}"
                self._suite(level, concat(notes, Text(words, node.span.start)), start, body)
            case syntax.ForEach(variables, body):
                word = Text("foreach ", node.span.start)
                self._suite(
                    level, concat(notes, word, typed_names(written, variables)), start, body
                )
            case syntax.ForRange():
                self._suite(level, concat(notes, self._range(node)), start, node.body)
            case syntax.If():
                self._if(level, node, notes, start)
            case syntax.Bind(form="where"):
                self._bind_where(level, node, start)
            case _:
                doc = self._simple(node)
                assert doc is not None
                self._line(level, doc, start)

    def _range(self, node: syntax.ForRange) -> Doc:
        head = concat(Text("for ", node.span.start), name(node.variable), " in ")
        inputs = arguments(self.written, node.function, node.arguments)
        return concat(head, name(node.function), inputs)

    def _if(self, level: int, node: syntax.If, notes: Doc, start: int) -> None:
        written = self.written
        for index, (condition, body) in enumerate(node.branches):
            word = Text("elif " if index else "if ")
            if index:
                start = written.line_start(condition.span.start)
            head = concat(notes, word, standing(written, condition))
            self._suite(level, head, start, body)
            notes = Text("")
        if node.otherwise is not None:
            start = written.else_before(self._start(node.otherwise[0]))
            self._suite(level, Text("else", start), start, node.otherwise)

    def _bind_where(self, level: int, node: syntax.Bind, start: int) -> None:
        """Inline if it fits, however it was written."""
        line = self._simple(node)
        assert line is not None
        assert node.condition is not None
        at = node.condition.span.start
        if self._is_short(level, line, start, at):
            self._line(level, line, start)
            return
        notes = annotations(self.written, node.annotations)
        self._line(level, concat(notes, self._bind_head(node), " where:"), start)
        self._line(level + 1, standing(self.written, node.condition), self.written.first(at))

    def _bind_head(self, node: syntax.Bind) -> Doc:
        return concat(Text("bind ", node.span.start), typed_names(self.written, node.variables))

    def _simple(self, node: syntax.Statement) -> Doc | None:
        """A statement without a block on one line, None for one with a block."""
        doc = self._bare(node)
        return None if doc is None else concat(annotations(self.written, node.annotations), doc)

    def _bare(self, node: syntax.Statement) -> Doc | None:
        written, start = self.written, node.span.start
        match node:
            case syntax.Let(target, kind, value):
                typed = "" if kind is None else concat(": ", type_(written, kind))
                head = concat(Text("let ", start), name(target), typed, " = ")
                return concat(head, standing(written, value))
            case syntax.Assert(condition):
                return concat(Text("assert ", start), standing(written, condition))
            case syntax.Achieve(condition, once):
                word = Text("achieve_once " if once else "achieve ", start)
                return concat(word, standing(written, condition))
            case syntax.CallStatement(call, has_do):
                return concat(Text("do " if has_do else "", start), expression(written, call))
            case syntax.Assignment(target, operator, value):
                head = concat(expression(written, target), f" {operator} ")
                return concat(head, standing(written, value))
            case syntax.Bind():
                return self._bind(node)
            case syntax.Word(word):
                return Text(word, start)
            case syntax.Return(value):
                return concat(Text("return ", start), standing(written, value))
            case syntax.Group() | syntax.Promotable() | syntax.ForEach():
                return None
            case syntax.ForRange() | syntax.If():
                return None
            case syntax.ErrorStatement():
                raise ValueError("a statement in error has no text")
            case _:
                assert_never(node)

    def _bind(self, node: syntax.Bind) -> Doc:
        head, condition = self._bind_head(node), node.condition
        if condition is None:
            return head
        match node.form:
            case "call":  # no expression, so it cannot stand in parentheses
                return concat(head, ": ", expression(self.written, condition))
            case "equal":
                return concat(head, " = ", standing(self.written, condition))
            case _:
                return concat(head, " where: ", standing(self.written, condition))
