"""`optimal=True`: the cheapest plan and its proof, by the reference engine and by Fast Downward."""

import json
import random
from collections import Counter
from pathlib import Path

import jsonschema
import pytest
from corpus import CASES
from oracle import OverTheCapError, Recorded, capped
from programs import checked_domain, checked_problem, problem_of, task_of
from small_programs import small_program
from support import EXAMPLES, ROOT, cdlc
from test_native_plans_in_pddl import random_blocks

import crow
from cdlc.backends.pddl.solve import solve_task
from crow.evaluate import evaluate
from crow.planning import Planning
from crow.problem import Problem
from crow.reference import refinements
from crow.replay import replay_to_goal
from crow.search.machine import Machine
from crow.search.optimal import LeastCalls, calls_since, only_grows
from crow.search.points import Choice

SCHEMA = json.loads((ROOT / "cdlc" / "schemas" / "plan.json").read_text())


def cost_of(problem: Problem, steps: tuple[crow.Step, ...], trace: object) -> float:
    if problem.minimize is None:
        return sum(step.controller is not None for step in steps)
    final = replay_to_goal(problem, trace).final  # type: ignore[arg-type]
    return float(evaluate(problem.world, final, problem.minimize, {}))


def all_costs(problem: Problem, depth: int) -> set[float]:
    """What the plans up to a depth cost, by the definition."""
    refinement = Recorded(problem.world, depth)
    refinement.check = capped(lambda: refinement.nodes, 20_000)
    return {cost_of(problem, *found) for found in refinements(problem, refinement)}


def optimal(problem: Problem, engine: str = "auto", **options: int | float) -> crow.Plan:
    result = crow.plan(problem, engine, optimal=True, **options)  # type: ignore[arg-type]
    assert isinstance(result, crow.Plan), result
    document = json.loads(json.dumps(result.json()))
    jsonschema.validate(document, SCHEMA)
    assert document["optimality"]["proved"] == result.is_proved_optimal
    return result


# ----------------------------------------------------------------------------------- by other means


def program_with_choices(seed: int) -> str:
    """Four goals, each with several behaviors that call, achieve and spend differently."""
    rng = random.Random(seed)
    lines = [*(f"feature g{i}()" for i in range(4)), "feature n() -> int64", "controller c()"]
    for number in range(9):
        goal = number % 4
        lines += [f"behavior b{number}():", f"  goal: g{goal}()", "  body:"]
        below = rng.sample(range(goal + 1, 4), rng.randrange(0, 4 - goal))
        word = rng.choice(["promotable:", "sequential:"])
        lines += [f"    {word}"] * bool(below)
        lines += [f"      achieve {rng.choice(['', '', 'not '])}g{other}()" for other in below]
        lines += ["    do c()"] * rng.randrange(0, 3) + ["    pass"]
        lines += ["  eff:", f"    g{goal}[...] = True", f"    n += {rng.randrange(-1, 4)}"]
        if rng.random() < 0.3:
            lines.append(f"    g{rng.randrange(4)}[...] = False")
    return "\n".join(lines) + "\n"


MINIMIZED = ["", "minimize: n()", "minimize: -n() + (1 if g3() else 0)"]


@pytest.mark.parametrize("minimized", MINIMIZED)
def test_it_costs_what_the_cheapest_of_all_plans_costs(minimized: str) -> None:
    told: Counter[str] = Counter()
    for seed in range(20):
        domain = program_with_choices(seed)
        problem = problem_of(domain, f'problem "p"\ngoal: g0() and g1()\n{minimized}\n')
        try:
            costs = all_costs(problem, 3)
        except OverTheCapError:
            continue
        if len(costs) < 2:
            continue
        about = f"seed {seed}\n{domain}{minimized}"
        found = optimal(problem, depth_limit=3, node_limit=20_000)
        assert found.cost == min(costs), about
        free = optimal(problem, node_limit=2_000)
        assert free.cost is not None
        assert free.cost <= min(costs) or not free.is_proved_optimal, about
        told["compared"] += 1
        told["proved"] += free.is_proved_optimal
        told["improved"] += crow.plan(problem).cost != free.cost
    assert told["compared"] >= 6, told
    assert told["proved"] >= 0.5 * told["compared"], told
    assert told["improved"] >= 1, told


def test_random_small_programs_cost_the_least() -> None:
    for seed in range(60_000, 60_050):
        small = small_program(seed)
        problem = problem_of(small.domain, small.problem)
        try:
            costs = all_costs(problem, 2)
        except OverTheCapError:
            continue
        if costs:
            about = f"seed {seed}\n{small.domain}{small.problem}"
            found = optimal(problem, depth_limit=2, node_limit=20_000)
            assert found.cost == min(costs), about
            free = optimal(problem, node_limit=2_000)
            assert free.cost is not None
            assert free.cost <= min(costs) or not free.is_proved_optimal, about
    checked_domain.cache_clear()
    checked_problem.cache_clear()


@pytest.mark.parametrize("name", ["rooms", "gripper", "logistics", "briefcase"])
def test_examples_cost_what_the_reference_finds(name: str) -> None:
    case = CASES[name]
    problem = problem_of(case.domain, case.problem)
    least = min(all_costs(problem, case.depth))
    found = optimal(problem, depth_limit=case.depth, node_limit=30_000)
    assert found.cost == least
    by_definition = optimal(problem, "reference", depth_limit=case.depth)
    assert by_definition.cost == least


