"""What the program's plan space leaves out of a plan that a planner found."""

from collections.abc import Iterator

from cdlc.crosscheck.results import Excluded
from cdlc.ir.matching import may_match
from crow.conditions import Wanted
from crow.matching import Matching
from crow.plan import Step
from crow.problem import Problem, World
from crow.program import Achieve, And, Behavior, Call, Compare, Expression, Or, Quantified
from crow.program.walk import statements_within
from crow.text import expression_text


def excluded(problem: Problem, steps: tuple[Step, ...]) -> tuple[Excluded, ...]:
    """The steps of a plan; those whose behaviors nothing on the way to the goal asks for say so."""
    reached = wanted_behaviors(problem)
    return tuple(Excluded(step, _remark(problem.world, step, reached)) for step in steps)


def _remark(world: World, step: Step, reached: frozenset[str]) -> str:
    if not reached.isdisjoint((step.behavior, *step.also)):
        return ""
    goals = [world.behaviors[name].goal for name in (step.behavior, *step.also)]
    texts = [f"`{expression_text(goal)}`" for goal in goals if goal is not None]
    if not texts:
        return f"nothing on the way to the goal calls `{step.behavior}`"
    return f"nothing on the way to the goal asks for {' or '.join(dict.fromkeys(texts))}"


def wanted_behaviors(problem: Problem) -> frozenset[str]:
    """The behaviors that the goal leads to by achieves and calls, whatever the state is."""
    world = problem.world
    reach = _Reach(world)
    pending = [b.name for b in reach.achieving(problem.goal)]
    reached: set[str] = set()
    while pending:
        name = pending.pop()
        if name not in reached:
            reached.add(name)
            pending += reach.next(world.behaviors[name])
    return frozenset(reached)


class _Reach:
    def __init__(self, world: World) -> None:
        self.world = world
        self.conditions = Wanted(world)
        self.matching = Matching(world)

    def next(self, behavior: Behavior) -> Iterator[str]:
        """The behaviors that the body of one may lead to."""
        for statement in statements_within(behavior.body):
            match statement:
                case Achieve(condition=condition):
                    yield from (b.name for b in self.achieving(condition))
                case Call(behavior=name):
                    yield name
                case _:
                    pass

    def achieving(self, condition: Expression) -> Iterator[Behavior]:
        """The behaviors that may achieve a part of a condition."""
        for part in _parts(self.conditions.normal(condition)):
            found = [
                behavior
                for behavior, goal in self.matching.goals
                if may_match(goal, part, self.world.hierarchy)
            ]
            if not found and isinstance(part, Compare):
                found = list(self.matching.writers(part))
            yield from found


def _parts(condition: Expression) -> Iterator[Expression]:
    match condition:
        case And(operands=operands) | Or(operands=operands):
            for operand in operands:
                yield from _parts(operand)
        case Quantified(body=body):
            yield from _parts(body)
        case _:
            yield condition
