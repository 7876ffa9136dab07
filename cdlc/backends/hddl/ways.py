"""Bodies without choices: each `alternative` decided, and each `if` that can be decided at once.

An `if` that stands after something that acts is kept: its condition is looked at only then. In a
promotable section it is decided where the section starts.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import islice, product
from typing import TypeVar

from cdlc.backends.hddl.forms import Form, literals, oriented
from cdlc.backends.pddl.sexpr import NotPddl
from crow.conditions import Wanted
from crow.program import (
    Achieve,
    And,
    Annotation,
    Apply,
    Assert,
    Behavior,
    Bind,
    Call,
    Compare,
    Constant,
    Do,
    Expression,
    ForEach,
    ForRange,
    Group,
    If,
    Let,
    Location,
    Not,
    Or,
    Quantified,
    Read,
    Statement,
)
from crow.program.types import INT64
from crow.program.walk import statements_within

MOST_WAYS = 64

Block = tuple[Statement, ...]

# Marks a `bind` that the program does not have.
CHOSEN = (Annotation("'chosen"),)


@dataclass(frozen=True, slots=True)
class Rules:
    """What decides how achieves are taken apart: `forms` are those that behaviors achieve.

    `checks` says that all parts of a conjunction have to hold together after they were achieved;
    where an effect follows, its action demands that.
    """

    wanted: Wanted
    forms: frozenset[Form]
    is_static: Callable[[Expression], bool]
    checks: bool


def acts(statement: Statement) -> bool:
    """Whether a statement may change the state on its own, or in other behaviors."""
    return any(isinstance(s, Achieve | Call | Do) for s in statements_within((statement,)))


def ways_of(behavior: Behavior, rules: Rules) -> list[Block]:
    """The ways through a behavior's body. Raises NotPddl for too many."""
    members = () if behavior.promotable is None else behavior.promotable.members
    order = "sequential" if behavior.promotable is None else behavior.promotable.order
    has_acted = any(map(acts, behavior.left))
    inside = replace(rules, checks=False)
    found = (
        (*left, *early, Group(order, inner), *right)
        for left in _block(behavior.left, rules, has_acted=False)
        for early, inner in _members(members, inside)
        for right in _block(behavior.right, rules, has_acted=has_acted or bool(members))
    )
    return _limited(found, behavior.location)


def ways_through(block: Block, rules: Rules, location: Location | None) -> list[Block]:
    """The ways through a block that is a task of its own. Raises NotPddl for too many."""
    return _limited(_block(block, rules, has_acted=False), location)


def _limited(found: Iterator[Block], location: Location | None) -> list[Block]:
    ways = _some(found)
    if len(ways) > MOST_WAYS:
        raise NotPddl(f"a body with more than {MOST_WAYS} choices", location)
    return ways


def _block(block: Block, rules: Rules, *, has_acted: bool) -> Iterator[Block]:
    each: list[list[Block]] = []
    for statement in block:
        each.append(_some(_statement(statement, rules, has_acted=has_acted)))
        has_acted = has_acted or acts(statement)
    return (tuple(s for way in chosen for s in way) for chosen in product(*each))


_T = TypeVar("_T")


def _some(ways: Iterator[_T]) -> list[_T]:
    """As many ways as may be, and one too many."""
    return list(islice(ways, MOST_WAYS + 1))


def _statement(node: Statement, rules: Rules, *, has_acted: bool) -> Iterator[Block]:
    match node:
        case Achieve():
            yield from _achieve(node, rules, has_acted=has_acted)
        case Group(order="alternative", body=body):
            for chosen in body:
                yield from _statement(chosen, rules, has_acted=has_acted)
        case Group(order="unordered", body=body):
            acting = [sum(map(acts, body)) > acts(s) for s in body]
            each = [
                [_sequence(w) for w in _some(_statement(s, rules, has_acted=has_acted or others))]
                for s, others in zip(body, acting, strict=True)
            ]
            yield from ((replace(node, body=inner),) for inner in product(*each))
        case Group(body=body):
            for inner in _block(body, rules, has_acted=has_acted):
                yield (replace(node, body=inner),)
        case ForRange(variable=variable, body=body):
            turns = [
                Group("sequential", (Let(variable, Constant(number, INT64)), *body))
                for number in range(node.start, node.stop, node.step)
            ]
            yield from _block(tuple(turns), rules, has_acted=has_acted)
        case If(condition=test) if not has_acted or rules.is_static(test):
            for condition, branch in branches(node):
                for inner in _block(branch, rules, has_acted=has_acted):
                    yield (condition, _sequence(inner))
        case _:
            yield (node,)


