"""PDDL: what fits, the actions of a program, their text, and plans back to CDL (lowering.md §2).

names       CDL names to PDDL names and back
conditions  formulas to PDDL conditions
actions     triples merged into actions
emit        the text of domain and problem
plans       plans of PDDL planners as transitions of the program
"""

from cdlc.backends.pddl.emit import Emission, PddlTask, to_pddl
from cdlc.backends.pddl.plans import read_plan, to_step

__all__ = ["Emission", "PddlTask", "to_pddl", "read_plan", "to_step"]
