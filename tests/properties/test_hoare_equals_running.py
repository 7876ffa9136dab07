"""The Hoare model against the interpreter, and both against the emitted PDDL."""

from typing import Any

import pytest
from boolean_programs import OBJECTS, STATES, Case, cases
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from programs import program_of

from cdlc.backends.pddl import to_pddl
from cdlc.diagnostics import Collector
from cdlc.ir.hoare import Model
from cdlc.ir.nodes import Level
from cdlc.ir.updates import NotModelled
from crow.evaluate import assignments_of, evaluate_shared
from crow.problem import Problem, State, World
from crow.program import BOOL, Constant, Parameter
from crow.program.triples import Triple
from crow.program.types import ObjectType
from crow.transition import Transition, apply

# unified-planning's reader calls its parser by old names.
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")

TRUE = Constant(value=True, type=BOOL)
LEVELS = st.sampled_from(Level)
Facts = frozenset[tuple[str, tuple[str, ...]]]

SETTINGS = settings(deadline=None, max_examples=60, suppress_health_check=[HealthCheck.too_slow])
MANY = settings(SETTINGS, max_examples=3000)
# Shrinking a case of many simulations takes longer than reading it.
UNSHRUNK = settings(SETTINGS, phases=[Phase.explicit, Phase.reuse, Phase.generate])


def world_of(case: Case) -> World:
    objects = tuple(Parameter(n, ObjectType(t)) for n, t in OBJECTS.items() if n != "home")
    return World.of(program_of(case.text), objects)


def apply_post(world: World, facts: State, found: Triple, values: dict[str, str]) -> State:
    """All updates at once: everything is of the state before, and later updates win."""
    cells = dict(facts.cells)
    for update in found.post:
        bound = tuple(Parameter(v.name, v.type) for v in update.variables)
        for inner in assignments_of(world, bound, values):
            if evaluate_shared(world, facts, update.guard, inner):
                where = tuple(evaluate_shared(world, facts, a, inner) for a in update.arguments)
                cells[update.feature, where] = evaluate_shared(world, facts, update.value, inner)
    return State({cell: True for cell, value in cells.items() if value})


def is_applicable(world: World, facts: State, found: Triple, values: dict[str, str]) -> bool:
    return all(evaluate_shared(world, facts, part, values) for part in found.pre)


def outcomes(case: Case, true: Facts, level: Level) -> list[tuple[tuple[str, ...], State | None]]:
    """For every tuple of arguments the state after `act` by the model, checked by running it."""
    world, state = world_of(case), State(dict.fromkeys(sorted(true), True))
    behavior = world.behaviors["act"]
    (found,) = Model(world.program, level).triples(behavior)
    after: list[tuple[tuple[str, ...], State | None]] = []
    for arguments in case.arguments():
        values = dict(zip(case.parameters, arguments, strict=True))
        ran: Transition = apply(world, state, behavior, arguments)
        applicable = is_applicable(world, state, found, values)
        assert applicable is (ran.problem is None), (case.text, arguments, ran.problem)
        model = apply_post(world, state, found, values) if applicable else None
        if model is not None:
            assert model == ran.state, (case.text, arguments, sorted(true))
        after.append((arguments, model))
    return after


def check_model(case: Case, true: Facts, level: Level) -> None:
    try:
        outcomes(case, true, level)
    except NotModelled as refused:
        raise AssertionError((case.text, refused.construct)) from refused


@given(cases(with_body=True), STATES, LEVELS)
@SETTINGS
def test_the_model_is_what_running_does(case: Case, true: Facts, level: Level) -> None:
    check_model(case, true, level)


@pytest.mark.slow
@given(cases(with_body=True), STATES, LEVELS)
@MANY
def test_the_model_is_what_running_does_on_many_programs(
    case: Case, true: Facts, level: Level
) -> None:
    check_model(case, true, level)


# ------------------------------------------------------------------------------------------- PDDL


class Simulated:
    """The emitted task in unified-planning's simulator."""

    def __init__(self, case: Case, true: Facts, level: Level) -> None:
        from unified_planning.engines.sequential_simulator import UPSequentialSimulator
        from unified_planning.io import PDDLReader

        world = world_of(case)
        initial = State(dict.fromkeys(sorted(true), True))
        problem = Problem.made("random", world, initial, TRUE)
        found = Collector()
        model = Model(world.program, level)
        task = to_pddl(model, problem, found)
        assert task is not None, [d.message() for d in found]
        assert task.problem is not None
        self.task = task
        self.world = world
        self.pddl = PDDLReader().parse_problem_string(task.domain, task.problem)
        self.simulator = UPSequentialSimulator(self.pddl)

    def after(self, case: Case, arguments: tuple[str, ...]) -> State | None:
        """The state after the one action with these arguments of `act`, if it is applicable."""
        from unified_planning.exceptions import UPInvalidActionError

        if not self.task.actions:  # one that can never be applied is left out
            return None
        (action,) = self.task.actions
        (source,) = action.sources
        values = dict(zip(case.parameters, arguments, strict=True))
        by_parameter: dict[str, str] = {}
        for chosen in source.variables:
            value = values[chosen.variable.name]
            if chosen.object not in (None, value):
                return None
            if chosen.parameter and by_parameter.setdefault(chosen.parameter, value) != value:
                return None
        if not all(self.world.is_of(by_parameter[p.name], p.type) for p in action.parameters):
            return None
        names = [self.task.names.get("object", by_parameter[p.name]) for p in action.parameters]
        objects = [self.pddl.object(name.lower()) for name in names]
        before = self.simulator.get_initial_state()
        try:
            state = self.simulator.apply(before, self.pddl.actions[0], objects)
        except UPInvalidActionError:  # its precondition is false whatever the state
            return None
        return None if state is None else self._read(state)

    def _read(self, state: Any) -> State:
        cells = {}
        for feature in self.world.program.features:
            fluent = self.pddl.fluent(self.task.names.get("feature", feature.name).lower())
            for where in self.world.cells(feature):
                names = [self.task.names.get("object", o).lower() for o in where]
                if state.get_value(fluent(*map(self.pddl.object, names))).is_true():
                    cells[feature.name, where] = True
        return State(cells)


def check_pddl(case: Case, true: Facts, level: Level) -> None:
    simulated = Simulated(case, true, level)
    for arguments, model in outcomes(case, true, level):
        assert simulated.after(case, arguments) == model, (case.text, arguments, simulated.task)


@given(cases(with_body=True), STATES, LEVELS)
@settings(UNSHRUNK, max_examples=12)
def test_the_pddl_is_what_running_does(case: Case, true: Facts, level: Level) -> None:
    check_pddl(case, true, level)


NARROWER = """
typedef T
typedef U: T
typedef W: T
typedef V
feature a()
feature p(x0: T)
feature q(x0: U)
feature on(x0: T, x1: T)
feature in(x0: V, x1: U)
object_constant home: U
controller change(x: T):
  eff:
    foreach z: U:
      on[z, x] = q(z)
behavior act(x: T):
  body:
    do change(x)
  eff:
    a[...] = on(x, home)
"""


def test_what_is_read_of_a_narrower_type_is_well_typed_pddl() -> None:
    true = frozenset({("q", ("u1",)), ("q", ("home",)), ("on", ("t1", "home"))})
    check_pddl(Case(NARROWER, ("x",)), true, Level.BASIC)


@pytest.mark.slow
@given(cases(with_body=True), STATES, LEVELS)
@settings(UNSHRUNK, max_examples=400)
def test_the_pddl_is_what_running_does_on_many_programs(
    case: Case, true: Facts, level: Level
) -> None:
    check_pddl(case, true, level)
