"""Navigation among movable obstacles, the paper's first example (§1, §3.2, App. C).

    from examples import namo

    problem = namo.problem("hard", strategy="interleaved")

Programs are in *.cdl, their functions and generators in world.py, maps in maps/.
"""

from .maps import MAPS, STRATEGIES, Strategy, map_text, problem

__all__ = ["MAPS", "STRATEGIES", "Strategy", "map_text", "problem"]
