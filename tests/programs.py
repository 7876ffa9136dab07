"""CDL texts to programs and problems, as the driver makes them but without files."""

from dataclasses import replace
from functools import cache
from textwrap import dedent

from cdlc.backends.pddl import PddlTask, to_pddl
from cdlc.diagnostics import Collector
from cdlc.frontend import syntax
from cdlc.frontend.check import (
    CheckedDomain,
    CheckedProblem,
    check_domain,
    check_problem,
)
from cdlc.frontend.check_expressions import check_condition, check_expression
from cdlc.frontend.parser import parse
from cdlc.frontend.scope import Context, Scope
from cdlc.ir.hoare import Model
from cdlc.source import SourceFile
from crow.problem import Problem, State, World
from crow.program import Behavior, Expression, ProblemStatement, Program
from crow.registration import registered, with_effects


@cache
def checked_domain(text: str) -> CheckedDomain:
    """A domain without mistakes."""
    found = Collector()
    source = SourceFile("domain.cdl", dedent(text))
    definitions = parse(source, found).definitions
    checked = check_domain("domain", [(source, d) for d in definitions], found)
    assert not found.has_errors, [d.message() for d in found]
    return checked


def program_of(text: str) -> Program:
    """The program of a domain without mistakes."""
    return checked_domain(text).program


def behavior_of(text: str, name: str = "act") -> tuple[Program, Behavior]:
    """The program of a domain, and its behavior of that name."""
    program = program_of(text)
    return program, next(b for b in program.behaviors if b.name == name)


@cache
def checked_problem(domain: str, problem: str) -> CheckedProblem:
    """A domain and a problem for it, without mistakes."""
    found = Collector()
    domain_source = SourceFile("domain.cdl", dedent(domain))
    definitions = [(domain_source, d) for d in parse(domain_source, found).definitions]
    source = SourceFile("problem.cdl", dedent(problem))
    file = [(source, d) for d in parse(source, found).definitions]
    checked = check_problem(file, "domain", definitions, found)
    assert not found.has_errors, [d.message() for d in found]
    assert checked is not None
    return checked


def statement_of(domain: str, problem: str) -> tuple[Program, ProblemStatement]:
    """The program and the problem statement of two texts."""
    checked = checked_problem(domain, problem)
    return checked.domain.program, checked.problem


def problem_of(domain: str, problem: str) -> Problem:
    """The runtime's problem of two texts."""
    return Problem.of(*statement_of(domain, problem))


def with_python(problem: Problem, python: object) -> Problem:
    """A problem whose program has functions in Python."""
    program = problem.world.program
    given = registered(program, python)
    world = replace(problem.world, program=with_effects(program, given), registered=given)
    return problem.changed(world=world)


def _objects(lines: str) -> str:
    """The section of `a, b: T; c: U`."""
    return "objects:\n" + "".join(f"  {o.strip()}\n" for o in lines.split(";")) if lines else ""


def start(domain: str, objects: str, init: str = "pass") -> tuple[World, State]:
    """The world and initial state of a domain with `a, b: T` and the statements of `init`."""
    lines = "\n".join(f"  {line}" for line in dedent(init).strip().splitlines())
    problem = problem_of(domain, f'problem "p"\n{_objects(objects)}init:\n{lines}\ngoal: True\n')
    return problem.world, problem.initial


def expression_of(domain: str, text: str, objects: str = "", *, value: bool = False) -> Expression:
    """The typed form of an expression over a domain with the objects `a, b: T`."""
    found = Collector()
    problem = f'problem "p"\n{_objects(objects)}goal: True\n'
    checked = checked_problem(domain, problem)
    source = SourceFile("expression.cdl", f"minimize: {text}\n" if value else f"goal: {text}\n")
    (part,) = parse(source, found).definitions
    context = Context(source, checked.domain.declarations, found)
    match part:
        case syntax.Goal(condition=condition):
            expression = check_condition(condition, Scope(), context)
        case syntax.Minimize(expression=written):
            expression = check_expression(written, Scope(), context)
        case _:
            raise AssertionError(text)
    assert not found.has_errors, [d.message() for d in found]
    return expression


def emitted(
    domain: str, problem: str | None = None
) -> tuple[PddlTask | None, Collector, Problem | None]:
    """The PDDL of a domain and, if given, of a problem, with what was reported."""
    found = Collector()
    stated = None
    if problem is None:
        program = program_of(domain)
    else:
        program, statement = statement_of(domain, problem)
        stated = Problem.of(program, statement)
    model = Model(program)
    return to_pddl(model, stated, found), found, stated


def task_of(domain: str, problem: str | None = None) -> PddlTask:
    """The PDDL of a domain and, if given, of a problem, both fit for it."""
    task, found, _ = emitted(domain, problem)
    assert task is not None, [d.message() for d in found]
    return task
