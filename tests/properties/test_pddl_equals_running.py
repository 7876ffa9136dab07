"""Emitted PDDL in unified-planning's simulator against the interpreter: every kind of feature."""

from itertools import product
from typing import Any

import pytest
from discrete_programs import OBJECTS, STATES, Case, cases
from hypothesis import HealthCheck, Phase, given, settings
from programs import program_of

from cdlc.backends.pddl import PddlTask, to_pddl
from cdlc.diagnostics import Collector
from cdlc.ir.hoare import Model
from crow.problem import Problem, State, World
from crow.program import BOOL, Constant, Parameter
from crow.program.types import ObjectType, is_boolean, is_number
from crow.transition import apply
from crow.values import default_value

# unified-planning's reader calls its parser by old names.
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")

TRUE = Constant(value=True, type=BOOL)
Values = dict[tuple[str, tuple[str, ...]], object]
SETTINGS = settings(
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
    # Shrinking a case of many simulations takes longer than reading it.
    phases=[Phase.explicit, Phase.reuse, Phase.generate],
)


def world_of(case: Case) -> World:
    objects = tuple(Parameter(n, ObjectType(t)) for n, t in OBJECTS.items() if n != "home")
    return World.of(program_of(case.text), objects)


def state_of(world: World, values: Values) -> State:
    types = {f.name: f.type for f in world.program.features}
    return State({c: v for c, v in values.items() if v != default_value(types[c[0]])})


def task_of(world: World, state: State) -> PddlTask | None:
    """The PDDL, or None for what is rightly refused."""
    found = Collector()
    model = Model(world.program)
    task = to_pddl(model, Problem.made("random", world, state, TRUE), found)
    for diagnostic in found:
        is_refused = diagnostic.code == "no-hoare-model"
        assert is_refused or "may write twice" in diagnostic.message(), diagnostic.message()
    return task


class Simulated:
    """The emitted task in unified-planning's simulator."""

    def __init__(self, world: World, task: PddlTask) -> None:
        from unified_planning.engines.sequential_simulator import UPSequentialSimulator
        from unified_planning.io import PDDLReader

        self.world, self.task = world, task
        self.pddl = PDDLReader().parse_problem_string(task.domain, task.problem)
        self.simulator = UPSequentialSimulator(self.pddl)
        self.before = self.simulator.get_initial_state()

    def after(self, values: dict[str, str]) -> State | None:
        """The state after the action for these values of the variables of `act`."""
        if not self.task.actions:  # one that can never be applied is left out
            return None
        (action,) = self.task.actions
        (source,) = action.sources
        given: dict[str, str] = {}
        for chosen in source.variables:
            value = values[chosen.variable.name]
            if chosen.object is not None and chosen.object != value:
                return None
            if chosen.parameter is not None and given.setdefault(chosen.parameter, value) != value:
                return None
        if not all(
            self.world.is_of(given[p.name], p.type) for p in action.parameters if p.name in given
        ):
            return None
        # Parameters that only hold what is read are determined by the state.
        choices = [
            (given[p.name],) if p.name in given else self.world.objects_of(p.type)
            for p in action.parameters
        ]
        found = [s for s in map(self._applied, product(*choices)) if s is not None]
        assert len(found) <= 1, values
        return found[0] if found else None

    def _applied(self, arguments: tuple[str, ...]) -> State | None:
        from unified_planning.exceptions import UPInvalidActionError

        try:
            state = self.simulator.apply(
                self.before, self.pddl.actions[0], [self._object(a) for a in arguments]
            )
        except UPInvalidActionError:  # its precondition is false whatever the state
            return None
        return None if state is None else self._read(state)

    def _object(self, name: str) -> Any:
        return self.pddl.object(self.task.names.get("object", name).lower())

    def _read(self, state: Any) -> State:
        values: Values = {}
        for feature in self.world.program.features:
            fluent = self.pddl.fluent(self.task.names.get("feature", feature.name).lower())
            for where in self.world.cells(feature):
                terms = [self._object(o) for o in where]
                cell = (feature.name, where)
                if is_boolean(feature.type):
                    values[cell] = state.get_value(fluent(*terms)).is_true()
                elif is_number(feature.type):
                    number = state.get_value(fluent(*terms)).constant_value()
                    values[cell] = type(default_value(feature.type))(number)
                else:
                    (values[cell],) = (
                        o
                        for o in self.world.objects_of(feature.type)
                        if state.get_value(fluent(*terms, self._object(o))).is_true()
                    )
        return state_of(self.world, values)


def check(case: Case, values: Values) -> bool:
    """Whether there was something to compare."""
    world = world_of(case)
    state = state_of(world, values)
    task = task_of(world, state)
    if task is None:
        return False
    simulated = Simulated(world, task)
    behavior = world.behaviors["act"]
    for arguments in case.arguments():
        ran = apply(world, state, behavior, arguments)
        after = None if ran.problem is not None else ran.state
        chosen = dict(zip(case.parameters, arguments, strict=True))
        assert simulated.after(chosen) == after, (case.text, arguments, task.domain, task.problem)
    return True


@given(cases(), STATES)
@settings(SETTINGS, max_examples=6)
def test_the_pddl_of_every_feature_is_what_running_does(case: Case, values: Values) -> None:
    check(case, values)


@pytest.mark.slow
@given(cases(), STATES)
@settings(SETTINGS, max_examples=2000)
def test_the_pddl_of_every_feature_is_what_running_does_on_many_programs(
    case: Case, values: Values
) -> None:
    check(case, values)
