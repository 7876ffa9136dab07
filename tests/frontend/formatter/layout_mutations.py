"""Random changes of a text that keep its tree: spaces, lines, comments, parentheses."""

import dataclasses
from collections.abc import Iterator
from typing import Any

from hypothesis import strategies as st

from cdlc.diagnostics import Collector
from cdlc.frontend import grammar, syntax
from cdlc.frontend.parser import parse
from cdlc.source import SourceFile

OPENING, CLOSING = ("LPAR", "LSQB"), ("RPAR", "RSQB")
COMMENTS = ["# a", "#b  ", "#", '# "q" (', "#!pragma x", "#\r"]
Edit = tuple[int, str]


def read(text: str) -> syntax.Module:
    found = Collector()
    module = parse(SourceFile("mutated.cdl", text), found)
    assert not found.has_errors, ([d.message() for d in found], text)
    return module


def nodes(value: Any) -> Iterator[syntax.Node]:
    """A node and all below it."""
    if isinstance(value, syntax.Node):
        yield value
        for item in dataclasses.fields(value):
            yield from nodes(getattr(value, item.name))
    elif isinstance(value, tuple):
        for part in value:
            yield from nodes(part)


@st.composite
def mutated(draw: Any, texts: st.SearchStrategy[str]) -> tuple[str, str]:
    """A text, and the same with random changes."""
    text = draw(texts)
    changed = indented(text, draw(st.integers(1, 5)))
    changed = applied(changed, draw(_chosen(parentheses(changed))))
    for _ in range(draw(st.integers(0, 2))):
        changed = applied(changed, draw(_chosen(gaps(changed))))
    if draw(st.booleans()):
        changed = changed.replace("\n", "\r\n")
    return text, changed


def _chosen(edits: list[list[Edit]]) -> Any:
    """Some of the changes that are possible; the first of several variants is the simplest."""
    if not edits:
        return st.just([])
    return st.lists(st.sampled_from(edits).flatmap(_variant), max_size=12)


def _variant(edit: list[Edit]) -> Any:
    if len(edit) == 2 and edit[1][1] == ")":  # a pair of parentheses
        return st.just(edit)
    return st.sampled_from(edit).map(lambda one: [one])


def applied(text: str, chosen: list[list[Edit]]) -> str:
    """Insert what was chosen, each place at most once, from the end on."""
    places: dict[int, str] = {}
    for edit in chosen:
        if not any(place in places for place, _ in edit):
            places.update(edit)
    for place in sorted(places, reverse=True):
        text = text[:place] + places[place] + text[place:]
    return text


def indented(text: str, width: int) -> str:
    """Two spaces of canonical indentation become `width`; brackets do not care."""
    lines = [line.lstrip(" ") for line in text.split("\n")]
    depths = [len(line) - len(line.lstrip(" ")) for line in text.split("\n")]
    return "\n".join(" " * (d // 2 * width) + s for d, s in zip(depths, lines, strict=True))


def gaps(text: str) -> list[list[Edit]]:
    """For each place between two tokens what can stand there."""
    found: list[list[Edit]] = []
    depth = 0
    for token in grammar.parser().lex(text):
        start = token.start_pos or 0
        line = text[text.rfind("\n", 0, start) + 1 : start]
        if token.type == "LINE_END":
            found.append([(start, between) for between in _at_line_end(line, depth)])
        elif depth and token.type != "LINE_END":
            found.append([(start, between) for between in _in_brackets()])
        elif line.strip():
            found.append([(start, "  ")])
        depth += (token.type in OPENING) - (token.type in CLOSING)
    return found


def _in_brackets() -> list[str]:
    return [" ", "\n      ", "\n\n   ", *(f"{comment}\n    " for comment in COMMENTS)]


def _at_line_end(line: str, depth: int) -> list[str]:
    """Space, blank lines and comments; a line may have a comment already."""
    own_lines = [f"\n{' ' * indent}{c}" for c in COMMENTS[:3] for indent in (0, 1, 2, 3, 4, 8)]
    own_lines += [f"\n{own}" for own in own_lines[::2]]
    own_lines += [f"{own}\n" for own in own_lines[::3]]
    texts = [" ", "\n", "\n\n\n", "\n  \n", *own_lines]
    if "#" not in line and line.strip():
        texts += [f" {comment}" for comment in COMMENTS]
        texts += [] if depth or line.rstrip()[-1] in ":(" else [";"] * _ends_simple(line)
    return texts


def _ends_simple(line: str) -> bool:
    """Whether a line is surely a simple statement, which a semicolon may end."""
    return line.split()[0] in ("commit", "achieve", "assert", "do", "pass", "return") and (
        not line.rstrip().endswith(":") and _is_balanced(line)
    )


def parentheses(text: str) -> list[list[Edit]]:
    """The expressions that parentheses may be put around."""
    found: list[list[Edit]] = []
    for node in nodes(read(text)):
        for name in ("condition", "value", "operand", "left", "right", "body", "then", "where"):
            child = getattr(node, name, None)
            if isinstance(node, syntax.Bind) and node.form == "call":
                continue
            if isinstance(node, syntax.Annotation) or not isinstance(child, syntax.Expression):
                continue
            if _is_balanced(text[slice(*child.span)]):
                found.append([(child.span.start, "("), (child.span.end, ")")])
    return found


def _is_balanced(text: str) -> bool:
    depth = 0
    for character in text:
        depth += (character in "([") - (character in ")]")
        if depth < 0:
            return False
    return depth == 0 and '"' not in text and "#" not in text
