"""What editors and Pygments colour, compared with what the parser reads."""

import json
import re
from pathlib import Path

import pytest
from lark.lexer import PatternStr
from pygments.lexers import get_lexer_by_name, get_lexer_for_filename
from pygments.token import Comment, Error, Keyword, Name, Number, Operator, String, Token
from support import ROOT
from textmate_engine import coloured

from cdlc.editors import textmate
from cdlc.editors.pygments_lexer import CdlLexer
from cdlc.editors.vocabulary import DEFINITIONS, INNER, SECTIONS, TITLES, vocabulary
from cdlc.frontend import grammar

TEXTS = sorted(
    path
    for folder in ("examples", "docs", "tests/golden/fmt", "tests/listings")
    for path in (ROOT / folder).rglob("*")
    if path.suffix in (".cdl", ".fmt") and b"\r" not in path.read_bytes()
)

# Each keyword where it is one, and each name that looks like one.
KEYWORDS = {
    **{word: f"  {word} x" for word in vocabulary().hard},
    **{word: f"{word} x" for word in DEFINITIONS},
    **{word: f'{word} "x"' for word in TITLES},
    **{word: f"  {word}:" for word in SECTIONS},
    "each": "  for each x: T:",
    "where": "  bind x: T[] where: p(x)",
    "in": "  for i in range(2):",
}
NAMES = {
    **{word: f"  achieve {word}(x)" for word in vocabulary().soft},
    **{word: f"  {word} = 1" for word in DEFINITIONS | SECTIONS | TITLES},
    "each": "  for each in range(2):",
}


def terminals() -> dict[str, str]:
    """The words among the parser's terminals."""
    found = {
        terminal.name: terminal.pattern.value
        for terminal in grammar.parser().terminals
        if isinstance(terminal.pattern, PatternStr)
    }
    return {name: word for name, word in found.items() if word.isidentifier()}


def pygments_tokens(text: str) -> list[tuple[int, str, object]]:
    return [(at, token, kind) for at, kind, token in CdlLexer().get_tokens_unprocessed(text)]


def is_keyword_in_pygments(text: str, word: str) -> bool:
    kinds = {kind for _, token, kind in pygments_tokens(text) if token == word}
    return any(kind in Keyword or kind in Operator.Word for kind in kinds)


def is_keyword_in_textmate(text: str, word: str) -> bool:
    scopes = {scope for _, token, scope in coloured(textmate.grammar(), text) if token == word}
    return any(re.match(r"keyword|storage|constant\.language|invalid", scope) for scope in scopes)


def test_vocabulary_has_every_word_of_the_grammar() -> None:
    words = vocabulary()
    assert words.hard | words.soft == set(terminals().values())
    assert words.soft == DEFINITIONS | TITLES | SECTIONS | INNER | {"each"}
    assert words.reserved.isdisjoint(words.hard | words.soft)
    (reserved,) = (t for t in grammar.parser().terminals if t.name == "RESERVED")
    assert all(re.fullmatch(reserved.pattern.to_regexp(), word) for word in words.reserved)


def test_there_is_a_line_for_every_keyword() -> None:
    assert KEYWORDS.keys() == vocabulary().hard | vocabulary().soft


@pytest.mark.parametrize("word", sorted(KEYWORDS))
def test_keyword_is_coloured(word: str) -> None:
    assert is_keyword_in_pygments(KEYWORDS[word], word)
    assert is_keyword_in_textmate(KEYWORDS[word], word)


@pytest.mark.parametrize("word", sorted(vocabulary().reserved))
def test_reserved_word_is_coloured(word: str) -> None:
    assert is_keyword_in_pygments(f"  {word} x", word)
    assert is_keyword_in_textmate(f"  {word} x", word)


@pytest.mark.parametrize("word", sorted(NAMES))
def test_soft_keyword_is_a_name_elsewhere(word: str) -> None:
    assert not is_keyword_in_pygments(NAMES[word], word)
    assert not is_keyword_in_textmate(NAMES[word], word)


@pytest.mark.parametrize("path", TEXTS, ids=lambda path: path.name)
def test_pygments_reads_everything(path: Path) -> None:
    text = path.read_text()
    tokens = pygments_tokens(text)
    assert "".join(token for _, token, _ in tokens) == text
    assert not [token for _, token, kind in tokens if kind in Error]


@pytest.mark.parametrize("path", TEXTS, ids=lambda path: path.name)
def test_tokens_are_those_of_the_parser(path: Path) -> None:
    text = path.read_text()
    words_and_values = (Name, Keyword, Operator.Word, Number, String)
    found = [
        (at, token)
        for at, token, kind in pygments_tokens(text)
        if any(kind in wanted for wanted in words_and_values)
    ]
    assert found == [
        (token.start_pos, str(token))
        for token in grammar.parser().lex(text)
        if re.match(r'[A-Za-z_0-9"]', token)
    ]


@pytest.mark.parametrize("path", TEXTS, ids=lambda path: path.name)
def test_both_colour_the_same(path: Path) -> None:
    text = path.read_text()
    classes = [(Comment, "comment"), (String, "string"), (Number, "constant.numeric")]
    by_textmate = list(coloured(textmate.grammar(), text))
    for kind, scope in classes:
        assert [(at, token) for at, token, found in pygments_tokens(text) if found in kind] == [
            (at, token) for at, token, found in by_textmate if found.startswith(scope)
        ]
    keywords = [
        (at, token)
        for at, token, found in pygments_tokens(text)
        if (found in Keyword and found not in Keyword.Type) or found in Operator.Word
    ]
    assert keywords == [
        (at, token)
        for at, token, scope in by_textmate
        if re.match(r"keyword|storage|constant\.language|invalid", scope) and token.isidentifier()
    ]


def test_textmate_file_is_current() -> None:
    assert textmate.FILE.read_text() == textmate.text(), "run python -m cdlc.editors.textmate"
    assert json.loads(textmate.text())["scopeName"] == "source.cdl"


def test_pygments_finds_the_lexer() -> None:
    assert isinstance(get_lexer_by_name("cdl"), CdlLexer)
    assert isinstance(get_lexer_for_filename("blocks.cdl"), CdlLexer)


def test_broken_text_is_coloured_too() -> None:
    text = 'behavior "unclosed\n  ?? achieve x\n'
    tokens = pygments_tokens(text)
    assert "".join(token for _, token, _ in tokens) == text
    assert (text.index("achieve"), "achieve", Token.Keyword) in tokens


def test_only_the_lexer_imports_pygments() -> None:
    importing = {
        path.name
        for path in (ROOT / "cdlc").rglob("*.py")
        if re.search(r"^\s*(import|from) pygments", path.read_text(), re.MULTILINE)
    }
    assert importing == {"pygments_lexer.py"}
