"""Text to syntax: one definition at a time, carrying on after each mistake.

A definition with a mistake is read again after each repair: a token put right, a missing colon or
block supplied, a line marked as unreadable. So every independent mistake is found, and what can be
understood is still checked.
"""

from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Final

from lark import Token, UnexpectedToken

from cdlc.diagnostics import Collector, Help
from cdlc.frontend import errors, facts, grammar, syntax
from cdlc.frontend.build import string_value, token_span
from cdlc.frontend.depth import MAX_DEPTH, too_deep
from cdlc.frontend.layout import Line, flatten, names_of, read_lines
from cdlc.frontend.mistakes import HEADERS, SECTIONS, STATEMENTS, Unexpected, correct, report
from cdlc.source import SourceFile, Span

MAX_LINE = 1_000_000
# A text with more mistakes in one definition is no CDL; the rest would only bury them.
MAX_MISTAKES = 20
# And in a file; from then on, one mistake of each statement is told.
MANY_MISTAKES = 1_000

_CONTINUATIONS = frozenset(("ELIF", "ELSE"))
_SECTION_BLOCKS = frozenset(("BODY", "EFF", "INIT"))
_HAVE_SECTIONS = frozenset(("BEHAVIOR", "ACTION", "CONTROLLER", "GENERATOR"))
# Unreadable lines that start with one of these still open a block of statements.
_BLOCK_STATEMENTS = frozenset(
    ("IF", "ELIF", "ELSE", "FOR", "FOREACH", "FORALL", "PROMOTABLE", "SEQUENTIAL", "UNORDERED",
     "ALTERNATIVE")
)  # fmt: skip

# A start symbol yields what its rule builds.
Tree = Any


def parse(source: SourceFile, found: Collector) -> syntax.Module:
    """Read a file. What cannot be read is reported to `found` and left out of the tree."""
    whole = Span(0, len(source.text))
    if not _is_readable(source, found):
        found.forgive_names()
        return syntax.Module((), span=whole)
    lexed = facts.lex(source.text)
    reader = _Reader(source, found, read_lines(source, lexed.tokens, found), lexed.read)
    definitions = tuple(reader.definitions())
    _warn_of_pragmas(source, found)
    return syntax.Module(definitions, span=whole)


def _is_readable(source: SourceFile, found: Collector) -> bool:
    ends = (*source.line_starts[1:], len(source.text))
    for start, end in zip(source.line_starts, ends, strict=True):
        if end - start > MAX_LINE:
            location = source.location(Span(start, start))
            found.add(errors.LineTooLong(location=location, limit=MAX_LINE))
            return False
    return True


def _warn_of_pragmas(source: SourceFile, found: Collector) -> None:
    position = source.text.find("#!pragma")
    while position >= 0:
        if source.position(position)[1] == 1:
            end = source.text.find("\n", position)
            span = Span(position, len(source.text) if end < 0 else end)
            found.add(errors.UnknownPragma(location=source.location(span)))
        position = source.text.find("#!pragma", position + 1)


def _join_continuations(lines: Iterable[Line]) -> list[list[Line]]:
    """Group each line with the `elif` and `else` lines that continue it."""
    groups: list[list[Line]] = []
    for line in lines:
        continues = line.tokens[0].type in _CONTINUATIONS
        if groups and continues and any(t.type == "IF" for t in groups[-1][0].tokens):
            groups[-1].append(line)
        else:
            groups.append([line])
    return groups


# lark's interactive parser has no type annotations.
def _parser(start: str) -> Any:
    return grammar.parser().parse_interactive(start=start)


def _accepted(start: str, stream: list[tuple[Token, Line]]) -> frozenset[str]:
    """What may follow a stream.

    It is read again, since a token that does not fit may have led to reductions before it failed.
    """
    parser = _parser(start)
    for token, _line in stream:
        parser.feed_token(token)
    # What may follow is decided by the states, and trying each word takes a millisecond.
    states = (start, *parser.parser_state.state_stack)
    found = _KNOWN.get(states)
    if found is None:
        if len(_KNOWN) >= _MOST_KNOWN:
            _KNOWN.clear()
        found = _KNOWN[states] = frozenset(parser.accepts())
    return found


