"""Aliased arguments, conditional effects and guards, as planners read the emitted PDDL."""

from textwrap import dedent

import pytest
from programs import statement_of, task_of

from cdlc.backends.engines import EngineStatus, installed, solve
from cdlc.backends.pddl import PddlTask
from crow.evaluate import execute
from crow.problem import Problem

needs_planner = pytest.mark.skipif("fast-downward" not in installed(), reason="needs `planners`")

HEAD = """
typedef T
typedef U: T
feature p(x: T)
feature q(x: T)
feature on(x: T, y: T)
feature done(x: T, y: T)
object_constant home: T
"""


def emitted(behavior: str, problem: str = "goal: True") -> PddlTask:
    text = f'problem "p"\nobjects:\n  o: U\n{dedent(problem)}\n'
    return task_of(HEAD + dedent(behavior), text)


def effects(eff: str, parameters: str = "x: T, y: T") -> list[str]:
    behavior = f"behavior act({parameters}):\n  eff:\n" + "".join(
        f"    {line}\n" for line in eff.splitlines()
    )
    lines = emitted(behavior).domain.split(":effect", 1)[1].splitlines()[1:]
    return [line.strip() for line in "\n".join(lines).rstrip().removesuffix(")))").splitlines()]


@pytest.mark.parametrize(
    ("eff", "expected"),
    [
        # deletes before adds: the add wins where they meet
        ("p[x] = False\np[y] = True", ["(not (p ?x))", "(p ?y)"]),
        # adds before deletes need a guard …
        ("p[x] = True\np[y] = False", ["(when (not (= ?x ?y)) (p ?x))", "(not (p ?y))"]),
        # … unless types keep them apart, or both do the same
        ("p[x] = True\np[y] = True", ["(p ?x)", "(p ?y)"]),
        ("p[x] = False\np[y] = False", ["(not (p ?x))", "(not (p ?y))"]),
        ("p[x] = True\nq[y] = False", ["(p ?x)", "(not (q ?y))"]),
        ("p[home] = True\np[x] = False", ["(when (not (= ?x home)) (p home))", "(not (p ?x))"]),
        (
            "on[x, y] = True\non[y, x] = False",
            ["(when (not (= ?x ?y)) (on ?x ?y))", "(not (on ?y ?x))"],
        ),
        # Boolean values
        ("p[x] = q(x)", ["(when (not (q ?x)) (not (p ?x)))", "(when (q ?x) (p ?x))"]),
        ("p[x] = not q(y)", ["(when (q ?y) (not (p ?x)))", "(when (not (q ?y)) (p ?x))"]),
        (
            "p[x] = True\np[y] = q(x)",
            [
                "(when (not (= ?x ?y)) (p ?x))",
                "(when (not (q ?x)) (not (p ?y)))",
                "(when (q ?x) (p ?y))",
            ],
        ),
        (
            "p[x] = q(x)\np[y] = True",
            ["(when (not (q ?x)) (not (p ?x)))", "(when (q ?x) (p ?x))", "(p ?y)"],
        ),
        (
            "p[x] = True\np[y] = False\np[home] = True",
            ["(when (not (= ?x ?y)) (p ?x))", "(not (p ?y))", "(p home)"],
        ),
    ],
)
def test_effects(eff: str, expected: list[str]) -> None:
    assert effects(eff) == expected


def test_types_that_share_no_object_need_no_guard() -> None:
    text = "typedef V\nfeature r(x: object)\nbehavior act(x: T, v: V):\n  eff:\n"
    domain = emitted(text + "    r[x] = True\n    r[v] = False\n").domain
    assert "when" not in domain


# What Fast Downward makes of it. The behavior runs once; the goal says how it has to come out.

