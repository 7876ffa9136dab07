"""Whole numbers with bounds as objects, for planners that have no numbers."""

import re
from collections.abc import Callable, Iterator
from itertools import product
from pathlib import Path
from typing import Any

import pytest
from programs import program_of, statement_of

from benchmarks.translator import task_size
from cdlc.backends.engines import installed
from cdlc.backends.pddl import Emission, PddlTask, to_pddl
from cdlc.backends.pddl.actions import Action
from cdlc.backends.pddl.enumerated import number_name
from cdlc.backends.pddl.sexpr import conjuncts
from cdlc.backends.pddl.solve import solve_task
from cdlc.diagnostics import Collector
from cdlc.ir.hoare import Model
from crow.problem import Problem, State, World
from crow.program import BOOL, Constant, Parameter
from crow.program.types import ObjectType
from crow.transition import apply

needs_planner = pytest.mark.skipif("fast-downward" not in installed(), reason="needs `planners`")
GOLDEN = Path(__file__).parent / "golden"


def tried(domain: str, problem: str | None = None) -> tuple[PddlTask | None, Collector, Any]:
    found, stated, program = Collector(), None, None
    if problem is None:
        program = program_of(domain)
    else:
        program, statement = statement_of(domain, problem)
        stated = Problem.of(program, statement)
    model = Model(program)
    task = to_pddl(model, stated, found, Emission(enumerates=True))
    return task, found, stated


def texts() -> tuple[str, str]:
    text = (GOLDEN / "enumerated.txt").read_text()
    domain, problem = re.split(r"^(?=problem )", text, flags=re.MULTILINE)
    return domain, problem


def test_golden(golden: Callable[[Path, str], None]) -> None:
    task, found, _ = tried(*texts())
    assert task is not None, [d.message() for d in found]
    golden(GOLDEN / "enumerated.pddl", f"{task.domain}\n{task.problem}")


@needs_planner
def test_fast_downward_plans_with_numbers() -> None:
    task, _, stated = tried(*texts())
    assert task is not None
    result = solve_task(task, stated, "fast-downward", time_limit=60)
    assert result.status == "plan"
    assert result.cost == 3
    # One variable for each counter, whatever its range.
    assert task.problem is not None
    assert task_size(task.domain, task.problem).facts == 10


WIDE = "feature [[min=0, max=400]] n(x: T) -> int64\nfeature p(x: object)\n"
HEAD = "typedef T\ncontroller go(x: T)\n"


@pytest.mark.parametrize(
    ("domain", "message"),
    [
        ("feature n(x: T) -> int64\n", "`n` without bounds, with `--numeric enumerate`,"),
        ("feature [[min=0]] n(x: T) -> int64\n", "`n` without bounds"),
        ("feature n(x: T) -> float64\n", "`n` without bounds"),
        (
            f"{WIDE}behavior act(x: T, y: T):\n  body: assert n(x) <= n(y)\n  eff: p[x] = True\n",
            "a table of 160,801 numbers",
        ),
        (
            f"{WIDE}behavior act(x: T):\n  eff:\n    foreach o: object: p[o] = n(x) > 2\n",
            "a variable of type `object`",
        ),
    ],
)
def test_what_cannot_be_enumerated_is_refused(domain: str, message: str) -> None:
    problem = 'problem "p"\nobjects:\n  a: T\ngoal: True\n'
    task, found, _ = tried(HEAD + domain, problem)
    assert task is None
    (diagnostic,) = found
    assert diagnostic.message().startswith(message)


# ------------------------------------------------------------------------- against the interpreter

NUMBERS = range(-2, 4)
BOUNDED = """
typedef T
object_constant one: T
feature [[min=-2, max=3]] n(x: T) -> int64
feature [[min=-2, max=3]] m() -> int64
feature p(x: T)
"""
EFFECTS = [
    "n[x] += 1",
    "n[x] = n(y) - 2",
    "n[x] += 1\nn[y] += 1",
    "n[x] = n(y) * m() - 1",
    "if n(x) > m(): n[y] -= 1\nelse: m = n(x)",
    "foreach z: T: n[z] = max(n(z) - 1, m())",
    "p[x] = n(x) - 2 * n(y) <= m()\nn[x] = -n(x)",
    "n[x] = abs(n(y)) if p(y) else 7 - 5",
]


# unified-planning takes seconds for each state: by default a difference, aliasing, and a branch.
BY_DEFAULT = (1, 2, 4)