_KNOWN: dict[tuple[object, ...], frozenset[str]] = {}
_MOST_KNOWN: Final = 1_000


class _Reader:
    """Reads the definitions of a file from its lines, mending what can be mended."""

    def __init__(
        self,
        source: SourceFile,
        found: Collector,
        lines: list[Line],
        read: Mapping[int, list[facts.Node]],
    ) -> None:
        self.source = source
        self.found = found
        self.pending = deque(_join_continuations(lines))
        self.read = read
        self.is_in_block = False

    def definitions(self) -> Iterable[syntax.Definition]:
        """The definitions that could be read, in order."""
        while self.pending:
            lines = self.pending.popleft()
            definition = self._definition(lines)
            if not isinstance(definition, syntax.ErrorStatement):
                yield definition

    def _definition(self, lines: list[Line]) -> syntax.Definition:
        """Parse one definition; long `init:` and `objects:` sections go line by line.

        That keeps a mistake in a section of 100,000 facts from costing more than its own line.
        """
        head = lines[0]
        kinds = [token.type for token in head.tokens[:3]]
        if head.block and not head.is_broken:
            if kinds == ["OBJECTS", "COLON"]:
                return self._objects(head)
            if kinds == ["INIT", "COLON"]:
                return self._init(head)
        definition: syntax.Definition = self._parse(lines, "definition")
        return definition

    def _objects(self, head: Line) -> syntax.Definition:
        lines: list[Tree] = []
        for part in self._parts(head):
            lines.extend(self._facts(part) or [self._parse(part, "objects_line")])
        return syntax.Objects(tuple(lines), span=token_span(head.tokens[0]))

    def _init(self, head: Line) -> syntax.Definition:
        statements: list[Tree] = []
        for part in self._parts(head):
            if read := self._facts(part):
                statements.extend(read)
                continue
            tree = self._parse(part, "statement")
            statements.extend(tree if isinstance(tree, tuple) else (tree,))
        return syntax.Init(tuple(statements), span=token_span(head.tokens[0]))

    def _facts(self, lines: list[Line]) -> Sequence[Tree]:
        """What was read of lines already, with the tokens."""
        first = lines[0].tokens[0]
        return self.read[first.start_pos or 0] if first.type == facts.FACTS else ()

    def _parts(self, head: Line) -> Iterable[list[Line]]:
        """The lines of a block; those that a repair lifts out of a line follow it."""
        outer, self.pending = self.pending, deque(_join_continuations(head.block))
        self.is_in_block = True
        while self.pending:
            yield self.pending.popleft()
        self.is_in_block = False
        self.pending = outer

    def _parse(self, lines: list[Line], start: str) -> Tree:
        """Read lines from a start symbol, as often as mistakes can be mended."""
        is_buried = len(self.found.found) >= MANY_MISTAKES
        for _ in range(1 if is_buried else MAX_MISTAKES):
            failed = self._attempt(lines, start)
            if not isinstance(failed, Unexpected):
                return failed
            if not self._mend(failed, lines):
                break
        return self._give_up(lines)

    def _attempt(self, lines: list[Line], start: str) -> "Tree | Unexpected":
        """The tree, or the first token that does not fit."""
        stream = [item for line in lines for item in flatten(line)]
        stream.append((Token("$END", "", start_pos=lines[-1].span.end), lines[-1]))
        parser = _parser(start)
        result = None
        for index, (token, _line) in enumerate(stream):
            try:
                result = parser.feed_token(token)
            except UnexpectedToken:
                return Unexpected(self.source, stream, index, _accepted(start, stream[:index]))
        return self._bounded(result, lines) if _may_be_deep(lines) else result

    def _bounded(self, tree: Tree, lines: list[Line]) -> Tree:
        """The tree, or an error where it is too deep to be worked with."""
        span = too_deep(tree)
        if span is None:
            return tree
        self.found.add(errors.NestingTooDeep(location=self.source.location(span), limit=MAX_DEPTH))
        return self._give_up(lines)

    def _give_up(self, lines: list[Line]) -> syntax.Definition:
        """A definition that cannot be read: the names in it may be what it was to define."""
        for line in lines:
            self.found.forgive_names(names_of(line))
        first = lines[0].tokens[0]
        if first.type in ("PROBLEM", "DOMAIN"):
            texts = [string_value(t) for t in lines[0].tokens if t.type == "STRING"]
            keyword: Any = str(first)
            return syntax.Title(keyword, next(iter(texts), ""), span=token_span(first))
        return syntax.ErrorStatement(span=lines[0].span)

    # -------------------------------------------------------------------------------- mending

    def _mend(self, wrong: Unexpected, lines: list[Line]) -> bool:
        """Report a mistake and repair its line, so that the next attempt gets past it.

        False when the definition cannot be saved.
        """
        line = wrong.line
        if wrong.token.type == "ERROR" or line.is_broken:
            return self._drop(line, lines)
        if wrong.token.type == "_NEWLINE" and "COLON" in wrong.accepted and line.block:
            return self._supply_colon(line)
        if wrong.accepted == {"_INDENT"}:
            return self._supply_block(wrong.stream[wrong.index - 1][1], lines)
        if wrong.token.type == "_INDENT":
            return self._lift_block(wrong, lines)
        if self._is_behavior(wrong, lines):
            return True
        if (correction := correct(wrong)) is not None:
            self.found.add(correction.diagnostic)
            at = line.tokens.index(wrong.token) + correction.offset
            line.tokens[at : at + correction.length] = correction.tokens
            return True
        report(wrong, self.found)
        return self._break(wrong, lines)

    def _is_behavior(self, wrong: Unexpected, lines: list[Line]) -> bool:
        """Take a `def` with sections for a behavior."""
        word = lines[0].tokens[0]
        if word.type != "DEF" or not _is_section(wrong.line) or wrong.token.type != "COLON":
            return False
        self.found.add(wrong.diagnose(Help("sections belong to a `behavior`, not to a `def`")))
        lines[0].tokens[0] = Token("BEHAVIOR", "behavior", start_pos=word.start_pos)
        return True

    def _supply_colon(self, line: Line) -> bool:
        end = Span(line.span.end, line.span.end)
        self.found.add(errors.MissingColon(location=self.source.location(end)))
        line.tokens.append(Token("COLON", ":", start_pos=end.start))
        return True

    def _supply_block(self, owner: Line, lines: list[Line]) -> bool:
        """Take the lines after a header for its block, if they can be, else an unreadable line."""
        self.found.add(errors.ExpectedBlock(location=self.source.location(owner.span)))
        if owner is lines[0] and owner.tokens[0].type in _HAVE_SECTIONS:
            while self.pending and _is_section(self.pending[0][0]):
                for line in self.pending.popleft():
                    owner.block.extend(_with_sections(line))
        elif owner is not lines[0] and owner.tokens[0].type in _SECTION_BLOCKS:
            siblings = _siblings(owner, lines)
            at = siblings.index(owner) + 1
            while at < len(siblings) and not _is_section(siblings[at]):
                owner.block.append(siblings.pop(at))
        if not owner.block:
            filler = Line([owner.tokens[-1]], owner.indentation + 1, is_broken=True)
            owner.block.append(filler)
        return True

    def _lift_block(self, wrong: Unexpected, lines: list[Line]) -> bool:
        """Put lines that are indented without reason beside the line they stand under."""
        line = wrong.line
        if self._would_take_colon(wrong):
            return self._supply_colon(line)
        location = self.source.location(line.block[0].span)
        self.found.add(errors.UnexpectedIndentation(location=location))
        lifted, line.block = line.block, []
        if line in lines:
            self._lift_definitions(_join_continuations(lifted))
        else:
            siblings = _siblings(line, lines)
            at = siblings.index(line) + 1
            siblings[at:at] = lifted
        return True

    def _lift_definitions(self, groups: list[list[Line]]) -> None:
        """Read what was indented under a definition by itself, if it looks like one."""
        for group in reversed(groups):
            if group[0].tokens[0].type in HEADERS or self.is_in_block:
                self.pending.appendleft(group)
            else:
                self.found.forgive_names(names_of(group[0]))

    def _would_take_colon(self, wrong: Unexpected) -> bool:
        """Whether the line could have opened a block, as `def f() -> T` can without a colon."""
        tokens = wrong.line.tokens
        return tokens[0].type in ("DEF", "CONTROLLER") and tokens[-1].type != "COLON"

    def _break(self, wrong: Unexpected, lines: list[Line]) -> bool:
        """Mark a line as unreadable, with those that would hang in the air without it."""
        line = wrong.line
        if line in lines:
            return self._break_head(line, lines)
        siblings = _siblings(line, lines)
        at = siblings.index(line)
        keeps = line.tokens[0].type in _BLOCK_STATEMENTS or line.tokens[0] == "while"
        self._mark_broken(line, keeps_block=keeps and not wrong.wants_section)
        for other in siblings[at + 1 :]:
            if (
                wrong.wants_section
                and other.tokens[0].type in STATEMENTS
                and not _is_section(other)
            ):
                self._mark_broken(other, keeps_block=False)
            elif other.tokens[0].type in _CONTINUATIONS and not wrong.wants_section:
                self._mark_broken(other, keeps_block=True)
            else:
                break
        return True

    def _mark_broken(self, line: Line, *, keeps_block: bool) -> None:
        line.is_broken = True
        line.keeps_block = keeps_block
        dropped = Line(line.tokens) if keeps_block else line
        self.found.forgive_names(names_of(dropped))

    def _break_head(self, line: Line, lines: list[Line]) -> bool:
        """The first line of a definition is unreadable: still look for mistakes in its block."""
        self.found.forgive_names(names_of(line))
        if line is lines[0] and line.block and line.tokens[0].type in _HAVE_SECTIONS:
            stub = Line([*_stub(line)], block=line.block)
            line.block = []
            self._parse([stub], "definition")
        return False

    def _drop(self, line: Line, lines: list[Line]) -> bool:
        """Leave out an unreadable line where the grammar has no room for one."""
        if line in lines:
            return self._break_head(line, lines)
        siblings = _siblings(line, lines)
        if len(siblings) == 1:
            return False
        siblings.remove(line)
        return True


