"""A small domain with every kind of step, and a plan for it in each of the three forms."""

import json
from functools import cached_property
from typing import Any

from programs import checked_problem, task_of

from cdlc.backends.pddl import PddlTask
from cdlc.backends.pddl.parts import Part
from cdlc.backends.pddl.plans import PlannedTransition
from cdlc.backends.pddl.solve import run
from cdlc.diagnostics import Collector, Diagnostic
from cdlc.frontend.check import CheckedProblem
from cdlc.plans.validate import Validation, validate
from cdlc.source import SourceFile
from crow.plan import Result, plan_text
from crow.problem import Problem

DOMAIN = """
typedef T
typedef U: T
feature p(x: T)
feature q(x: T)
feature on(x: T, y: T)
controller go(x: T)
controller put(x: T, y: T)
controller mark(x: T):
  eff: p[x] = True

behavior first(x: T):
  goal: q(x)
  body:
    bind y: T where: on(x, y)
    do put(x, y)
    do mark(y)
  eff:
    on[x, y] = False
    q[x] = True

behavior silent(u: U):
  body:
    assert not p(u)
  eff:
    p[u] = True
"""
PROBLEM = """
problem "small"
objects:
  a, b: T
  u: U
init:
  on[a, b] = True
  on[b, a] = True
  on[b, u] = True
goal: q(a) and q(b) and p(u)
"""
PDDL_PLAN = "(silent u-2)\n(first a b) ; a comment\n0.3: (first b u-2) [1]\n"


def whole(problem: Problem, name: str) -> Part:
    behavior = problem.world.behaviors[name]
    return Part(behavior, behavior, behavior)


class Small:
    """The problem compiled, as `validate` wants it."""

    @cached_property
    def checked(self) -> CheckedProblem:
        return checked_problem(DOMAIN, PROBLEM)

    @cached_property
    def problem(self) -> Problem:
        return Problem.of(self.checked.domain.program, self.checked.problem)

    @cached_property
    def pddl(self) -> PddlTask:
        return task_of(DOMAIN, PROBLEM)

    @cached_property
    def result(self) -> Result:
        first, silent = (whole(self.problem, name) for name in ("first", "silent"))
        planned = [
            PlannedTransition(silent, ("u",), {}),
            PlannedTransition(first, ("a",), {"y": "b"}),
            PlannedTransition(first, ("b",), {"y": "u"}),
        ]
        steps, trace = run(self.problem, planned)
        return Result("plan", "by-hand", steps, trace, float(len(steps)))

    @cached_property
    def text(self) -> str:
        return plan_text(self.result.steps)

    @property
    def json(self) -> dict[str, Any]:
        """A new copy each time."""
        document: dict[str, Any] = json.loads(json.dumps(self.result.json()))
        return document


SMALL = Small()


def validated(plan: str) -> tuple[Validation, list[Diagnostic]]:
    found = Collector()
    return validate(SMALL, SourceFile("plan", plan), found), list(found)


def problem_in(plan: str) -> Diagnostic:
    """The one thing that is wrong with a plan."""
    _, found = validated(plan)
    assert len(found) == 1, [d.message() for d in found]
    return found[0]
