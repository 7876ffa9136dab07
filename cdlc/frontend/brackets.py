"""Which brackets of a file have no partner, so that one of them spoils its own line only.

A bracket left open would swallow the rest of the file. Some words cannot stand inside brackets
when they start a line: those of statements and the headers of sections and definitions. Where one
of them turns up, what is still open was never closed.
"""

from dataclasses import dataclass, field

from lark import Token

from cdlc.diagnostics import Collector
from cdlc.frontend import errors
from cdlc.frontend.build import token_span
from cdlc.source import SourceFile

MAX_BRACKETS = 1000

OPENING = {"LPAR": ")", "LSQB": "]"}
CLOSING = {"RPAR": "LPAR", "RSQB": "LSQB"}

_STATEMENTS = frozenset(
    ("LET", "ASSERT", "ACHIEVE", "ACHIEVE_ONCE", "DO", "BIND", "COMMIT", "RETURN", "PASS", "BREAK",
     "CONTINUE", "ELIF")
)  # fmt: skip
_SECTIONS = frozenset(("GOAL", "BODY", "EFF", "IN", "OUT", "OBJECTS", "INIT", "MINIMIZE"))
_DEFINITIONS = frozenset(
    (
        "TYPEDEF",
        "OBJECT_CONSTANT",
        "FEATURE",
        "DEF",
        "CONTROLLER",
        "BEHAVIOR",
        "ACTION",
        "GENERATOR",
    )
)
_TITLES = frozenset(("DOMAIN", "PROBLEM", "INCLUDE"))


@dataclass(slots=True)
class Brackets:
    """The tokens without closing brackets that close nothing; `unclosed` are opening ones."""

    tokens: list[Token] = field(default_factory=list)
    unclosed: set[int] = field(default_factory=set)


def match_brackets(source: SourceFile, tokens: list[Token], found: Collector) -> Brackets:
    """Pair brackets; those without partner, and nesting that is too deep, are reported."""
    matcher = _Matcher(source, found)
    for index, token in enumerate(tokens):
        kind = token.type
        if matcher.open and matcher.at_line_start and _ends_brackets(tokens, index):
            matcher.give_up()
        if kind in OPENING:
            if len(matcher.open) == MAX_BRACKETS:
                matcher.report_depth(token)
                break
            matcher.open.append(token)
        elif kind in CLOSING and not matcher.close(token):
            continue
        matcher.at_line_start = kind == "LINE_END"
        matcher.result.tokens.append(token)
    matcher.give_up()
    return matcher.result


def _ends_brackets(tokens: list[Token], index: int) -> bool:
    """Whether the token, which starts a line, cannot stand inside brackets."""
    kind = tokens[index].type
    if kind in _STATEMENTS:
        return True
    if index + 1 == len(tokens):
        return False
    following = tokens[index + 1]
    if kind in _SECTIONS:
        is_header = following.type == "COLON" and _ends_its_line(tokens, index + 2)
        return is_header and not _is_parameter(tokens, index)
    if kind in _TITLES:
        return following.type == "STRING"
    return kind in _DEFINITIONS and _is_before_name(tokens, index + 1)


def _is_before_name(tokens: list[Token], index: int) -> bool:
    """Whether a name follows, perhaps after annotations; in an expression none follows a name."""
    depth = 0
    while index < len(tokens):
        kind = tokens[index].type
        depth += (kind == "LSQB") - (kind == "RSQB")
        if depth == 0 and kind != "RSQB":
            return kind == "NAME"
        index += 1
    return False


def _is_parameter(tokens: list[Token], index: int) -> bool:
    """Whether a name is called for before a token that starts a line: `f(x: t,` or `f(`."""
    while index > 0 and tokens[index - 1].type == "LINE_END":
        index -= 1
    return index > 0 and tokens[index - 1].type in ("COMMA", *OPENING)


def _ends_its_line(tokens: list[Token], index: int) -> bool:
    return index >= len(tokens) or tokens[index].type == "LINE_END"


@dataclass(slots=True)
class _Matcher:
    source: SourceFile
    found: Collector
    open: list[Token] = field(default_factory=list)
    at_line_start: bool = True
    result: Brackets = field(default_factory=Brackets)

    def close(self, token: Token) -> bool:
        """Match a closing bracket; one that fits no open one of its line is reported."""
        wanted = CLOSING[token.type]
        if self.open and self.open[-1].type == wanted:
            self.open.pop()
            return True
        for depth, other in enumerate(reversed(self.open), 1):
            if other.line != token.line:
                break
            if other.type == wanted:
                self._report_unclosed(self.open[1 - depth :])
                del self.open[-depth:]
                return True
        self._report_unmatched(token)
        return False

    def give_up(self) -> None:
        """Report what is still open."""
        self._report_unclosed(self.open)
        self.open.clear()

    def report_depth(self, token: Token) -> None:
        """Report too many open brackets, instead of each of them as unclosed."""
        location = self.source.location(token_span(token))
        self.found.add(errors.NestingTooDeep(location=location, limit=MAX_BRACKETS))
        self.found.forgive_names()
        self.result.unclosed.update(id(bracket) for bracket in self.open)
        self.open.clear()

    def _report_unclosed(self, brackets: list[Token]) -> None:
        """Report the brackets of one line as one mistake, at the innermost of them."""
        for bracket, following in zip(brackets, [*brackets[1:], None], strict=False):
            self.result.unclosed.add(id(bracket))
            if following is None or following.line != bracket.line:
                location = self.source.location(token_span(bracket))
                closing = OPENING[bracket.type]
                self.found.add(
                    errors.UnclosedBracket(location=location, bracket=str(bracket), closing=closing)
                )

    def _report_unmatched(self, token: Token) -> None:
        """Report a stray closing bracket; with an open one on its line the two are a pair."""
        opened = None
        if self.open and self.open[-1].line == token.line:
            bracket = self.open.pop()
            self.result.unclosed.add(id(bracket))
            opened = self.source.location(token_span(bracket))
        location = self.source.location(token_span(token))
        self.found.add(
            errors.UnmatchedBracket(location=location, bracket=str(token), opened=opened)
        )