def _stub(line: Line) -> Iterable[Token]:
    """A readable header in place of an unreadable one."""
    yield line.tokens[0]
    position = line.span.end
    for kind, text in (("NAME", "_"), ("LPAR", "("), ("RPAR", ")"), ("COLON", ":")):
        yield Token(kind, text, start_pos=position)


def _is_section(line: Line) -> bool:
    kinds = [token.type for token in line.tokens[:2]]
    return len(kinds) == 2 and kinds[0] in SECTIONS and kinds[1] == "COLON"


def _may_be_deep(lines: list[Line]) -> bool:
    """Whether the tree could be deeper than allowed: each token may add a level."""
    pending = list(lines)
    deepest = conditions = 0
    while pending:
        line = pending.pop()
        pending.extend(line.block)
        deepest = max(deepest, len(line.tokens) + line.level)
        conditions += line.tokens[0].type == "ELIF"
    return deepest + conditions > MAX_DEPTH


def _with_sections(line: Line) -> list[Line]:
    """A section, with those that were indented under it by mistake beside it."""
    if len(line.tokens) > 2 and line.block and _is_section(line.block[0]):
        under, line.block = line.block, []
        return [line, *under]
    return [line]


def _siblings(line: Line, lines: list[Line]) -> list[Line]:
    """The block that a line stands in."""
    pending = [lines]
    while pending:
        block = pending.pop()
        if line in block:
            return block
        pending.extend(other.block for other in block)
    raise LookupError("a line belongs to a block")
