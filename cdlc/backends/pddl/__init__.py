"""PDDL: what fits, the actions of a program, their text, and plans back to CDL (lowering.md §2).

fit         what keeps a program from being PDDL
methods     the steps of methods as behaviors of their own
normal      triples whose terms are variables and objects
enumerated  whole numbers as objects over tables
cases       choices in values as one case a path
costs       what actions cost
actions     triples merged into actions
conditions, effects, numbers, axioms, linear, defined, sexpr   formulas
domain, problems, names                                        text
emit        all of it in order
plans       plans of PDDL planners as transitions of the program
instances   the values under which a triple leads from one state to another
inverse     plans of the runtime as plans of the emitted PDDL
solve       planning with an engine: emit, solve, map back, replay
"""

from cdlc.backends.pddl.emit import Emission, PddlTask, to_pddl
from cdlc.backends.pddl.plans import read_plan, to_step

__all__ = ["Emission", "PddlTask", "to_pddl", "read_plan", "to_step"]
