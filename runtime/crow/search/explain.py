"""Why a search found nothing: what failed farthest on the way to the goal."""

from crow.explanation import Obstacle
from crow.search.expressions import names_of
from crow.search.machine import Machine


def explanation(machine: Machine) -> str | None:
    """The condition that failed farthest on the way, and the facts it reads; None without one."""
    dead = machine.dead
    if dead.test is None or dead.state is None:
        return None
    test = dead.test
    names = names_of(test.slots, dead.values)
    obstacle = Obstacle(test.condition, names, test.location, dead.reason, dead.state.cells)
    return obstacle.text(machine.problem)
