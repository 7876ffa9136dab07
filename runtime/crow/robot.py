"""An environment whose controllers are Python, marked with `crow.controller`."""

from collections.abc import Callable

from crow.execution import DONE, Observation
from crow.functions import FunctionsError, Mistake
from crow.problem import Problem
from crow.program import Do
from crow.program.walk import statements_within
from crow.values import Value


class Robot:
    """Carries the controllers of a problem out by the Python registered for them.

    `observe` gives the state that is observed, as an Environment's does. What a controller's Python
    returns is what became of the call: `done` or `failed`, the state that it has led to, or None,
    which is `done`. Raises FunctionsError where a behavior runs a controller that has no Python.
    """

    def __init__(self, problem: Problem, observe: Callable[[], Observation]) -> None:
        world = problem.world
        self.observe = observe
        self.controllers = {n: one.call for n, one in world.registered.controllers.items()}
        called = {
            statement.controller
            for behavior in world.program.behaviors
            for statement in statements_within(behavior.body)
            if isinstance(statement, Do)
        }
        missing = [world.controllers[name] for name in sorted(called - self.controllers.keys())]
        if missing:
            told = [Mistake(f"`{c.name}` has no `@crow.controller`", c.location) for c in missing]
            raise FunctionsError("\n".join(mistake.message for mistake in told), tuple(told))

    def act(self, controller: str, arguments: tuple[Value, ...]) -> str | Observation:
        """Run a controller; what its Python raises is a failure of the call."""
        outcome: str | Observation | None = self.controllers[controller](*arguments)
        return DONE if outcome is None else outcome
