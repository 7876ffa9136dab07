"""Constraints over unknowns, and the solver of App. B.1.

store = Store.of(world).having(Constraint(condition, variables, state))
for solution in Solver(world, Draws(world, seed=0)).solutions(store):
    print(solution.values)
"""

from crow.constraints.choices import Cut, Drawing
from crow.constraints.constraint import Conflict, Constraint
from crow.constraints.draws import Draws
from crow.constraints.solver import Solutions, Solver
from crow.constraints.store import Store

__all__ = ["Constraint", "Conflict", "Store", "Draws", "Solver", "Solutions", "Drawing", "Cut"]
