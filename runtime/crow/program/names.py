"""Names that are not taken."""

from collections.abc import Collection


def fresh_name(name: str, taken: Collection[str]) -> str:
    """The name itself, or with the first number from 2 that makes it free: `y`, `y_2`, …"""
    candidate, number = name, 1
    while candidate in taken:
        number += 1
        candidate = f"{name}_{number}"
    return candidate
