"""The LALR parser built from cdl.lark, kept in the user's cache directory between runs.

Building the tables takes about half a second, reading them back a tenth of that.
"""

import hashlib
import os
import pkgutil
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import lark

from cdlc.frontend.build import Builder

# What a file is read as, one piece at a time; `file` documents and tests the whole.
STARTS = ["definition", "statement", "objects_line", "file"]


class KeepTokens:
    """Tells lark to lex terminals that no rule uses; the stream itself is left alone."""

    always_accept = ("LINE_END", "RESERVED", "UNCLOSED", "QUOTED", "FOREIGN", "UNREADABLE")

    def process(self, stream: Iterator[lark.Token]) -> Iterator[lark.Token]:
        """The stream as it is."""
        return stream


def grammar_text() -> str:
    """The grammar, as shipped and as printed in the documentation."""
    # `importlib.resources` would say the same and cost a tenth of the start-up.
    data = pkgutil.get_data("cdlc.frontend", "cdl.lark")
    assert data is not None
    return data.decode()


@cache
def parser() -> lark.Lark:
    """The parser, read from the cache or built and put there; an unusable cache is ignored."""
    return build(grammar_text(), cache_file=_cache_file(grammar_text()))


def build(text: str, *, cache_file: Path | None = None, strict: bool = False) -> lark.Lark:
    """Build the parser from the grammar's text.

    With `strict`, a conflict or an ambiguous terminal raises lark.exceptions.GrammarError.
    """
    built = lark.Lark(
        text,
        parser="lalr",
        lexer="basic",
        start=STARTS,
        maybe_placeholders=True,
        postlex=KeepTokens(),
        transformer=Builder(),
        strict=strict,
        cache=str(cache_file) if cache_file else False,
    )
    # Otherwise each `lex` would build a lexer of its own.
    built.lexer = built.parser.lexer
    return built


def _cache_file(text: str) -> Path | None:
    """Where the tables are kept, in a folder of the user's own since they are read as a pickle.

    None where there is no home to keep them in.
    """
    root = os.environ.get("XDG_CACHE_HOME")
    try:
        folder = (Path(root) if root else Path.home() / ".cache") / "cdlc"
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    except (OSError, RuntimeError):
        return None
    key = hashlib.sha256(text.encode()).hexdigest()[:12]
    return folder / f"grammar-{key}-{sys.version_info[0]}{sys.version_info[1]}.pickle"
