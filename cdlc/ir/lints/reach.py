"""Goals and behaviors that never meet."""

from collections.abc import Iterator

from cdlc.diagnostics import Collector
from cdlc.ir.behaviors import body_of, statements_of
from cdlc.ir.errors import UnmatchedAchieve, UnreachableBehavior
from cdlc.ir.hoare import Model
from cdlc.ir.lints.subject import Subject
from cdlc.ir.matching import may_match
from cdlc.ir.nodes import Level
from cdlc.ir.updates import NotModelled
from crow.program import (
    Achieve,
    And,
    Apply,
    Assign,
    Call,
    Compare,
    Expression,
    Location,
    Not,
    Or,
    Quantified,
    Read,
)
from crow.program.walk import statements_within, subexpressions
from crow.text import expression_text


def unmatched_achieves(subject: Subject, found: Collector) -> None:
    """Report what is to be achieved and no behavior has as its goal.

    Quiet in a fragment, about one disjunct of several, about comparisons over features that some
    effect writes (semantics.md §2 allows any behavior there), and about `achieve_once`, which is
    how a condition is tested that is no precondition.
    """
    if subject.is_fragment:
        return
    matcher = _Matcher(subject)
    for behavior in subject.program.behaviors:
        for statement in statements_within(body_of(behavior)):
            if not isinstance(statement, Achieve) or statement.once:
                continue
            for part in matcher.unmatched(statement.condition):
                matcher.report(part, statement.location, found)


class _Matcher:
    def __init__(self, subject: Subject) -> None:
        self.subject = subject
        self.model = Model(subject.program, Level.NONE)
        self.goals: dict[str, list[Expression]] = {}
        for behavior in subject.program.behaviors:
            if behavior.goal is not None:
                for name in _names_of(behavior.goal):
                    self.goals.setdefault(name, []).append(behavior.goal)
        writes = [s for s in statements_of(subject.program) if isinstance(s, Assign)]
        self.writes = {write.feature: write.location for write in reversed(writes)}

    def unmatched(self, condition: Expression) -> Iterator[Expression]:
        """The parts of a condition that nothing achieves."""
        match condition:
            case And(operands=operands):
                for operand in operands:
                    yield from self.unmatched(operand)
            case Or(operands=operands):
                if all(map(self._is_lost, operands)):
                    yield condition
            case Not(operand=Not(operand=operand)):
                yield from self.unmatched(operand)
            case Not(operand=And(operands=operands)):
                yield from self.unmatched(Or(tuple(map(Not, operands)), location=_of(condition)))
            case Not(operand=Or(operands=operands)):
                for operand in operands:
                    yield from self.unmatched(Not(operand, location=_of(operand)))
            case Quantified(body=body) | Not(operand=Quantified(body=body)):
                inner = Not(body, location=_of(body)) if isinstance(condition, Not) else body
                parts = list(self.unmatched(inner))
                if parts and len(parts) == len(list(_leaves(inner))):
                    yield from parts
            case (
                Read()
                | Apply()
                | Not(operand=Read() | Apply())
                | Compare()
                | Not(operand=Compare())
            ):
                if not self._is_matched(condition):
                    yield condition
            case _:
                return

    def _is_lost(self, disjunct: Expression) -> bool:
        """Whether no disjunct of this kind can be reached.

        Beside what is to be achieved, what never changes only tells which disjunct is meant.
        """
        parts = list(self.unmatched(disjunct))
        return any(map(self._is_written, parts)) or len(parts) == len(list(_leaves(disjunct)))

    def _is_written(self, part: Expression) -> bool:
        reads = (p.feature for p in subexpressions(part) if isinstance(p, Read))
        return any(name in self.writes for name in reads)

    def _is_matched(self, literal: Expression) -> bool:
        hierarchy = self.subject.hierarchy
        goals = (goal for name in _names_of(literal) for goal in self.goals.get(name, ()))
        if any(may_match(goal, literal, hierarchy) for goal in goals):
            return True
        try:
            unfolded = self.model.formula(literal)
        except NotModelled:
            return True
        if unfolded != literal:
            return not list(self.unmatched(unfolded))
        compares = isinstance(literal, Compare) or (
            isinstance(literal, Not) and isinstance(literal.operand, Compare)
        )
        if not compares:
            return False
        return any(
            isinstance(part, Apply) or (isinstance(part, Read) and part.feature in self.writes)
            for part in subexpressions(literal)
        )

    def report(self, part: Expression, statement: Location | None, found: Collector) -> None:
        """Report one part of an `achieve`, at its place if it has one."""
        location = _of(part) or statement
        assert location is not None
        reads = [p.feature for p in subexpressions(part) if isinstance(p, Read)]
        effect = next((self.writes[name] for name in reads if name in self.writes), None)
        found.add(
            UnmatchedAchieve(location=location, condition=expression_text(part), effect=effect)
        )


def _names_of(condition: Expression) -> tuple[str, ...]:
    """The features and functions of a literal or comparison; goals are looked up by them."""
    match condition:
        case Not(operand=operand):
            return _names_of(operand)
        case Compare(left=left, right=right):
            return (*_names_of(left), *_names_of(right))
        case Read(feature=name) | Apply(function=name):
            return (name,)
        case _:
            return ()


def _of(node: Expression) -> Location | None:
    return node.location


def _leaves(condition: Expression) -> Iterator[Expression]:
    match condition:
        case And(operands=operands) | Or(operands=operands):
            for operand in operands:
                yield from _leaves(operand)
        case Not(operand=And() | Or() | Not() | Quantified() as operand):
            yield from _leaves(operand)
        case Quantified(body=body):
            yield from _leaves(body)
        case _:
            yield condition


def unreachable_behaviors(subject: Subject, found: Collector) -> None:
    """Report behaviors without a goal that no behavior with a goal calls, however indirectly.

    Every behavior with a goal can be reached by some problem. Quiet when no behavior has a goal:
    then the program is run by its name.
    """
    behaviors = {b.name: b for b in subject.program.behaviors}
    pending = [b.name for b in behaviors.values() if b.goal is not None]
    if not pending:
        return
    reached = set(pending)
    for name in pending:
        for statement in statements_within(body_of(behaviors[name])):
            if isinstance(statement, Call) and statement.behavior not in reached:
                reached.add(statement.behavior)
                pending.append(statement.behavior)
    for behavior in behaviors.values():
        if behavior.name not in reached and behavior.location is not None:
            found.add(UnreachableBehavior(location=behavior.location, behavior=behavior.name))
