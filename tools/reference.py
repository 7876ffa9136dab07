"""Write the pages and schemas that are made from the code: `python tools/reference.py`."""

import inspect
import json
import sys
from pathlib import Path
from typing import Any

from cdlc import explain
from cdlc.diagnostics import Diagnostic, Severity
from cdlc.frontend.grammar import grammar_text
from crow.program.schema import hoare_schema, schema

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "docs" / "reference"
SCHEMAS = ROOT / "cdlc" / "schemas"
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


def schemas() -> dict[str, dict[str, Any]]:
    """The schemas of what follows the classes of the program, by their file names."""
    return {"ir.json": schema(), "hoare.json": hoare_schema()}


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
    """Write the pages and schemas."""
    for name, text in pages().items():
        (FOLDER / name).write_text(text, encoding="utf-8")
    for name, document in schemas().items():
        (SCHEMAS / name).write_text(f"{json.dumps(document, indent=2)}\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
