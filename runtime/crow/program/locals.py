"""Local variables in nested blocks, which may hide those of the blocks around them."""

from collections import ChainMap
from typing import Any

Locals = ChainMap[str, Any]
"""The variables of a block over those of the blocks around it."""


def set_local(variables: Locals, name: str, value: object) -> None:
    """Assign a local of this block, or else of the nearest block around it that has one."""
    next(scope for scope in variables.maps if name in scope)[name] = value
