"""Names for people of the variables that formulas bind themselves."""

from collections.abc import Collection

from crow.program import Parameter
from crow.program.names import fresh_name


def shown_name(variable: Parameter, taken: Collection[str]) -> str:
    """A free name for a variable that the pool has named: after what it was, or its type."""
    base = variable.name.split("'")[0]
    if base.startswith("_"):
        base = str(variable.type)[:1].lower()
    return fresh_name(base, taken)
