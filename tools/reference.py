"""Write the pages of docs/reference that are made from the code: `python tools/reference.py`."""

import inspect
import sys
from pathlib import Path

from cdlc import explain
from cdlc.diagnostics import Diagnostic, Severity
from cdlc.frontend.grammar import grammar_text

FOLDER = Path(__file__).resolve().parent.parent / "docs" / "reference"
MADE = "<!-- Made by tools/reference.py; change the code instead. -->"

DIAGNOSTICS = """# Diagnostics

What `cdlc` says about its input, by code. Errors stop the compiler, warnings do not. `cdlc explain
CODE` prints the entry of a code.
"""
GRAMMAR = """# Grammar

The syntax of CDL, as lark reads it. `INDENT` and `DEDENT` mark where a block starts and ends and
`NEWLINE` the end of a line; inside brackets there are none. Words that are keywords in one place
are names in every other, as the rule `name` says.
"""


def pages() -> dict[str, str]:
    """The text of each page by its file name."""
    return {"diagnostics.md": _diagnostics(), "grammar.md": _grammar()}


def _diagnostics() -> str:
    parts = [MADE, DIAGNOSTICS]
    for severity in Severity:
        parts.append(f"## {severity.capitalize()}s\n")
        for code in explain.codes():
            kind = Diagnostic.kinds[code]
            if kind.severity is severity:
                parts.append(f"### {code}\n\n{inspect.cleandoc(kind.__doc__ or '')}\n")
    return "\n".join(parts)


def _grammar() -> str:
    return f"{MADE}\n{GRAMMAR}\n```lark\n{grammar_text().rstrip()}\n```\n"


def main() -> int:
    """Write the pages."""
    for name, text in pages().items():
        (FOLDER / name).write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
