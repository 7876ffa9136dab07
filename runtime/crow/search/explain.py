"""Why a search found nothing: what failed farthest on the way to the goal."""

from crow.explanation import Obstacle
from crow.search.expressions import names_of
from crow.search.machine import Machine


def explanation(machine: Machine) -> str | None:
    """The condition that failed farthest on the way, and the facts it reads.

    The goal, where nothing had failed yet; None where nothing was begun.
    """
    dead = machine.dead
    if dead.test is None or dead.state is None:
        goal = machine.programs.goal(machine.problem.goal)[1]
        dead.note(machine.start(), "it has not become true so far", goal, ())
    if dead.test is None or dead.state is None:
        return None
    test = dead.test
    names = names_of(test.slots, dead.values)
    obstacle = Obstacle(test.condition, names, test.location, dead.reason, dead.state.cells)
    return obstacle.text(machine.problem)
