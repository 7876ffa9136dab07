"""Which behaviors may come to stand in one M, and whether the L of any of them may act.

Names are compared, not arguments: the answer is on the safe side.
"""

from collections.abc import Iterable, Iterator

from crow.conditions import Wanted, plain
from crow.matching import Matching
from crow.problem import World
from crow.program import (
    Achieve,
    Apply,
    Behavior,
    Call,
    Compare,
    Do,
    Expression,
    Not,
    Read,
    Statement,
)
from crow.program.walk import statements_within, subexpressions


class Reach:
    """What may be refined to what within promotable sections of one world."""

    def __init__(self, world: World, conditions: Wanted, matching: Matching) -> None:
        self.world = world
        self.conditions = conditions
        self.matching = matching
        self.acting = {
            b.name
            for b in world.program.behaviors
            if any(isinstance(s, Achieve | Call | Do) for s in statements_within(b.left))
        }

    def acts(self, behavior: Behavior) -> bool:
        """Whether an L that joins the M of a behavior may act; its own stands before that."""
        if not self.acting or behavior.promotable is None:
            return False
        return self._acts(self._next(behavior.promotable.members))

    def wanting(self, condition: Expression) -> bool:
        """Whether an L that joins an M with a condition in normal form may act."""
        return bool(self.acting) and self._acts(self._achieving(condition))

    def _acts(self, behaviors: Iterable[str]) -> bool:
        pending, seen = list(behaviors), set[str]()
        while pending:
            name = pending.pop()
            if name in self.acting:
                return True
            if name not in seen:
                seen.add(name)
                promotable = self.world.behaviors[name].promotable
                if promotable is not None:
                    pending.extend(self._next(promotable.members))
        return False

    def _next(self, members: tuple[Statement, ...]) -> Iterator[str]:
        for statement in statements_within(members):
            match statement:
                case Achieve(condition=condition):
                    yield from self._achieving(self.conditions.normal(condition))
                case Call(behavior=name):
                    yield name
                case _:
                    pass

    def _achieving(self, condition: Expression) -> Iterator[str]:
        """Behaviors whose goal has a name that a condition has; for comparisons, also writers."""
        parts = list(subexpressions(condition))
        names = {_name(part) for part in parts if isinstance(part, Read | Apply)}
        for behavior, goal in self.matching.goals:
            if _goal_names(goal) & names:
                yield behavior.name
        for part in parts:
            if isinstance(part, Compare):
                yield from (b.name for b in self.matching.writers(part))


def _goal_names(goal: Expression) -> set[str]:
    match plain(goal):
        case Not(operand=operand):
            return _goal_names(operand)
        case Compare(left=left, right=right):
            return {_name(side) for side in (left, right) if isinstance(side, Read | Apply)}
        case Read() | Apply() as atom:
            return {_name(atom)}
        case _:
            return set()


def _name(atom: Read | Apply) -> str:
    return atom.feature if isinstance(atom, Read) else atom.function
