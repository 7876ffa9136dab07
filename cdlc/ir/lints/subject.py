"""What lints look at."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from cdlc.ir.behaviors import body_of, parts_of
from crow.program import Expression, Hierarchy, ProblemStatement, Program
from crow.program.walk import subexpressions


@dataclass(frozen=True)
class Subject:
    """A program, the problem it is checked with, and the files that were included."""

    program: Program
    problem: ProblemStatement | None = None
    included: frozenset[str] = frozenset()

    @property
    def is_fragment(self) -> bool:
        """Whether there is too little to judge what is missing: at most one behavior.

        Most listings of the paper are like that, and every program while it is being begun.
        """
        return len(self.program.behaviors) < 2

    @cached_property
    def hierarchy(self) -> Hierarchy:
        """The object types as a tree."""
        return Hierarchy.of(self.program.types)

    def expressions(self) -> Iterator[Expression]:
        """Every expression, however deep, but those of generators and of the initial state."""
        program, problem = self.program, self.problem
        for function in program.functions:
            yield from parts_of(function.body or ())
        for controller in program.controllers:
            yield from parts_of(controller.effect or ())
        for behavior in program.behaviors:
            if behavior.goal is not None:
                yield from subexpressions(behavior.goal)
            yield from parts_of((*body_of(behavior), *(behavior.effect or ())))
        if problem is not None:
            yield from subexpressions(problem.goal)
            if problem.minimize is not None:
                yield from subexpressions(problem.minimize)
