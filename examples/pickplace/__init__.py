"""Picking and placing with continuous poses, grasps and paths: task and motion planning in small.

    from examples import pickplace

    problem = pickplace.blocked(3)

The program is pickplace.cdl, its functions and generators are in world.py; problems are in *.cdl,
and in problems.py in any size.
"""

from .problems import Layout, blocked, crowded, gate, tight
from .render import drawn, picture, strip
from .scenes import Scene, scenes

__all__ = [
    "Layout",
    "tight",
    "blocked",
    "crowded",
    "gate",
    "Scene",
    "scenes",
    "drawn",
    "strip",
    "picture",
]
