"""A program as a policy: from an observed state to the next controller call (§2, semantics.md §5).

The rest of a plan is kept as long as it replays from what is observed; if not, there is a new plan.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from crow.evaluate import EvaluationError, holds
from crow.observing import Observing
from crow.outside import hashable
from crow.plan import Result, Step, call_text
from crow.planning import Planning
from crow.problem import Cell, Problem, State, World
from crow.replay import Failure, replay, replay_to_goal
from crow.results import Plan
from crow.trace import DoItem, EffItem, Trace, TraceItem
from crow.values import Value, given_out


@dataclass(frozen=True, slots=True, eq=False)
class ControllerCall:
    """The next thing to do; opaque values among the arguments are compared by identity."""

    controller: str
    arguments: tuple[Value, ...] = ()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ControllerCall) and self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())

    def _key(self) -> tuple[Value, ...]:
        return (self.controller, *map(hashable, self.arguments))

    def __str__(self) -> str:
        return call_text(self.controller, self.arguments, {})


@dataclass(frozen=True, slots=True)
class Done:
    """The goal holds."""


@dataclass(frozen=True, slots=True)
class Stuck:
    """There is no plan from here: `result` says why."""

    result: Result


Decision = ControllerCall | Done | Stuck


class Policy:
    """What to do in a state, so that the goal of a problem will hold.

    `options` are those of `crow.plan`; a time limit is one for each time of planning. Raises what
    `crow.plan` raises.
    """

    def __init__(self, problem: Problem, engine: str = "auto", **options: Any) -> None:
        Planning(problem, engine, **options)
        self.problem = problem
        self.engine = engine
        self.options = options
        self.observing = Observing(problem.world)
        self.plan: Plan | None = None
        self.reason: Failure | None = None
        self._course: Course | None = None

    def step(self, state: State | Mapping[Cell, object]) -> Decision:
        """The next call, in the state that the one before has left; or Done, or Stuck.

        To ask again says that the call before was carried out; `failed` takes it back. `plan` is
        what is being followed, and `reason` why the plan before it was given up in this step.
        Raises ValueError for a state with cells or values that the program does not have.
        """
        self.reason = None
        observed = self.observing.state(state)
        if not self._goes_on(observed):
            if self._is_reached(observed):
                self._forget()
                return Done()
            here = self.problem.changed(initial=observed)
            planned = Planning(here, self.engine, **self.options).first()
            if not isinstance(planned, Plan):
                self._forget()
                return Stuck(planned)
            self.plan, self._course = planned, Course(self.problem.world, observed, planned)
        assert self._course is not None
        return self._course.next_call() or Done()

    def failed(self) -> None:
        """Say that the last call failed: its plan is given up, and the next step makes another."""
        self._forget()

    def _forget(self) -> None:
        self.plan = self._course = None

    def _is_reached(self, observed: State) -> bool:
        try:
            return holds(self.problem.world, observed, self.problem.goal, {})
        except EvaluationError:
            return False

    def _goes_on(self, observed: State) -> bool:
        """Whether the rest of the plan replays from here.

        It does where all is as projected, so that a plan that goes well costs a comparison a step.
        Where something is not, the goal may hold already, and the plan is over.
        """
        if self._course is None:
            return False
        expected = self._course.expected
        snapped = self.observing.snapped(observed, expected)
        if snapped == expected:
            return True
        if self._is_reached(snapped):
            return False
        rest = self._course.rest()
        self.reason = replay_to_goal(self.problem.changed(initial=snapped), rest).failure
        return self.reason is None


@dataclass(frozen=True, slots=True)
class _Stage:
    """A call in a trace; once it is done, the items from `end` on are left, and `kept` before them.

    Its effects have happened then, and what was asserted before them is over. `kept` are effects
    that no controller brought about: what they write may be nothing that can be observed.
    """

    call: ControllerCall
    end: int
    kept: Trace


class Course:
    """A plan that is being carried out from a state."""

    def __init__(self, world: World, start: State, plan: Plan) -> None:
        self.trace = plan.trace
        self.states = replay(world, start, plan.trace).states
        self.stages = _stages(plan)
        self.position = -1

    @property
    def expected(self) -> State:
        """The state in which things should be after the last call."""
        return self.states[self.stages[self.position].end if self.position >= 0 else 0]

    def rest(self) -> Trace:
        """What is left after the last call."""
        if self.position < 0:
            return self.trace
        stage = self.stages[self.position]
        return (*stage.kept, *self.trace[stage.end :])

    def next_call(self) -> ControllerCall | None:
        """Go on to the next call; None after the last."""
        if self.position + 1 >= len(self.stages):
            return None
        self.position += 1
        return self.stages[self.position].call


def _stages(plan: Plan) -> list[_Stage]:
    """The calls of a plan, each with where its effects end."""
    trace = plan.trace
    places = [i for i, item in enumerate(trace) if isinstance(item, DoItem)]
    without_call = [s for s in plan.steps if s.controller is None]
    stages: list[_Stage] = []
    if not places:
        return stages
    for item in trace[: places[0]]:
        _take(without_call, item)
    for place, following in zip(places, (*places[1:], len(trace)), strict=True):
        end, kept, pending = place + 1, list[TraceItem](), list[TraceItem]()
        for index in range(place + 1, following):
            item = trace[index]
            if _take(without_call, item):
                pending.append(item)
            elif isinstance(item, EffItem):
                end = index + 1
                kept += pending
                pending = []
        do = trace[place]
        assert isinstance(do, DoItem)
        stages.append(
            _Stage(
                ControllerCall(do.controller, tuple(map(given_out, do.arguments))), end, tuple(kept)
            )
        )
    return stages


def _take(steps: list[Step], item: TraceItem) -> bool:
    """Whether an item is the effect of one of some steps; that step is taken out."""
    if not isinstance(item, EffItem):
        return False
    for step in steps:
        names = [p.name for p in item.parameters]
        own = {**dict(zip(names, step.behavior_arguments, strict=False)), **step.bindings}
        variables = item.variables.items()
        if item.owner == step.behavior and all(own.get(n, v) == v for n, v in variables):
            steps.remove(step)
            return True
    return False
