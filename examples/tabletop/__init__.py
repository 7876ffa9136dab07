"""Blocks on a table in MuJoCo: planning asks the engine, and execution goes on in it.

    from examples import tabletop

    problem = tabletop.tidy()
    record = crow.execute(problem, tabletop.Robot(problem))

The program is tabletop.cdl; world.py has the simulation, and what the program asks it.
"""

from .problems import problem, tidy
from .robot import Robot
from .world import Body

__all__ = ["problem", "tidy", "Body", "Robot"]