def _members(members: Block, rules: Rules) -> Iterator[tuple[Block, Block]]:
    """The ways through members of a promotable section, after what they demand at its start."""
    each = [_some(_member(member, rules)) for member in members]
    for chosen in product(*each):
        yield tuple(c for early, _ in chosen for c in early), tuple(s for _, s in chosen)


def _member(node: Statement, rules: Rules) -> Iterator[tuple[Block, Statement]]:
    match node:
        case If():
            for condition, branch in branches(node):
                for early, inner in _members(branch, rules):
                    yield (condition, *early), _sequence(inner)
        case Group(order="alternative", body=body):
            for chosen in body:
                yield from _member(chosen, rules)
        case Group(body=body):
            for early, inner in _members(body, rules):
                yield early, replace(node, body=inner)
        case _:
            # Conditions of what an achieve is taken apart into stay with it.
            for way in _statement(node, rules, has_acted=True):
                yield (), _sequence(way)


def branches(node: If) -> Iterator[tuple[Assert, Block]]:
    """The branches of an `if`, each with what it demands."""
    yield Assert(node.condition, location=node.condition.location), node.then
    negated = Not(node.condition, location=node.condition.location)
    yield Assert(negated, location=node.condition.location), node.otherwise


def _sequence(block: Block) -> Statement:
    return block[0] if len(block) == 1 else Group("sequential", block)


def _achieve(node: Achieve, rules: Rules, *, has_acted: bool) -> Iterator[Block]:
    """The ways of an achieve: of a compound condition those of its parts (semantics.md §2)."""
    condition = rules.wanted.normal(node.condition)

    def achieving(part: Expression) -> Achieve:
        return replace(node, condition=part)

    taken: Statement
    match condition:
        case And(operands=operands):
            together = Group("unordered", tuple(map(achieving, operands)))
            taken = _checked(together, condition, rules)
        case Or(operands=operands):
            taken = Group("alternative", tuple(map(achieving, operands)))
        case Quantified(quantifier="forall", variables=variables, body=body):
            each = ForEach(variables, (achieving(body),), location=node.location)
            taken = _checked(each, condition, rules)
        case Quantified(variables=variables, body=body):
            some = Bind(variables, None, location=node.location, annotations=CHOSEN)
            taken = Group("sequential", (some, achieving(body)))
        case _:
            yield from ((found,) for found in _literal(node, condition, rules))
            return
    yield from _statement(taken, rules, has_acted=has_acted)


def _checked(parts: Statement, condition: Expression, rules: Rules) -> Statement:
    if not rules.checks:
        return parts
    return Group("sequential", (parts, Assert(condition, location=condition.location)))


def _literal(node: Achieve, condition: Expression, rules: Rules) -> Iterator[Statement]:
    """An achieve of a literal; of a comparison in each way that some behavior achieves it.

    The side that behaviors change is the left one then. What is no literal can be true only.
    """
    if not any(literals(condition)):
        yield Assert(condition, location=node.location)
        return
    sides = [side for side in oriented(condition) if _left(side) is not None]
    ways = [side for side in sides if _left(side) in rules.forms] or sides[:1]
    yield from (replace(node, condition=side) for side in ways)


def _left(condition: Expression) -> Form | None:
    """The form of a literal, a comparison taken as one of its left side."""
    if isinstance(condition, Compare) and not isinstance(condition.left, Read | Apply):
        return None
    return next((literal.form for literal in literals(condition)), None)
