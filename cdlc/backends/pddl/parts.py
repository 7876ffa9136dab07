"""The transitions of a program: its behaviors, or parts of them that are steps of their own.

A behavior with an effect is one transition, or one for each way through its body and each phase of
it; a method is one for each `do` (lowering.md §1 and 2).
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from cdlc.backends.pddl.methods import method_steps
from cdlc.backends.pddl.phases import Open, called_effects, phases
from crow.problem import Problem
from crow.program import And, Behavior, Expression, Feature, Not, Program, Quantified


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """A transition of `whole`: `behavior` for its triple, `applied` to carry it out.

    `needs` and `gives` are the phases of the whole that it ends and opens.
    """

    whole: Behavior
    behavior: Behavior
    applied: Behavior
    needs: Open | None = None
    gives: Open | None = None

    @property
    def name(self) -> str:
        """The name of its triple; the whole's own where it is the only part."""
        return self.behavior.name


def parts_of(program: Program, behavior: Behavior) -> tuple[Part, ...]:
    """The parts of a behavior, in source order. Raises NotPddl."""
    if behavior.effect is None:
        return tuple(Part(behavior, step, step) for step in method_steps(program, behavior))
    return tuple(
        Part(behavior, phase.kept, phase.applied, phase.needs, phase.gives)
        for phase in phases(program, behavior)
    )


def with_parts(program: Program, parts: Iterable[Part]) -> Program:
    """The program with what its parts read, write and call; itself where that is nothing new."""
    features = tuple(f for part in parts for f in opened_features(part))
    if not any(part.behavior is not part.whole for part in parts):
        return program
    return replace(
        program,
        features=(*program.features, *features),
        behaviors=(*program.behaviors, *called_effects(program)),
    )


def opened_features(part: Part) -> tuple[Feature, ...]:
    """What says that the phase after a part is to come."""
    return () if part.gives is None else part.gives.features


def closing(problem: Problem, program: Program, parts: Sequence[Part]) -> Problem:
    """The problem in a program with parts; in the end, no phase may be open."""
    if program is problem.world.program:
        return problem
    world = replace(problem.world, program=program)
    closed = [_is_closed(part.gives) for part in parts if part.gives is not None]
    goal = And((problem.goal, *closed)) if closed else problem.goal
    return problem.changed(world=world, goal=goal)


def _is_closed(open_: Open) -> Expression:
    is_closed = Not(open_.read(open_.feature))
    return Quantified("forall", open_.variables, is_closed) if open_.variables else is_closed
