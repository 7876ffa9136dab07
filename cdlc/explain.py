"""What the codes of diagnostics mean: the docstring of each kind is its page."""

import inspect

import cdlc.backends.errors
import cdlc.bench.errors
import cdlc.ir.errors
import cdlc.plans.errors
import cdlc.verify.errors  # noqa: F401 - the modules register their kinds
from cdlc.diagnostics import Diagnostic, nearest
from cdlc.frontend import errors

errors.load()


def codes() -> tuple[str, ...]:
    """All codes, in alphabetical order."""
    return tuple(sorted(Diagnostic.kinds))


def explain(code: str) -> str | None:
    """The page of a code: what it means, why, an example and its cure. None for no code."""
    kind = Diagnostic.kinds.get(code)
    if kind is None:
        return None
    return f"{kind.severity}[{code}]\n\n{inspect.cleandoc(kind.__doc__ or '')}\n"


def similar(code: str) -> str | None:
    """The code most like a text that is none, as `unknown-feature` is like `UnknownFeatur`."""
    words = (
        "".join(f"-{c.lower()}" if c.isupper() else c for c in code).strip("-").replace("_", "-")
    )
    return nearest(words, list(codes()))
