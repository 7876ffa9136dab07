"""What a source says that its syntax tree does not: comments, blank lines, line ends, spellings."""

import json
from bisect import bisect_left, bisect_right
from dataclasses import dataclass
from functools import cached_property

from lark import Token

from cdlc.frontend import grammar, syntax
from cdlc.frontend.build import token_span
from cdlc.source import SourceFile

_OPENING = frozenset(("LPAR", "LSQB"))
_CLOSING = frozenset(("RPAR", "RSQB"))
# Further right than any column: of what shares its line with what it belongs to.
_NO_COLUMN = 1 << 30


@dataclass(frozen=True, slots=True)
class Comment:
    """A comment; a trailing one has something before it on its line."""

    text: str
    start: int
    column: int
    is_trailing: bool
    is_in_brackets: bool

    @property
    def is_pragma(self) -> bool:
        """Whether it is a `#!` line, which stays at the start of its line."""
        return self.column == 0 and self.text.startswith("#!")


class Trivia:
    """For a tree that comes from no source: no comments, and the usual layout."""

    comments: tuple[Comment, ...] = ()

    def spelling(self, literal: syntax.Literal) -> str:
        """How a literal is written."""
        value = literal.value
        return quote(value) if isinstance(value, str) else repr(value)

    def string(self, node: syntax.Title | syntax.Include) -> str:
        """How the string of a definition is written."""
        return quote(node.text if isinstance(node, syntax.Title) else node.path)

    def is_on_one_line(self, _first: int, _second: int) -> bool | None:
        """Whether two places are on one logical line; None where there are no places."""
        return None

    def has_comment(self, _start: int, _end: int) -> bool:
        """Whether there is a comment between two places."""
        return False

    def line_start(self, offset: int) -> int:
        """The start of the logical line a place is on."""
        return offset

    def line_end(self, offset: int) -> int:
        """The end of the logical line a place is on."""
        return offset

    def first(self, offset: int) -> int:
        """Where that begins whose first name, literal or word is at a place.

        Annotations and opening parentheses may stand before it.
        """
        return offset

    def else_before(self, offset: int) -> int:
        """The `else` in whose block the first statement is at a place."""
        return offset

    def closing(self, _offset: int) -> int | None:
        """The partner of the bracket that opens at or after a place."""
        return None

    def column(self, _offset: int) -> int:
        """How far the logical line is indented that starts at a place."""
        return 0

    def is_after_blank(self, _offset: int) -> bool:
        """Whether a blank line stands before a line or comment."""
        return False


class SourceTrivia(Trivia):
    """For a tree read from a source."""

    def __init__(self, source: SourceFile) -> None:
        self.text = source.text
        self.tokens: list[Token] = []
        self.line_starts: list[int] = []
        self.partners: dict[int, int] = {}
        self.comments = tuple(self._scan())
        self.offsets = [token_span(token).start for token in self.tokens]

    def _scan(self) -> list[Comment]:
        """Collect the tokens, the partners of brackets and the comments in the gaps."""
        comments: list[Comment] = []
        opened: list[int] = []
        position, line, is_first, is_logical = 0, 0, True, True
        for token in (*grammar.parser().lex(self.text), Token("LINE_END", "")):
            start = len(self.text) if token.start_pos is None else token.start_pos
            found = self.text.find("#", position, start)
            if found >= 0:
                text = self.text[found:start].rstrip()
                comments.append(Comment(text, found, found - line, not is_first, bool(opened)))
            position = start + len(token)
            if token.type == "LINE_END":
                line, is_first, is_logical = position, True, not opened
                continue
            if is_first and is_logical:
                self.line_starts.append(start)
            is_first = False
            self._match(token, start, opened)
            self.tokens.append(token)
        return comments

    def _match(self, token: Token, start: int, opened: list[int]) -> None:
        if token.type in _OPENING:
            opened.append(start)
        elif token.type in _CLOSING:
            partner = opened.pop()
            self.partners[start], self.partners[partner] = partner, start

    def spelling(self, literal: syntax.Literal) -> str:
        """The source's own text."""
        written = self.text[slice(*literal.span)]
        return "-" + written.split()[-1].removeprefix("-") if written[0] == "-" else written

    def string(self, node: syntax.Title | syntax.Include) -> str:
        """The source's own text."""
        return str(self.tokens[bisect_left(self.offsets, node.span.end) - 1])

    def is_on_one_line(self, first: int, second: int) -> bool:
        """Whether two places are on one logical line."""
        return self._line(first) == self._line(second)

    def _line(self, offset: int) -> int:
        return bisect_right(self.line_starts, offset) - 1

    def line_start(self, offset: int) -> int:
        """The start of the logical line a place is on."""
        return self.line_starts[self._line(offset)]

    def line_end(self, offset: int) -> int:
        """The end of the logical line a place is on."""
        following = self._line(offset) + 1
        if following == len(self.line_starts):
            last = len(self.tokens) - 1
        else:
            last = bisect_left(self.offsets, self.line_starts[following]) - 1
        return token_span(self.tokens[last]).end

    @cached_property
    def _comment_starts(self) -> list[int]:
        return [comment.start for comment in self.comments]

    def has_comment(self, start: int, end: int) -> bool:
        """Whether there is a comment between two places."""
        starts = self._comment_starts
        return bisect_left(starts, start) < bisect_left(starts, end)

    @cached_property
    def _lines(self) -> frozenset[int]:
        return frozenset(self.line_starts)

    def first(self, offset: int) -> int:
        """Where that begins whose first name, literal or word is at a place."""
        while offset not in self._lines:
            before = self.tokens[bisect_left(self.offsets, offset) - 1]
            if before.type == "RSQB":
                offset = self.partners[token_span(before).start]
            elif before.type == "LPAR":
                offset = token_span(before).start
            else:
                break
        return offset

    def else_before(self, offset: int) -> int:
        """The `else` in whose block the first statement is at a place."""
        line = self._line(offset)
        while self.tokens[bisect_left(self.offsets, self.line_starts[line])].type != "ELSE":
            line -= 1
        return self.line_starts[line]

    def closing(self, offset: int) -> int | None:
        """The partner of the bracket that opens at or after a place."""
        return self.partners.get(self.offsets[bisect_left(self.offsets, offset)])

    def column(self, offset: int) -> int:
        """How far the logical line is indented that starts at a place; far if none does."""
        if offset not in self._lines:
            return _NO_COLUMN
        return offset - self.text.rfind("\n", 0, offset) - 1

    def is_after_blank(self, offset: int) -> bool:
        """Whether a blank line stands before a line or comment."""
        end = self.text.rfind("\n", 0, offset)
        if end < 0 or self.text[end:offset].strip():
            return False
        before = self.text[self.text.rfind("\n", 0, end) + 1 : end]
        return not before.strip()


def quote(value: str) -> str:
    """A string literal of CDL for a value."""
    return json.dumps(value, ensure_ascii=False)
