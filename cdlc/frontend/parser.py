"""Text to syntax: one definition at a time, carrying on after each mistake."""

from typing import Any

from crow.program import Location
from lark import Token, UnexpectedToken
from lark.parsers.lalr_interactive_parser import InteractiveParser

from cdlc.diagnostics import Collector, Help, Replacement, nearest
from cdlc.frontend import errors, grammar, syntax
from cdlc.frontend.build import token_span
from cdlc.frontend.layout import Line, flatten, read_lines
from cdlc.source import SourceFile, Span

MAX_LINE = 1_000_000
# A text with more mistakes in one definition is no CDL; the rest would only bury them.
MAX_MISTAKES = 20

_WHOLE_LINES = frozenset(("INIT", "OBJECTS"))
_CONTINUATIONS = frozenset(("ELIF", "ELSE"))
_HEADERS = ["typedef", "feature", "def", "controller", "behavior", "action", "generator", "include"]
_HEADERS += ["object_constant", "domain", "problem", "objects", "init", "goal", "minimize"]
_SECTIONS = ["goal", "body", "eff", "in", "out"]


Stream = list[tuple[Token, Line]]
"""The tokens of a definition, each with the line it stands on."""


def parse(source: SourceFile, found: Collector) -> syntax.Module:
    """Read a file. What cannot be read is reported to `found` and left out of the tree."""
    whole = Span(0, len(source.text))
    if not _is_readable(source, found):
        return syntax.Module((), span=whole)
    tokens = grammar.parser().lex(source.text)
    definitions: list[syntax.Definition] = []
    for line in _join_continuations(read_lines(source, tokens, found)):
        definition = _parse_definition(source, line, found)
        if not isinstance(definition, syntax.ErrorStatement):
            definitions.append(definition)
    _warn_of_pragmas(source, found)
    return syntax.Module(tuple(definitions), span=whole)


def _is_readable(source: SourceFile, found: Collector) -> bool:
    for number, start in enumerate(source.line_starts, 1):
        end = source.line_starts[number] if number < len(source.line_starts) else len(source.text)
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


def _join_continuations(lines: list[Line]) -> list[list[Line]]:
    """Group each line with the `elif` and `else` lines that continue it."""
    groups: list[list[Line]] = []
    for line in lines:
        if groups and line.tokens[0].type in _CONTINUATIONS:
            groups[-1].append(line)
        else:
            groups.append([line])
    return groups


def _parse_definition(source: SourceFile, lines: list[Line], found: Collector) -> syntax.Definition:
    """Parse one definition; long `init:` and `objects:` sections go line by line.

    That keeps a mistake in a section of 100,000 facts from costing more than its own line.
    """
    head = lines[0]
    if head.tokens[0].type in _WHOLE_LINES and len(head.tokens) == 2 and head.block:
        word = head.tokens[0]
        if head.tokens[1].type == "COLON":
            parts = _join_continuations(head.block)
            if word.type == "OBJECTS":
                objects = [_parse(source, part, "objects_line", found) for part in parts]
                return syntax.Objects(tuple(objects), span=token_span(word))
            statements = [_parse(source, part, "statement", found) for part in parts]
            flat = [
                s for part in statements for s in (part if isinstance(part, tuple) else (part,))
            ]
            return syntax.Init(tuple(flat), span=token_span(word))
    result: syntax.Definition = _parse(source, lines, "definition", found)
    return result


# What a start symbol yields is known to its rule only.
def _parse(source: SourceFile, lines: list[Line], start: str, found: Collector) -> Any:
    """Read lines from a start symbol, as often as mistakes can be mended and it gets further."""
    for _ in range(MAX_MISTAKES):
        parser = grammar.parser().parse_interactive(start=start)
        stream = [item for line in lines for item in flatten(line)]
        failed = _feed(parser, stream)
        if failed is None:
            return _feed_eof(parser)
        if not _repair(source, stream, failed, _accepts(parser), lines, found):
            break
    return syntax.ErrorStatement(span=lines[0].span)


def _feed(parser: InteractiveParser, stream: Stream) -> int | None:
    """Feed tokens; the index of the first one that does not fit, if there is one."""
    for index, (token, _owner) in enumerate(stream):
        try:
            parser.feed_token(token)
        except UnexpectedToken:
            return index
    return None


# lark's interactive parser has no type annotations.
def _feed_eof(parser: Any) -> Any:
    return parser.feed_eof()


def _accepts(parser: Any) -> set[str]:
    return set(parser.accepts())


def _repair(
    source: SourceFile,
    stream: Stream,
    index: int,
    accepted: set[str],
    lines: list[Line],
    found: Collector,
) -> bool:
    """Report the mistake at a token and change its line so that the next attempt gets past it.

    False when the definition cannot be saved.
    """
    token, line = stream[index]
    if token.type == "ERROR":
        return False
    if token.type == "_NEWLINE" and "COLON" in accepted and line.block:
        end = Span(line.span.end, line.span.end)
        found.add(errors.MissingColon(location=source.location(end)))
        line.tokens.append(Token("COLON", ":", start_pos=end.start))
        return True
    if accepted == {"_INDENT"}:
        owner = stream[index - 1][1]
        found.add(errors.ExpectedBlock(location=source.location(owner.span)))
        owner.block.append(_error_line(owner))
        return True
    if token.type == "_INDENT":
        found.add(errors.UnexpectedIndentation(location=source.location(line.block[0].span)))
        line.block.clear()
        return True
    _report(source, stream, index, accepted, found)
    if line is lines[0]:
        return False
    _break(line, lines)
    return True


