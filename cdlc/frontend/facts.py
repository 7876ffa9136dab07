"""A fast way through the plain lines of `init:` and `objects:`, which may be very many.

`f[a, b] = True`, with a truth value or a number, and `a, b: T` are read by regular expressions. All
other lines, and lines that may be continued or wrong, are left to the grammar; a test holds the two
against each other.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from lark import Token

from cdlc.frontend import grammar, syntax
from cdlc.frontend.build import integer_value
from cdlc.frontend.layout import TAB
from cdlc.source import Span

FACTS = "FACTS"
"""The kind of token that stands for lines already read."""

_NAME = "[A-Za-z_][A-Za-z0-9_]*"
_NAMES = f"{_NAME}(?:, *{_NAME})*"
_END = r"[ ]*(?:\#[^\n]*)?\r?(?:\n|\Z)"
_FACT = re.compile(
    rf"([ ]+)({_NAME})\[({_NAMES})\] *= *(?:(True|False)|(-?)(?:([0-9]+)|([0-9]+\.[0-9]+))){_END}"
)
_OBJECTS = re.compile(rf"([ ]+)({_NAMES}) *: *({_NAME}){_END}")
_BLANK = re.compile(r"[ \t]*(?:#[^\n]*)?\r?\n")
_LINE = re.compile(r"( *)([^\n]*)(?:\n|\Z)")
_LEADING = re.compile(r"[ \t\f]*")
_HEADER = re.compile(r"^(init|objects)[ ]*:[ ]*(?:#[^\n]*)?\r?\n", re.MULTILINE)
_WORD = re.compile(_NAME)

# Names they cannot be; a test compares with the grammar.
NOT_NAMES = frozenset(
    (  # noqa: SIM905 - a list would fill half a page
        "and or not if elif else for foreach forall exists let assert achieve achieve_once do bind "
        "commit return pass break continue True False symbol assert_hold assert_once achieve_hold "
        "pachieve untrack preamble critical mem_query findall findone batched heuristic "
        "undirected_generator import"
    ).split(" ")
)

Node = syntax.Statement | syntax.ObjectsLine


@dataclass(frozen=True, slots=True)
class Tokens:
    """The tokens of a text; a FACTS token stands for lines read as the nodes `read` has for it."""

    tokens: list[Token] = field(default_factory=list)
    read: dict[int, list[Node]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class _Run:
    """Successive lines of one block that were read."""

    start: int
    end: int
    indentation: int
    nodes: list[Node]


def lex(text: str) -> Tokens:
    """Split a text into tokens, reading the plain lines of its long sections on the way."""
    result = Tokens()
    position = 0
    for run in _runs(text):
        result.tokens.extend(_lexed(text, position, run.start))
        start, column = run.start + run.indentation, run.indentation + 1
        result.tokens.append(
            Token(FACTS, text[start : run.end].rstrip(), start_pos=start, column=column)
        )
        result.tokens.append(Token("LINE_END", "\n", start_pos=run.end - 1))
        result.read[start] = run.nodes
        position = run.end
    result.tokens.extend(_lexed(text, position, len(text)))
    return result


def _lexed(text: str, start: int, end: int) -> Iterator[Token]:
    whole = start == 0 and end == len(text)
    for token in grammar.parser().lex(text if whole else text[start:end]):
        token.start_pos = (token.start_pos or 0) + start
        token.end_pos = token.start_pos + len(token)
        yield token


def _runs(text: str) -> Iterator[_Run]:
    end = 0
    while (header := _HEADER.search(text, end)) is not None:
        end = header.end()
        for run in _Section(text, header[1] == "init").runs(end):
            yield run
            end = run.end


class _Section:
    """The block of `init:` or `objects:`; what is read stands at the indentation of its start."""

    def __init__(self, text: str, is_init: bool) -> None:
        self.text = text
        self.pattern = _FACT if is_init else _OBJECTS
        self.read = _read_fact if is_init else _read_objects
        self.indentation: int | None = None

    def runs(self, position: int) -> Iterator[_Run]:
        """The lines that can be read, as many together as there are."""
        while position < len(self.text):
            nodes: list[Node] = []
            start = last = position = self._after_blank_lines(position)
            while (line := self._line(position)) is not None:
                nodes.append(line[0])
                last, position = position, self._after_blank_lines(line[1])
            if nodes and self._is_deeper(position):
                nodes.pop()
                position = last
            if nodes:
                assert self.indentation is not None
                yield _Run(start, position, self.indentation, nodes)
            elif (other := _LINE.match(self.text, position)) and self._passes(other):
                position = other.end()
            else:
                return

    def _after_blank_lines(self, position: int) -> int:
        while (blank := _BLANK.match(self.text, position)) is not None:
            position = blank.end()
        return position

    def _is_deeper(self, position: int) -> bool:
        """Whether a line would be put under the one before it."""
        leading = _LEADING.match(self.text, position)
        assert leading is not None
        assert self.indentation is not None
        return len(leading[0].expandtabs(TAB)) > self.indentation

    def _line(self, position: int) -> tuple[Node, int] | None:
        """A line that can be read, and where the next one starts."""
        line = self.pattern.match(self.text, position)
        if line is None or self.indentation not in (None, len(line[1])):
            return None
        node = self.read(line)
        if node is None:
            return None
        self.indentation = len(line[1])
        return node, line.end()

    def _passes(self, other: re.Match[str]) -> bool:
        """Whether another line belongs to the block and leaves nothing open."""
        if not other[1] or not _is_closed(other[2]):
            return False
        if self.indentation is not None and len(other[1]) < self.indentation:
            return False
        if self.indentation is None:
            self.indentation = len(other[1])
        return True


def _is_closed(line: str) -> bool:
    """Whether a line leaves no bracket open, as far as a glance can tell."""
    opened = line.count("(") + line.count("[")
    return opened == line.count(")") + line.count("]") and '"' not in line


def _read_fact(line: re.Match[str]) -> Node | None:
    name, arguments, truth, minus, whole, fraction = line.group(2, 3, 4, 5, 6, 7)
    start, inner = line.start(2), line.start(3)
    span = Span(start, line.end(3) + 1)
    words = tuple(_WORD.finditer(arguments))
    if name in NOT_NAMES or any(word[0] in NOT_NAMES for word in words):
        return None
    target = syntax.Call(
        syntax.Name(name, span=Span(start, start + len(name))),
        tuple(
            syntax.NameExpression(word[0], span=Span(inner + word.start(), inner + word.end()))
            for word in words
        ),
        True,  # noqa: FBT003 - it is bracketed
        span=span,
    )
    value: syntax.Expression
    if truth is not None:
        value = syntax.Literal(truth == "True", span=Span(*line.span(4)))
    else:
        number = integer_value(whole) if whole is not None else float(fraction)
        value = syntax.Literal(number, span=Span(*line.span(6 if whole is not None else 7)))
        if minus:
            value = syntax.Unary("-", value, span=Span(line.start(5), value.span.end))
    return syntax.Assignment(target, "=", value, span=Span(start, value.span.end))


def _read_objects(line: re.Match[str]) -> Node | None:
    names, kind = line.group(2, 3)
    inner = line.start(2)
    words = tuple(_WORD.finditer(names))
    if kind in NOT_NAMES or any(word[0] in NOT_NAMES for word in words):
        return None
    return syntax.ObjectsLine(
        tuple(
            syntax.Name(word[0], span=Span(inner + word.start(), inner + word.end()))
            for word in words
        ),
        syntax.NamedType(kind, span=Span(*line.span(3))),
        span=Span(inner, line.end(3)),
    )
