"""CDL for Pygments, under the name `cdl`: code in documentation and terminals in colour.

The only module that imports pygments, which the package itself does without.
"""

import re
from typing import ClassVar

from pygments.lexer import RegexLexer, bygroups, default
from pygments.token import (
    Comment,
    Keyword,
    Name,
    Number,
    Operator,
    Punctuation,
    String,
    Whitespace,
)

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

_WORDS = vocabulary()
_PATTERNS = _WORDS.patterns
_SPACE = r"[ \t\f\r]"
_START = rf"^({_SPACE}*)"


class CdlLexer(RegexLexer):  # type: ignore[misc]  # pygments has no types
    """Colours CDL; soft keywords only where, as far as a line tells, they are keywords."""

    name = "CDL"
    aliases: ClassVar = ["cdl"]
    filenames: ClassVar = ["*.cdl"]
    mimetypes: ClassVar = ["text/x-cdl"]
    flags = re.MULTILINE

    tokens: ClassVar = {
        "root": [
            (_START + f"({any_of(DEFINITIONS)}){BEFORE_NAME}", bygroups(Whitespace, Keyword)),
            (_START + f"({any_of(TITLES)}){BEFORE_STRING}", bygroups(Whitespace, Keyword)),
            (_START + f"({any_of(SECTIONS)}){BEFORE_COLON}", bygroups(Whitespace, Keyword)),
            (
                _START + rf"(promotable)({_SPACE}+)({any_of(ORDERS)}){BEFORE_COLON}",
                bygroups(Whitespace, Keyword, Whitespace, Keyword),
            ),
            (rf"{_SPACE}+|\n", Whitespace),
            (_PATTERNS["COMMENT"], Comment.Single),
            (_PATTERNS["STRING"], String.Double),
            (_PATTERNS["FLOAT"], Number.Float),
            (_PATTERNS["INT"], Number.Integer),
            (rf"(for)({_SPACE}+)({EACH})", bygroups(Keyword, Whitespace, Keyword)),
            (any_of(OPERATORS), Operator.Word),
            (any_of(CONSTANTS), Keyword.Constant),
            (any_of(_WORDS.statements), Keyword),
            (any_of(_WORDS.reserved), Keyword.Reserved),
            (rf"{any_of(FUNCTIONS)}(?={_SPACE}*\()", Name.Builtin),
            (any_of(TYPES), Keyword.Type, "after a name"),
            (_PATTERNS["NAME"], Name, "after a name"),
            (OPERATOR_SIGNS, Operator),
            (r"\]\]|\.\.\.|[(\[),:;]", Punctuation),
            (r"\]", Punctuation, "after a name"),
        ],
        "after a name": [
            (rf"({_SPACE}+)({any_of(INNER)})", bygroups(Whitespace, Keyword), "#pop"),
            default("#pop"),
        ],
    }