def _error_line(owner: Line) -> Line:
    line = Line([owner.tokens[-1]], owner.indentation + 1)
    line.is_broken = True
    return line


def _break(line: Line, lines: list[Line]) -> None:
    """Mark a line as unreadable, and drop the `elif` and `else` that would hang in the air."""
    line.is_broken = True
    siblings = _siblings(line, lines)
    position = siblings.index(line) + 1
    while position < len(siblings) and siblings[position].tokens[0].type in _CONTINUATIONS:
        del siblings[position]


def _siblings(line: Line, lines: list[Line]) -> list[Line]:
    pending = [lines]
    while pending:
        block = pending.pop()
        if line in block:
            return block
        pending.extend(other.block for other in block)
    raise LookupError("a line belongs to a block")


# ------------------------------------------------------------------------------------ what to say


def _report(
    source: SourceFile, stream: Stream, index: int, accepted: set[str], found: Collector
) -> None:
    token, line = stream[index]
    span = token_span(token) if token else Span(line.span.end, line.span.end)
    location = source.location(span)
    if token.type == "RESERVED":
        found.add(errors.ReservedWord(location=location, word=str(token)))
        return
    if token.type == "ELLIPSIS":
        found.add(errors.Elision(location=location))
        return
    first = line.tokens[0]
    if first.type == "NAME" and first == "while":
        found.add(errors.WhileLoop(location=source.location(token_span(first))))
        return
    hint = _hint(source, stream, index, accepted)
    found.add(
        errors.SyntaxError_(
            location=location, found=_describe(token), expected=_expected(accepted), hint=hint
        )
    )


def _describe(token: Token) -> str:
    match token.type:
        case "_NEWLINE" | "_DEDENT" | "$END":
            return "end of line"
        case "NAME":
            return f"name `{token}`"
        case "INT" | "FLOAT":
            return f"number `{token}`"
        case "STRING":
            return "string"
        case "UNREADABLE":
            return f"character `{token}`" if token.isprintable() else f"character {token!r}"
        case _:
            return f"`{token}`"


def _expected(accepted: set[str]) -> str:
    """What could have stood there, in words; empty when there is too much of it."""
    if {"INT", "NAME", "NOT"} <= accepted:
        return "an expression"
    if {"ACHIEVE", "NAME"} <= accepted:
        return "a statement"
    if {"GOAL", "BODY"} <= accepted and "NAME" not in accepted:
        return "a section: `goal:`, `body:` or `eff:`"
    if {"TYPEDEF", "FEATURE"} <= accepted and "NAME" not in accepted:
        return "a definition"
    names = []
    if "NAME" in accepted:
        names.append("a name")
    spelled = {"COLON": "`:`", "_NEWLINE": "the end of the line", "RPAR": "`)`", "RSQB": "`]`",
               "LPAR": "`(`", "STRING": "a string", "COMMA": "`,`", "EQUAL": "`=`"}  # fmt: skip
    names += [text for kind, text in spelled.items() if kind in accepted]
    return " or ".join(names[:3])


def _hint(source: SourceFile, stream: Stream, index: int, accepted: set[str]) -> Help | None:
    token, line = stream[index]
    location = source.location(token_span(token))
    if token.type == "EQUAL":
        return Help("compare with `==`", Replacement(location, "=="))
    if token.type == "UNREADABLE":
        return _hint_for_character(str(token))
    if token.type in ("FORALL", "EXISTS") and "NAME" in accepted:
        return Help("a quantifier in the middle of an expression needs parentheses around it")
    if token.type == "DEF" and line.tokens[0] is token:
        return Help("a `def` stands at the top level of a file")
    if token is line.tokens[0] and token.type == "NAME":
        return _hint_for_header(token, accepted, location)
    return None


def _hint_for_character(character: str) -> Help | None:
    match character:
        case "&" | "|" | "!":
            word = {"&": "and", "|": "or", "!": "not"}[character]
            return Help(f"the operator is `{word}`")
        case "'":
            return Help('strings are written with double quotes: "…"')
        case '"':
            return Help("the string is not closed on its line")
        case "{" | "}":
            return Help("blocks are written by indentation, without braces")
        case _:
            return None


def _hint_for_header(token: Token, accepted: set[str], location: Location) -> Help | None:
    known = _HEADERS if "TYPEDEF" in accepted else _SECTIONS if "GOAL" in accepted else []
    aliases = {"effect": "eff", "effects": "eff", "class": "typedef", "type": "typedef",
               "predicate": "feature", "function": "def", "rule": "behavior", "fluent": "feature",
               "precondition": "body", "pre": "body"}  # fmt: skip
    match = nearest(str(token), known) or aliases.get(str(token))
    if match is None or match not in known:
        return None
    return Help(f"did you mean `{match}`?", Replacement(location, match))
