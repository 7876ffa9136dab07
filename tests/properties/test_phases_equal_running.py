"""Behaviors of several ways and phases: walks through their PDDL, in unified-planning's simulator,
against the parts that these steps stand for, carried out by the interpreter.
"""

from itertools import product
from typing import Any

import pytest
from hypothesis import HealthCheck, Phase, event, given, settings
from hypothesis import strategies as st
from programs import program_of

from cdlc.backends.pddl import PddlTask, to_pddl, to_step
from cdlc.backends.pddl.course import Course
from cdlc.diagnostics import Collector
from cdlc.ir.hoare import Model
from crow.problem import Problem, State, World
from crow.program import BOOL, Constant, Parameter
from crow.program.types import ObjectType

# unified-planning's reader calls its parser by old names.
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")

TRUE = Constant(value=True, type=BOOL)
SETTINGS = settings(
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
    phases=[Phase.explicit, Phase.reuse, Phase.generate],
)
HEAD = """
typedef T
feature p(x: T)
feature q(x: T)
feature r()
feature n() -> int64
feature place() -> T
controller flip(x: T):
  eff: p[x] = not p(x)
controller count(x: T):
  eff:
    n[] += 1
    q[x] = True
controller show(x: T)
behavior make_p(x: T):
  goal: p(x)
  eff:
    p[x] = True
    place[] = x
behavior unmake(x: T):
  goal: not q(x)
  body:
    assert p(x)
    do show(x)
  eff:
    q[x] = False
behavior called(x: T):
  body:
    let old = place()
    assert p(x) or q(x)
    do flip(x)
    achieve p(old)
  eff:
    place[] = old
"""

TERMS = st.sampled_from(["x", "y", "z", "k"])
SIMPLE = st.one_of(
    st.builds("assert p({})".format, TERMS),
    st.builds("assert not q({})".format, TERMS),
    st.builds("achieve p({})".format, TERMS),
    st.builds("achieve not q({})".format, TERMS),
    st.builds("achieve_once p({})".format, TERMS),
    st.builds("do flip({})".format, TERMS),
    st.builds("do count({})".format, TERMS),
    st.builds("do show({})".format, TERMS),
    st.builds("if p({}): assert q({})".format, TERMS, TERMS),
    st.builds("if q({}): achieve p({})".format, TERMS, TERMS),
    st.builds("assert m <= n() + {}".format, st.integers(0, 1)),
    st.just("assert b or r()"),
    st.builds("called({})".format, TERMS),
)


def block(order: str, parts: list[str]) -> str:
    return f"{order}:\n" + "".join("  " + part.replace("\n", "\n  ") + "\n" for part in parts)


def blocks(inner: Any) -> Any:
    orders = st.sampled_from(["sequential", "alternative", "unordered"])
    return st.builds(block, orders, st.lists(inner, min_size=1, max_size=3))


STATEMENTS = st.recursive(SIMPLE, blocks, max_leaves=4)
EFFECTS = st.sampled_from(
    [
        "r[] = True",
        "r[] = b",
        "place[] = k",
        "place[] = z",
        "n[] = m",
        "q[y] = p(x)",
        "p[z] = False",
    ]
)


@st.composite
def programs(draw: st.DrawFn) -> str:
    """A program with a behavior `act`: locals and a bind somewhere, then what uses them."""
    before = draw(
        st.lists(st.sampled_from(["do flip(x)", "achieve p(y)", "assert p(y)"]), max_size=2)
    )
    declared = ["bind z: T where: p(z)", "let k = place()", "let m = n()", "let b = p(x)"]
    first = draw(st.permutations(declared))
    body = draw(st.lists(STATEMENTS, min_size=1, max_size=4))
    effect = draw(st.lists(EFFECTS, min_size=1, max_size=2, unique=True))
    lines = "\n".join([*before, *first, *body]).replace("\n", "\n    ")
    last = "\n    ".join(effect)
    return (
        f"{HEAD}behavior act(x: T, y: T):\n  goal: r()\n  body:\n    {lines}\n  eff:\n    {last}\n"
    )