@pytest.mark.parametrize("seed", range(1, 5))
def test_it_costs_what_fast_downward_proves(seed: int) -> None:
    """With everything promotable, behaviors are STRIPS operators and the plan spaces coincide."""
    pytest.importorskip("up_fast_downward")
    domain = Path(EXAMPLES / "blocks" / "blocks_strips.cdl").read_text()
    text = random_blocks(seed)
    problem = problem_of(domain, text)
    other = solve_task(task_of(domain, text), problem, "fast-downward-opt", time_limit=60)
    assert other.status == "plan", other
    found = optimal(problem, time_limit=60)
    assert found.is_proved_optimal
    assert found.cost == len(other.steps)


# ---------------------------------------------------------------------------------------- its parts


CHOICE = """
feature r()
feature [[min=0]] spent() -> int64
feature done(k: T)
typedef T
controller go(k: T)
behavior long(k: T):
  goal: r()
  body:
    do go(k)
    do go(k)
  eff:
    r[...] = True
    spent += 1
behavior short(k: T):
  goal: r()
  body:
    do go(k)
  eff:
    r[...] = True
    spent += 5
"""


def choice(minimized: str = "") -> Problem:
    return problem_of(CHOICE, f'problem "p"\nobjects:\n  a: T\ngoal: r()\n{minimized}\n')


def test_it_is_the_number_of_calls_unless_the_problem_says_otherwise() -> None:
    assert [s.behavior for s in optimal(choice()).steps] == ["short"]
    assert [s.behavior for s in optimal(choice("minimize: spent()")).steps] == ["long", "long"]
    assert optimal(choice("minimize: spent()")).cost == 1
    assert optimal(choice("minimize: 0 - spent()")).cost == -5


@pytest.mark.parametrize(
    ("minimized", "grows"), [("spent()", True), ("0 - spent()", False), ("spent() + 1", False)]
)
def test_only_what_is_never_made_less_bounds_a_cost(minimized: str, grows: bool) -> None:
    assert only_grows(choice(f"minimize: {minimized}")) == grows


def test_what_may_be_taken_away_bounds_nothing() -> None:
    text = CHOICE.replace("spent += 5", "spent -= 1")
    problem = problem_of(text, 'problem "p"\nobjects:\n  a: T\ngoal: r()\nminimize: spent()\n')
    assert not only_grows(problem)


def descend(problem: Problem, rng: random.Random) -> int:
    """Go down at random; at its end, compare what was counted at each point on the way."""
    machine = Machine(problem, counts_depth=False)
    machine.protects = False
    machine.depth_limit = 1
    least, point = LeastCalls(machine), machine.start()
    passed = []
    for _ in range(40):
        passed.append((point.trail, least.of(point.frame)))
        step = machine.run(point)
        if isinstance(step, Choice):
            passed.append((step.point.trail, least.of(step.point.frame)))
            options = list(step.options)
            if not options:
                return 0
            point = rng.choice(options)
        elif step is None:
            return 0
        else:
            assert all(count <= calls_since(step.trail, trail) for trail, count in passed)
            return sum(count > 0 for _, count in passed)
    return 0


def test_calls_that_are_sure_to_come_do_come() -> None:
    """What is counted at a point is never more than what comes on a way to a plan."""
    rng = random.Random(3)
    problems = [problem_of(case.domain, case.problem) for case in CASES.values()]
    for seed in range(70_000, 70_100):
        small = small_program(seed)
        problems.append(problem_of(small.domain, small.problem))
    assert sum(descend(problem, rng) for problem in problems for _ in range(12)) > 150


# ------------------------------------------------------------------------------------------- limits


def test_a_limit_leaves_it_unproved() -> None:
    problem = problem_of(
        Path(EXAMPLES / "blocks" / "blocks_strips.cdl").read_text(), random_blocks(1)
    )
    nodes = Planning(problem).first().statistics["nodes"]
    found = optimal(problem, node_limit=nodes + 50)
    assert (found.is_proved_optimal, found.unproved) == (False, ("nodes",))
    assert "not proved to be the least: the node limit was reached" in found.summary()
    assert optimal(problem, time_limit=0.0001 + found.statistics["seconds"]).cost is not None


def test_without_a_plan_the_answer_is_as_ever() -> None:
    problem = problem_of(CHOICE, 'problem "p"\nobjects:\n  a: T\ngoal: done(a)\n')
    assert isinstance(crow.plan(problem, optimal=True), crow.Unsolvable)


def test_a_commit_may_hide_what_is_cheaper() -> None:
    text = CHOICE.replace("    do go(k)\n  eff:", "    do go(k)\n    commit\n  eff:")
    problem = problem_of(text, 'problem "p"\nobjects:\n  a: T\ngoal: r()\n')
    assert optimal(problem).cost == 1


def test_the_command_says_whether_it_is_proved() -> None:
    files = [EXAMPLES / "blocks" / "sussman.cdl"]
    ran = cdlc("plan", *files, "--optimal", "--time-limit", "30")
    assert ran.status == 0
    assert "cost 6, and no plan costs less" in ran.err
    ran = cdlc("plan", *files, "--optimal", "--format", "json", "--time-limit", "30")
    document = json.loads(ran.out)
    jsonschema.validate(document, SCHEMA)
    assert document["optimality"] == {"proved": True, "limits": []}
    refused = cdlc("plan", *files, "--optimal", "--engine", "fast-downward")
    assert refused.status == 2
    assert "--optimal" in refused.err
