"""The replayer: a state and a trace, item by item, to ok or the first failing item (§2.2).

It is kept apart from every search so that it cannot share a mistake with one.
"""

from dataclasses import dataclass

from crow.evaluate import EvaluationError, execute, holds
from crow.problem import Problem, State, World
from crow.program import Expression, Location
from crow.text import expression_text
from crow.trace import AssertItem, DoItem, EffItem, Trace
from crow.values import Value


@dataclass(frozen=True, slots=True)
class Failure:
    """The first item that does not hold: its position in the trace, and why."""

    index: int
    condition: str
    reason: str
    location: Location | None


@dataclass(frozen=True, slots=True)
class Replay:
    """The projected state after each item that was reached, and the failure, if there was one."""

    states: tuple[State, ...]
    failure: Failure | None

    @property
    def is_sound(self) -> bool:
        """Whether every item held."""
        return self.failure is None

    @property
    def final(self) -> State:
        """The last projected state."""
        return self.states[-1]


def replay(world: World, initial: State, trace: Trace) -> Replay:
    """Run a trace from a state.

    Returns the projected states, the initial one first, up to the first item that fails.
    """
    states = [initial]
    for index, item in enumerate(trace):
        state = states[-1]
        try:
            match item:
                case AssertItem(condition=condition, variables=variables):
                    if not holds(world, state, condition, variables):
                        failure = Failure(index, item.text, "it is false here", item.location)
                        return Replay(tuple(states), failure)
                case EffItem(statements=statements, variables=variables):
                    state = execute(world, state, statements, variables)
                case DoItem():
                    pass
        except EvaluationError as error:
            text = item.text if isinstance(item, AssertItem) else "effect"
            failure = Failure(index, text, str(error), error.location or item.location)
            return Replay(tuple(states), failure)
        states.append(state)
    return Replay(tuple(states), None)


def replay_to_goal(problem: Problem, trace: Trace) -> Replay:
    """Run a trace from the initial state and test the goal after it."""
    goal = goal_item(problem.goal)
    return replay(problem.world, problem.initial, (*trace, goal))


def goal_item(goal: Expression, variables: dict[str, Value] | None = None) -> AssertItem:
    """The assertion of the goal that ends every trace."""
    return AssertItem(goal, variables or {}, expression_text(goal), location=goal.location)