class Walked:
    """A task in the simulator, and its steps as parts of behaviors."""

    def __init__(self, world: World, task: PddlTask, initial: State) -> None:
        from unified_planning.engines.sequential_simulator import UPSequentialSimulator
        from unified_planning.io import PDDLReader

        self.world, self.task = world, task
        self.pddl = PDDLReader().parse_problem_string(task.domain, task.problem)
        self.simulator = UPSequentialSimulator(self.pddl)
        self.state = self.simulator.get_initial_state()
        self.course = Course(world, initial)

    def steps(self) -> list[tuple[Any, Course]]:
        """What can be done, in both; they have to agree on what that is, and on where it leads."""
        found = []
        for action in self.task.actions:
            types = [p.type for p in action.parameters]
            for names in product(*(self.world.objects_of(t) for t in types)):
                after = self._simulated(action.name, names)
                planned = to_step(self.task, self.world, action.name, names, 1)
                done, course = self.course.after(planned)
                # A parameter that holds an old value may be another one in the simulator only.
                if after is None and done.problem is None:
                    assert self._holds_old_values(action, names), (action.name, names)
                    continue
                assert (after is None) == (done.problem is not None), (
                    action.name, names, done.problem, self.task.domain,
                )  # fmt: skip
                if after is not None:
                    assert self._cells(after) == self._own_cells(course.state), (action.name, names)
                    found.append((after, course))
        return found

    def _holds_old_values(self, action: Any, names: tuple[str, ...]) -> bool:
        used = {c.parameter for c in action.sources[0].variables}
        others = [p for p in action.parameters if p.name not in used]
        return bool(others)

    def _simulated(self, name: str, arguments: tuple[str, ...]) -> Any:
        from unified_planning.exceptions import UPInvalidActionError

        try:
            action = self.pddl.action(name.lower())
            return self.simulator.apply(
                self.state, action, [self.pddl.object(a) for a in arguments]
            )
        except UPInvalidActionError:  # its precondition is false whatever the state
            return None

    def _cells(self, state: Any) -> dict[str, object]:
        fluent, objects = self.pddl.fluent, [self.pddl.object(o) for o in self.world.objects]
        found: dict[str, object] = {"n": state.get_value(fluent("n")()).constant_value()}
        found["r"] = state.get_value(fluent("r")()).is_true()
        for name in ("p", "q", "place"):
            for o in objects:
                found[f"{name} {o}"] = state.get_value(fluent(name)(o)).is_true()
        return found

    def _own_cells(self, state: State) -> dict[str, object]:
        found: dict[str, object] = {"n": state.cells.get(("n", ()), 0)}
        found["r"] = state.cells.get(("r", ()), False)
        for o in self.world.objects:
            found[f"place {o}"] = state.cells["place", ()] == o
            for name in ("p", "q"):
                found[f"{name} {o}"] = state.cells.get((name, (o,)), False)
        return found


def check(text: str, facts: list[bool], choices: list[int]) -> None:
    world = World.of(
        program_of(text), (Parameter("a", ObjectType("T")), Parameter("b", ObjectType("T")))
    )
    cells: dict[Any, object] = {("place", ()): "a" if facts[4] else "b"}
    places = [(f, (o,)) for f in "pq" for o in "ab"]
    cells |= {cell: True for cell, fact in zip(places, facts, strict=False) if fact}
    found = Collector()
    problem = Problem.made("random", world, State(cells), TRUE)
    task = to_pddl(Model(world.program), problem, found)
    if task is None:
        (refused,) = (d for d in found if d.code != "split-behavior")
        event(f"refused: {refused.message()}")
        return
    parts = {source.part for action in task.actions for source in action.sources}
    event(
        f"{max((p.name.count(chr(39)) for p in parts if p.whole.name == 'act'), default=0)} split"
    )
    walked = Walked(world, task, State(cells))
    for choice in choices:
        steps = walked.steps()
        if not steps:
            return
        walked.state, walked.course = steps[choice % len(steps)]


FACTS = st.lists(st.booleans(), min_size=5, max_size=5)
CHOICES = st.lists(st.integers(0, 50), min_size=1, max_size=6)


@given(programs(), FACTS, CHOICES)
@settings(SETTINGS, max_examples=8)
def test_walks_through_phases(text: str, facts: list[bool], choices: list[int]) -> None:
    check(text, facts, choices)


@pytest.mark.slow
@given(programs(), FACTS, CHOICES)
@settings(SETTINGS, max_examples=500)
def test_many_walks_through_phases(text: str, facts: list[bool], choices: list[int]) -> None:
    check(text, facts, choices)
