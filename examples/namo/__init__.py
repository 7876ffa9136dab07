"""Navigation among movable obstacles, the paper's first example (§1, §3.2, App. C).

    from examples import namo

    problem = namo.problem("hard", strategy="interleaved")

Programs are in *.cdl, their functions and generators in world.py, maps in maps/.
"""

from .problems import MAPS, STRATEGIES, MapError, Strategy, problem, rows_of
from .render import picture, watch
from .robot import PushedBack, Robot
from .rooms import corridor, suite
from .scenes import CollisionError, Scene, scenes

__all__ = [
    "MAPS",
    "STRATEGIES",
    "Strategy",
    "MapError",
    "problem",
    "rows_of",
    "Scene",
    "scenes",
    "CollisionError",
    "picture",
    "watch",
    "Robot",
    "PushedBack",
    "suite",
    "corridor",
]
