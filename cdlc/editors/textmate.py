"""The TextMate grammar, for Visual Studio Code, Sublime Text, JetBrains editors and GitHub.

`python -m cdlc.editors.textmate` writes it beside this file after a change of cdl.lark; a test says
when that is due.
"""

import json
from pathlib import Path
from typing import Any

from cdlc.editors.vocabulary import (
    BEFORE_COLON,
    BEFORE_NAME,
    BEFORE_STRING,
    CONSTANTS,
    DEFINITIONS,
    EACH,
    FUNCTIONS,
    INNER,
    OPERATOR_SIGNS,
    OPERATORS,
    ORDERS,
    SECTIONS,
    TITLES,
    TYPES,
    any_of,
    vocabulary,
)

FILE = Path(__file__).with_name("cdl.tmLanguage.json")

_START = r"^[ \t]*"
_WORD = r"(?<![A-Za-z0-9_])"
_TYPE_END = r"(?:\[[^\[\]]*\])*"


def grammar() -> dict[str, Any]:
    """The grammar as the JSON object editors read."""
    return {
        "name": "CDL",
        "scopeName": "source.cdl",
        "fileTypes": ["cdl"],
        "comment": "written by cdlc/editors/textmate.py from cdl.lark",
        "patterns": [*_literals(), *_soft_words(), *_hard_words(), *_names()],
    }


def text() -> str:
    """The grammar's file."""
    return json.dumps(grammar(), indent=2) + "\n"


def _literals() -> list[dict[str, Any]]:
    patterns = vocabulary().patterns
    return [
        _rule("comment.line.number-sign", patterns["COMMENT"]),
        _rule("string.quoted.double", patterns["STRING"]),
        _rule("constant.numeric.float", f"{_WORD}(?:{patterns['FLOAT']})"),
        _rule("constant.numeric.integer", f"{_WORD}{patterns['INT']}"),
    ]


def _soft_words() -> list[dict[str, Any]]:
    """Words that are keywords only where they stand, as far as a line tells."""
    order = rf"(promotable)[ \t]+({any_of(ORDERS)}){BEFORE_COLON}"
    return [
        _captures(_START + f"({any_of(DEFINITIONS)}){BEFORE_NAME}", "storage.type"),
        _captures(_START + f"({any_of(TITLES)}){BEFORE_STRING}", "keyword.control"),
        _captures(_START + f"({any_of(SECTIONS)}){BEFORE_COLON}", "keyword.control"),
        _captures(_START + order, "keyword.control", "keyword.control"),
        _captures(rf"{_WORD}(for)[ \t]+({EACH})", "keyword.control", "keyword.control"),
    ]


def _hard_words() -> list[dict[str, Any]]:
    words = vocabulary()
    return [
        _rule("keyword.operator.word", _WORD + any_of(OPERATORS)),
        _rule("constant.language", _WORD + any_of(CONSTANTS)),
        _rule("keyword.control", _WORD + any_of(words.statements)),
        _rule("invalid.illegal.reserved", _WORD + any_of(words.reserved)),
    ]


def _names() -> list[dict[str, Any]]:
    name = _WORD + vocabulary().patterns["NAME"]
    inner = rf"[ \t]+({any_of(INNER)})"
    return [
        _captures(f"{_WORD}({any_of(TYPES)}){_TYPE_END}{inner}", "support.type", "keyword.control"),
        _captures(name + _TYPE_END + inner, "keyword.control"),
        _rule("support.type", _WORD + any_of(TYPES)),
        _rule("support.function.builtin", rf"{_WORD}{any_of(FUNCTIONS)}(?=[ \t]*\()"),
        _rule("keyword.operator", OPERATOR_SIGNS),
    ]


def _rule(scope: str, pattern: str) -> dict[str, Any]:
    return {"name": f"{scope}.cdl", "match": pattern}


def _captures(pattern: str, *scopes: str) -> dict[str, Any]:
    """A pattern whose groups are coloured and nothing else of it."""
    named = {str(index): {"name": f"{scope}.cdl"} for index, scope in enumerate(scopes, 1)}
    return {"match": pattern, "captures": named}


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8", newline="\n")
