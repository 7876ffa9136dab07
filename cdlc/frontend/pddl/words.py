"""PDDL text to nested lists of words, with the place of each.

A regular expression and a stack: that is all there is to this level, and problem files are large.
"""

import re
from dataclasses import dataclass

from cdlc.diagnostics import Collector
from cdlc.frontend import errors
from cdlc.source import SourceFile, Span

MAX_DEPTH = 1_000
# Some benchmarks leave out the blank before a variable.
_TOKEN = re.compile(r"[()]|\?[^\s();?]*|[^\s();?]+|;[^\n]*")


@dataclass(frozen=True, slots=True)
class Word:
    """A name, number or keyword, in lower case: PDDL ignores it."""

    text: str
    span: Span


@dataclass(frozen=True, slots=True)
class Words:
    """What stands in a pair of parentheses."""

    items: "tuple[Word | Words, ...]"
    span: Span

    @property
    def head(self) -> str:
        """The first word, if it starts with one."""
        match self.items:
            case (Word(text=text), *_):
                return text
            case _:
                return ""


Item = Word | Words


def read_words(source: SourceFile, found: Collector) -> Words | None:
    """The one list that a PDDL file consists of; None, with a diagnostic, for any other text."""
    open_: list[tuple[int, list[Item]]] = []
    top: list[Words] = []
    for match in _TOKEN.finditer(source.text):
        text, span = match[0], Span(*match.span())
        if text == "(":
            if len(open_) == MAX_DEPTH:
                location = source.location(span)
                found.add(errors.NestingTooDeep(location=location, limit=MAX_DEPTH))
                return None
            open_.append((span.start, []))
        elif text == ")":
            if not open_:
                found.add(
                    errors.UnmatchedBracket(
                        location=source.location(span), bracket=")", opened=None
                    )
                )
                return None
            start, items = open_.pop()
            closed = Words(tuple(items), Span(start, span.end))
            (open_[-1][1] if open_ else top).append(closed)
        elif not text.startswith(";"):
            if not open_:
                _report(source, span, "expected `(define …)`", found)
                return None
            open_[-1][1].append(Word(text.lower(), span))
    if open_:
        start = open_[-1][0]
        location = source.location(Span(start, start + 1))
        found.add(errors.UnclosedBracket(location=location, bracket="(", closing=")"))
        return None
    if len(top) != 1 or top[0].head != "define":
        span = top[1].span if len(top) > 1 else Span(0, min(1, len(source.text)))
        _report(source, span, "expected one `(define …)`", found)
        return None
    return top[0]


def _report(source: SourceFile, span: Span, problem: str, found: Collector) -> None:
    found.add(errors.PddlSyntax(location=source.location(span), problem=problem))
