"""Text that knows where it may be broken, and how it is laid out in lines of limited width.

A group is printed on one line if it fits there with what follows it, else every break directly in
it becomes a line end. Breaks stand only where CDL joins lines: inside brackets.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import assert_never

from cdlc.frontend.trivia import Comment

WIDTH = 100
INDENT = 2


@dataclass(frozen=True, slots=True)
class Text:
    """Characters that stay together; `offset` is their place in the source, where it has one."""

    text: str
    offset: int | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Break:
    """`flat`, or a line end; comments are kept at breaks, which makes them line ends.

    A fill break is a line end only if what follows does not fit; a reluctant one only for comments.
    Comments at a closing break are indented like what the bracket holds.
    """

    flat: str = ""
    is_closing: bool = False
    is_fill: bool = False
    is_reluctant: bool = False


@dataclass(frozen=True, slots=True)
class Concat:
    """One after the other."""

    parts: "tuple[Doc, ...]"


@dataclass(frozen=True, slots=True)
class Nest:
    """Lines that start in here are indented by one step more."""

    content: "Doc"


@dataclass(frozen=True, slots=True)
class Group:
    """Printed on one line, or broken at all of its own breaks."""

    content: "Doc"


@dataclass(frozen=True, slots=True)
class Bracket:
    """A parenthesis that is there only when the group around it is broken."""

    text: str


@dataclass(frozen=True, slots=True)
class Parens:
    """An expression that gets parentheses if it does not fit on the line.

    One that brings brackets of its own to be broken in needs them only for comments outside those.
    """

    content: "Doc"
    has_brackets: bool
    opening: Break
    closing: Break


Doc = Text | Break | Concat | Nest | Group | Bracket | Parens
Placed = Mapping[Break, Sequence[Comment]]


def concat(*parts: Doc | str) -> Concat:
    """Documents and plain texts, one after the other."""
    return Concat(tuple(Text(part) if isinstance(part, str) else part for part in parts))


def parens(content: Doc, *, has_brackets: bool) -> Parens:
    """An expression where one ends a line or stands before its colon."""
    return Parens(content, has_brackets, Break(), Break(is_closing=True))


def bracketed(
    opening: str,
    items: Sequence[Doc],
    closing: Text,
    *,
    fill: bool = False,
    reluctant: bool = False,
) -> Group:
    """Items in brackets with commas between them, one a line if they do not fit on one."""
    if not items:
        inside = Break(is_closing=True, is_reluctant=True)
        return Group(concat(opening, inside, closing))
    inner: list[Doc] = [Break(is_reluctant=reluctant)]
    for item in items:
        inner += (item, Text(","), Break(" ", is_fill=fill, is_reluctant=reluctant))
    del inner[-2:]
    end = Break(is_closing=True, is_reluctant=reluctant)
    return Group(concat(opening, Nest(Concat(tuple(inner))), end, closing))


# ---------------------------------------------------------------------------------------- comments


def place(doc: Doc, comments: Sequence[Comment]) -> tuple[Placed, Sequence[Comment]]:
    """The break each comment is kept at, and the comments no break comes after.

    It is the first break behind the last text that the source has before the comment.
    """
    placed: dict[Break, list[Comment]] = {}
    waiting = list(comments)[::-1]
    for point, following in _breaks(doc) if comments else ():
        while waiting and (following is None or waiting[-1].start < following):
            placed.setdefault(point, []).append(waiting.pop())
    return placed, waiting[::-1]


def _breaks(doc: Doc) -> list[tuple[Break, int | None]]:
    """The breaks of a document, each with the place of the first text after it."""
    found: list[tuple[Break, int | None]] = []
    following: int | None = None
    for leaf in reversed(list(_leaves(doc))):
        if isinstance(leaf, Break):
            found.append((leaf, following))
        elif leaf.offset is not None:
            following = leaf.offset
    return found[::-1]


def _leaves(doc: Doc) -> Iterator[Text | Break]:
    stack = [doc]
    while stack:
        match item := stack.pop():
            case Text() | Break():
                yield item
            case Concat(parts):
                stack.extend(reversed(parts))
            case Nest(content) | Group(content):
                stack.append(content)
            case Parens(content, _, opening, closing):
                stack += (closing, content, opening)
            case Bracket():
                pass
            case _:
                assert_never(item)


# ------------------------------------------------------------------------------------------ layout


def flat_text(doc: Doc) -> str:
    """The text of a document on one line, however long."""
    return "".join(leaf.text if isinstance(leaf, Text) else leaf.flat for leaf in _leaves(doc))


def render(doc: Doc, level: int, placed: Placed) -> list[str]:
    """The lines of a document that stands at a level of indentation."""
    indent = level * INDENT
    if not placed and len(flat := flat_text(doc)) <= WIDTH - indent:  # most lines, and quicker
        return [" " * indent + flat]
    return _Layout(placed).lines(doc, indent)


@dataclass(frozen=True, slots=True)
class _Item:
    doc: Doc
    indent: int
    broken: bool


class _Layout:
    def __init__(self, placed: Placed) -> None:
        self.placed = placed
        self.finished: list[str] = []
        self.current = ""

    def lines(self, doc: Doc, indent: int) -> list[str]:
        self.current = " " * indent
        stack = [_Item(doc, indent, broken=True)]
        while stack:
            self._write(stack.pop(), stack)
        return [*self.finished, self.current]

    def _write(self, item: _Item, stack: list[_Item]) -> None:
        match item.doc:
            case Text(text):
                self.current += text
            case Bracket(text):
                self.current += text if item.broken else ""
            case Break():
                self._write_break(item.doc, item, stack)
            case Group(content):
                broken = item.broken and not self._fits(content, stack)
                stack.append(_Item(content, item.indent, broken))
            case _:
                stack.extend(reversed(self._inner(item)))

    def _inner(self, item: _Item) -> list[_Item]:
        """What an item without text of its own consists of."""
        match item.doc:
            case Concat(parts):
                return [_Item(part, item.indent, item.broken) for part in parts]
            case Nest(content):
                return [_Item(content, item.indent + INDENT, item.broken)]
            case Group(content):
                return [_Item(content, item.indent, item.broken)]
            case Parens():
                return [_Item(self._parenthesized(item.doc), item.indent, item.broken)]
            case _:
                raise TypeError(item.doc)

    def _parenthesized(self, doc: Parens) -> Doc:
        if doc.has_brackets and not {doc.opening, doc.closing} & self.placed.keys():
            return doc.content
        inner = Nest(Concat((doc.opening, doc.content)))
        return Group(Concat((Bracket("("), inner, doc.closing, Bracket(")"))))

    def _write_break(self, point: Break, item: _Item, stack: list[_Item]) -> None:
        comments = self.placed.get(point, ())
        if not comments and not self._is_line_end(point, item, stack):
            self.current += point.flat
            return
        for index, comment in enumerate(comments):
            if comment.is_trailing and index == 0:
                self.current += f"  {comment.text}"
            else:
                self._end_line(item.indent + INDENT if point.is_closing else item.indent)
                self.current += comment.text
        self._end_line(item.indent)

    def _is_line_end(self, point: Break, item: _Item, stack: list[_Item]) -> bool:
        if not item.broken or point.is_reluctant:
            return False
        return not (point.is_fill and self._fits(Text(point.flat), stack))

    def _end_line(self, indent: int) -> None:
        self.finished.append(self.current)
        self.current = " " * indent

    def _fits(self, doc: Doc, stack: list[_Item]) -> bool:
        """Whether a document printed flat, and what follows up to a line end, fits on the line."""
        room = WIDTH - len(self.current)
        pending = [_Item(doc, 0, broken=False)]
        rest = len(stack)
        while room >= 0:
            if not pending:
                if rest == 0:
                    return True
                rest -= 1
                pending.append(stack[rest])
            item = pending.pop()
            match item.doc:
                case Text(text):
                    room -= len(text)
                case Bracket(text):
                    room -= len(text) if item.broken else 0
                case Break(flat, is_reluctant=is_reluctant):
                    if item.doc in self.placed or (item.broken and not is_reluctant):
                        return item.broken
                    room -= len(flat)
                case _:
                    pending.extend(reversed(self._inner(item)))
        return False
