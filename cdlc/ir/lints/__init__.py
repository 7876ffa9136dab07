"""Warnings that need the meaning of a program, not only its types; a function a lint.

A lint that cries wolf on idiomatic programs is worse than none: each says in its docstring where it
keeps quiet.
"""

from collections.abc import Callable

from cdlc.diagnostics import Collector
from cdlc.ir.lints.conditions import constant_conditions
from cdlc.ir.lints.controllers import unmodelled_controllers
from cdlc.ir.lints.generators import missing_generators, unmatched_generators
from cdlc.ir.lints.goals import goals_not_established
from cdlc.ir.lints.reach import unmatched_achieves, unreachable_behaviors
from cdlc.ir.lints.subject import Subject
from cdlc.ir.lints.unused import unused_definitions, unused_parameters, unused_variables
from crow.program import ProblemStatement, Program

LINTS: tuple[Callable[[Subject, Collector], None], ...] = (
    goals_not_established,
    unmatched_achieves,
    unreachable_behaviors,
    unmodelled_controllers,
    unmatched_generators,
    missing_generators,
    constant_conditions,
    unused_parameters,
    unused_variables,
    unused_definitions,
)


def lint(
    program: Program,
    found: Collector,
    problem: ProblemStatement | None = None,
    included: frozenset[str] = frozenset(),
) -> None:
    """Report what is suspicious in a checked program; `included` files are libraries."""
    subject = Subject(program, problem, included)
    for check in LINTS:
        check(subject, found)