def states() -> Iterator[dict[tuple[str, tuple[str, ...]], object]]:
    """Some states with numbers near the bounds, in a fixed order."""
    for first, second, third in ((-2, 2, 1), (0, -1, -2), (3, 2, -2), (1, 1, 1)):
        flags = {("p", ("one",)): True} if first < second else {("p", ("two",)): True}
        yield {("n", ("one",)): first, ("n", ("two",)): second, ("m", ()): third, **flags}


@needs_planner
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
@pytest.mark.parametrize(
    "eff",
    [
        pytest.param(eff, marks=[] if index in BY_DEFAULT else [pytest.mark.slow])
        for index, eff in enumerate(EFFECTS)
    ],
)
def test_the_tables_compute_what_the_interpreter_does(eff: str) -> None:
    lines = "".join(f"    {line}\n" for line in eff.splitlines())
    program = program_of(f"{BOUNDED}behavior act(x: T, y: T):\n  eff:\n{lines}")
    world = World.of(program, (Parameter("two", ObjectType("T")),))
    for cells in states():
        state = State({c: v for c, v in cells.items() if v != 0})
        problem = Problem.made("p", world, state, Constant(value=True, type=BOOL))
        model, found = Model(program), Collector()
        task = to_pddl(model, problem, found, Emission(enumerates=True))
        assert task is not None
        simulated = Simulated(task, world)
        for arguments in product(world.objects, repeat=2):
            ran = apply(world, state, world.behaviors["act"], arguments)
            expected = None if ran.problem is not None else ran.state
            assert simulated.after(arguments) == expected, (eff, cells, arguments)


class Simulated:
    """The only action of a task in unified-planning's simulator."""

    def __init__(self, task: PddlTask, world: World) -> None:
        from unified_planning.engines.sequential_simulator import UPSequentialSimulator
        from unified_planning.io import PDDLReader

        self.task, self.world = task, world
        self.problem = PDDLReader().parse_problem_string(task.domain, task.problem)
        self.simulator = UPSequentialSimulator(self.problem)
        self.before = self.simulator.get_initial_state()

    def after(self, arguments: tuple[str, ...]) -> State | None:
        """The state after the action, if it can be applied."""
        (own,) = self.task.actions
        (source,) = own.sources
        given = dict(zip(("x", "y"), arguments, strict=True))
        known = {f"?{c.parameter}": given[c.variable.name] for c in source.variables if c.parameter}
        values = determined(self.task, own, known)
        terms = [self.problem.object(values[f"?{p.name}"]) for p in own.parameters]
        action = self.problem.actions[0]
        if not self.simulator.is_applicable(self.before, action, terms):
            return None
        return _read(self.simulator.apply(self.before, action, terms), self.problem, self.world)


def determined(task: PddlTask, action: Action, values: dict[str, str]) -> dict[str, str]:
    """The parameters of an action: those that a fact of the initial state gives follow."""
    lines = re.findall(r"^    \((.*?)\)+$", task.problem or "", re.MULTILINE)
    facts = [tuple(line.split()) for line in lines]
    atoms = [c for c in conjuncts(action.precondition) if all(isinstance(t, str) for t in c)]
    # Of the predicates, `at-most-2` and the like have no value.
    pending = [a for a in atoms if not a[0].startswith("at-") and a[-1].startswith("?")]
    while True:
        for name, *terms in pending:
            *known, last = terms
            if last not in values and all(t in values or t[0] != "?" for t in known):
                wanted = (name, *(values.get(t, t) for t in known))
                (values[last],) = (f[-1] for f in facts if f[:-1] == wanted)
                break
        else:
            return values


def _read(state: Any, problem: Any, world: World) -> State:
    cells: dict[tuple[str, tuple[str, ...]], object] = {}
    for feature in world.program.features:
        fluent = problem.fluent(feature.name)
        for where in world.cells(feature):
            terms = [problem.object(o) for o in where]
            if feature.name == "p":
                if state.get_value(fluent(*terms)).is_true():
                    cells[feature.name, where] = True
                continue
            (value,) = (
                n
                for n in NUMBERS
                if state.get_value(
                    fluent(*terms, problem.object(number_name(n).rstrip("'")))
                ).is_true()
            )
            cells[feature.name, where] = value
    return State({c: v for c, v in cells.items() if v != 0})
