"""Why a search found nothing: what failed, and what of it farthest on the way to the goal."""

from crow.explanation import Obstacle
from crow.search.code import Test
from crow.search.expressions import Environment, names_of
from crow.search.machine import Machine
from crow.search.points import Point
from crow.text import draws_text


def explanation(machine: Machine) -> str | None:
    """The condition that failed farthest on the way, and the facts it reads; None without one.

    After it, what became of the values that generators yielded.
    """
    dead = machine.dead
    if dead.test is None or dead.point is None:
        return None
    told = obstacle(dead.point, dead.test, dead.values, dead.reason).text(machine.problem)
    drawn = draws_text(machine.solving.draws.statistics()) if machine.draws_values else ""
    return f"{told}\n{drawn}" if drawn else told


def obstacle(point: Point, test: Test, values: Environment, reason: str) -> Obstacle:
    """A condition that failed at a point."""
    names = names_of(test.slots, values)
    return Obstacle(test.condition, names, test.location, reason, point.state.cells)
