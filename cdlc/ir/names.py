"""Names that are not taken, and names of formulas' own variables for people."""

from collections.abc import Collection

from crow.program import Parameter


def fresh_name(name: str, taken: Collection[str]) -> str:
    """The name itself, or with the first number from 2 that makes it free: `y`, `y_2`, …"""
    candidate, number = name, 1
    while candidate in taken:
        number += 1
        candidate = f"{name}_{number}"
    return candidate


def shown_name(variable: Parameter, taken: Collection[str]) -> str:
    """A free name for a variable that the pool has named: after what it was, or its type."""
    base = variable.name.split("'")[0]
    if base.startswith("_"):
        base = str(variable.type)[:1].lower()
    return fresh_name(base, taken)
