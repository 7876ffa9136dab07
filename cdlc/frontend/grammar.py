"""The LALR parser built from cdl.lark, kept in the user's cache directory between runs.

Building the tables takes about half a second, reading them back a tenth of that.
"""

import hashlib
import os
import sys
import tempfile
from collections.abc import Iterator
from functools import cache
from importlib import resources
from pathlib import Path

import lark

from cdlc.frontend.build import Builder

# What a file is read as, one piece at a time; `file` documents and tests the whole.
STARTS = ["definition", "statement", "objects_line", "file"]


class _KeepTokens:
    """Tells lark to lex terminals that no rule uses; the stream itself is left alone."""

    always_accept = ("LINE_END", "UNREADABLE", "RESERVED")

    def process(self, stream: Iterator[lark.Token]) -> Iterator[lark.Token]:
        return stream


def grammar_text() -> str:
    """The grammar, as shipped and as printed in the documentation."""
    return resources.files("cdlc.frontend").joinpath("cdl.lark").read_text("utf-8")


@cache
def parser() -> lark.Lark:
    """The parser, read from the cache or built and put there; an unusable cache is ignored."""
    text = grammar_text()
    path = _cache_path(text)
    if path is not None:
        try:
            with path.open("rb") as file:
                return lark.Lark.load(file, transformer=Builder(), postlex=_KeepTokens())
        except Exception:  # noqa: BLE001, S110 - any damage to the cache means: build anew
            pass
    built = build(text)
    if path is not None:
        _store(built, path)
    return built


def build(text: str, *, strict: bool = False) -> lark.Lark:
    """Build the parser from the grammar's text.

    With `strict`, a conflict or an ambiguous terminal raises lark.exceptions.GrammarError.
    """
    return lark.Lark(
        text,
        parser="lalr",
        lexer="basic",
        start=STARTS,
        maybe_placeholders=True,
        postlex=_KeepTokens(),
        transformer=Builder(),
        strict=strict,
    )


def _cache_path(text: str) -> Path | None:
    """Where the tables of this grammar are kept; None where there is no home for them."""
    root = os.environ.get("XDG_CACHE_HOME")
    try:
        folder = Path(root) if root else Path.home() / ".cache"
    except RuntimeError:
        return None
    version = f"{lark.__version__} {sys.version_info[:2]} {STARTS}"
    key = hashlib.sha256(f"{version}\n{text}".encode()).hexdigest()[:16]
    return folder / "cdlc" / f"grammar-{key}.pickle"


def _store(built: lark.Lark, path: Path) -> None:
    """Write the tables whole or not at all; no cache is no error."""
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
            built.save(file)
        Path(file.name).replace(path)
    except OSError:
        return