CASES = [
    # (effect, initial facts, goal, solvable)
    ("p[x] = False\np[y] = True", "", "p(o) and done(o, o)", True),
    ("p[x] = True\np[y] = False", "", "p(o) and done(o, o)", False),
    ("p[x] = True\np[y] = False", "", "not p(o) and done(o, o)", True),
    ("p[x] = True\np[y] = False", "", "p(home) and done(home, o)", True),
    ("p[x] = q(x)\np[y] = True", "", "p(o) and done(o, o)", True),
    ("p[x] = True\np[y] = q(x)", "", "p(o) and done(o, o)", False),
    ("p[x] = True\np[y] = q(x)", "q[o] = True", "p(o) and done(o, o)", True),
    ("p[x] = not p(x)", "p[o] = True", "not p(o) and done(o, o)", True),
    ("p[x] = not p(x)\nq[x] = p(x)", "", "q(o) and done(o, o)", True),
    ("q[x] = p(x)\np[x] = not p(x)", "", "q(o) and done(o, o)", False),
    ("on[x, y] = True\non[y, x] = False", "", "on(o, o) and done(o, o)", False),
    ("on[x, y] = True\non[y, x] = False", "", "on(o, home) and done(o, home)", True),
    ("p[x] = forall z: T: q(z)", "q[o] = True; q[home] = True", "p(o) and done(o, o)", True),
    ("p[x] = forall z: T: q(z)", "q[o] = True", "p(o) and done(o, o)", False),
    ("p[x] = exists z: T: q(z) and z != x", "q[o] = True", "p(o) and done(o, o)", False),
    ("p[x] = True\nq[x] = p(y)\np[y] = False", "", "q(o) and not p(o) and done(o, o)", True),
]


# A run takes seconds: by default an add over a delete, a guard, and a choice either way.
BY_DEFAULT = (0, 1, 6, 5)


@needs_planner
@pytest.mark.parametrize(
    ("eff", "init", "goal", "is_solvable"),
    [
        pytest.param(*case, marks=[] if index in BY_DEFAULT else [pytest.mark.slow])
        for index, case in enumerate(CASES)
    ],
)
def test_fast_downward_reads_effects_as_the_interpreter_runs_them(
    eff: str, init: str, goal: str, is_solvable: bool
) -> None:
    task = task_of_case(eff, init, goal)
    assert task.problem is not None
    solved = solve(task.domain, task.problem, time_limit=60)
    expected = EngineStatus.PLAN if is_solvable else EngineStatus.UNSOLVABLE
    assert solved.status is expected, solved.log


def task_of_case(eff: str, init: str, goal: str) -> PddlTask:
    """A task whose one behavior runs once; the goal says how it has to come out."""
    body = "".join(f"    {line}\n" for line in (*eff.splitlines(), "done[x, y] = True"))
    rule = "behavior act(x: T, y: T):\n  body: assert not (exists a, b: T: done(a, b))\n  eff:\n"
    return emitted(rule + body, f"init: {init or 'pass'}\ngoal: {goal}")


@pytest.mark.parametrize(("eff", "init", "goal", "is_solvable"), CASES)
def test_kairos_reads_effects_as_the_interpreter_runs_them(
    eff: str, init: str, goal: str, is_solvable: bool
) -> None:
    kairos = pytest.importorskip("kairos")
    task = task_of_case(eff, init, goal)
    domain = kairos.parse_domain(task.domain, "domain.pddl")
    options = kairos.SearchOptions()
    options.anytime = False
    result = kairos.Planner().solve(kairos.parse_problem(task.problem, domain, "p.pddl"), options)
    assert result.status == (kairos.Status.SOLVED if is_solvable else kairos.Status.UNSOLVABLE)
    if is_solvable:
        text = "".join(f"({' '.join((s.name, *s.args))})\n" for s in result.plan.steps)
        report = kairos.validate_plan(task.domain, task.problem, kairos.parse_plan(text))
        assert report.status == kairos.ValidationStatus.VALID


@pytest.mark.parametrize(("eff", "init", "goal", "is_solvable"), CASES)
def test_the_interpreter_agrees(eff: str, init: str, goal: str, is_solvable: bool) -> None:
    from crow.evaluate import holds

    body = "".join(f"    {line}\n" for line in (*eff.splitlines(), "done[x, y] = True"))
    text = f'problem "p"\nobjects:\n  o: U\ninit: {init or "pass"}\ngoal: {goal}\n'
    program, statement = statement_of(HEAD + "behavior act(x: T, y: T):\n  eff:\n" + body, text)
    problem = Problem.of(program, statement)
    effect = program.behaviors[0].effect
    assert effect is not None
    reached = [
        holds(
            problem.world,
            execute(problem.world, problem.initial, effect, {"x": x, "y": y}),
            problem.goal,
            {},
        )
        for x in problem.world.objects
        for y in problem.world.objects
    ]
    assert any(reached) is is_solvable
