"""Constraints over unknowns, and the solver of App. B.1."""

from crow.constraints.constraint import Conflict, Constraint
from crow.constraints.store import Store

__all__ = ["Constraint", "Conflict", "Store"]
