"""CDL in its canonical layout: the tree printed afresh, the comments of the source woven in."""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field

from cdlc.diagnostics import Collector
from cdlc.frontend import errors, syntax
from cdlc.frontend.layout import MAX_BLOCKS
from cdlc.frontend.parser import parse
from cdlc.frontend.printer import Line, print_module
from cdlc.frontend.trivia import Comment, SourceTrivia, Trivia
from cdlc.frontend.wrapping import INDENT, place, render
from cdlc.source import SourceFile, Span

# About as deep as printing gets within Python's usual bound on recursion.
MAX_NESTING = 100
_DEEPEST = MAX_BLOCKS


def format_source(source: SourceFile, found: Collector) -> str | None:
    """The text of a file in canonical layout: the same tree, the same comments in the same order.

    None, with what is wrong in `found`, for a file that cannot be read completely.
    """
    own = Collector()
    module = parse(source, own)
    for diagnostic in own.found:
        found.add(diagnostic)
    if own.has_errors:
        return None
    try:
        written = SourceTrivia(source)
        text = _format(written, module)
        _verify(module, written.comments, SourceFile(source.name, text))
    except RecursionError:
        location = source.location(Span(0, 0))
        found.add(errors.NestingTooDeep(location=location, limit=MAX_NESTING))
        return None
    return text


def format_module(module: syntax.Module) -> str:
    """The canonical text of a tree that comes from no source."""
    return _format(Trivia(), module)


def _verify(module: syntax.Module, comments: Sequence[Comment], formatted: SourceFile) -> None:
    """Raise when a text is not the same program: a fault of this file, not of its users."""
    again = Collector()
    if parse(formatted, again) != module or again.has_errors:
        raise AssertionError(f"formatting `{formatted.name}` would change its meaning")
    after = SourceTrivia(formatted).comments
    if [comment.text for comment in comments] != [comment.text for comment in after]:
        raise AssertionError(f"formatting `{formatted.name}` would lose a comment")


def _format(written: Trivia, module: syntax.Module) -> str:
    lines = print_module(written, module)
    weaver = _Weaver(written)
    comments = _Comments(written.comments, [line.start for line in lines])
    for index, line in enumerate(lines):
        weaver.line(line, comments.before[index], comments.inside[index], comments.after[index])
    weaver.comments(comments.before[len(lines)], None)
    return "".join(f"{text}\n" for text in weaver.finished)


class _Comments:
    """Which line of the output each comment belongs to: before it, inside it, or at its end."""

    def __init__(self, comments: Sequence[Comment], starts: Sequence[int]) -> None:
        count = len(starts) + 1
        self.before: list[list[Comment]] = [[] for _ in range(count)]
        self.inside: list[list[Comment]] = [[] for _ in range(count)]
        self.after: list[list[Comment]] = [[] for _ in range(count)]
        for comment in comments:
            following = bisect_right(starts, comment.start)
            if comment.is_in_brackets:
                self.inside[following - 1].append(comment)
            elif comment.is_trailing:
                self.after[following - 1].append(comment)
            else:
                self.before[following].append(comment)


@dataclass(frozen=True, slots=True)
class _Printed:
    """A line that deeper ones may hang on: its level, and its column in the source."""

    level: int
    column: int


@dataclass(slots=True)
class _Weaver:
    """Puts lines and comments under each other, with the blank lines between them."""

    written: Trivia
    finished: list[str] = field(default_factory=list)
    enclosing: list[_Printed] = field(default_factory=list)
    is_after_line: bool = False

    def line(
        self,
        line: Line,
        before: Sequence[Comment],
        inside: Sequence[Comment],
        after: Sequence[Comment],
    ) -> None:
        """Add a line with the comments that belong to it."""
        placed, homeless = place(line.doc, inside)
        is_set_apart = self.comments((*before, *homeless), line)
        has_blank = self.written.is_after_blank(line.start)
        texts = render(line.doc, line.level, placed)
        self._add(texts, line.level, has_blank or (line.is_apart and not is_set_apart))
        for comment in after:
            self.finished[-1] += f"  {comment.text}"
        self._enclose(line)

    def _enclose(self, line: Line) -> None:
        while self.enclosing and self.enclosing[-1].level >= line.level:
            self.enclosing.pop()
        self.enclosing.append(_Printed(line.level, self.written.column(line.start)))
        self.is_after_line = True

    def comments(self, comments: Sequence[Comment], following: Line | None) -> bool:
        """Add comments that stand on lines of their own before a line or the end of the file.

        True if they brought the blank line that sets the following line apart.
        """
        least, most = following.level if following else 0, _DEEPEST
        is_set_apart = False
        for comment in comments:
            level = 0
            if not comment.is_pragma:
                most = level = min(most, self._level(comment, least))
            begins = following is not None and following.is_apart and level == 0
            has_blank = begins and not is_set_apart
            is_set_apart |= begins
            has_blank |= self.written.is_after_blank(comment.start)
            self._add([" " * (level * INDENT) + comment.text], level, has_blank)
            self.is_after_line = False
        return is_set_apart

    def _level(self, comment: Comment, least: int) -> int:
        """The deepest block before a comment that it was indented like, or that of what follows."""
        for line in reversed(self.enclosing):
            if line.level <= least:
                break
            if line.column <= comment.column:
                return line.level
        return least

    def _add(self, texts: Sequence[str], level: int, has_blank: bool) -> None:
        opens_block = self.is_after_line and level > self.enclosing[-1].level
        if has_blank and self.finished and not opens_block:
            self.finished.append("")
        self.finished += texts
