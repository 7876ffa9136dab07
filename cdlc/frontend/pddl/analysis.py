"""What actions do to predicates: which never change, which have to be false somewhere."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from cdlc.frontend.pddl.nodes import (
    Arithmetic,
    Atom,
    Compare,
    Domain,
    Equal,
    Formula,
    Junction,
    Not,
    Number,
    Problem,
    Quantified,
    Typed,
    ancestors,
)


def atoms(node: Formula | Number) -> Iterator[Atom]:
    """The predicates and functions that a formula or number reads."""
    match node:
        case Atom():
            yield node
        case Compare(left=left, right=right) | Arithmetic(left=left, right=right):
            yield from atoms(left)
            yield from atoms(right)
        case Not(operand=operand):
            yield from atoms(operand)
        case Junction(operands=operands):
            for operand in operands:
                yield from atoms(operand)
        case Quantified(body=body):
            yield from atoms(body)
        case Equal() | int() | float():
            return


def reads(node: Formula | Number) -> set[str]:
    """The names of what it reads."""
    return {atom.name for atom in atoms(node)}


Pattern = tuple[str, tuple[tuple[str | None, str], ...]]
"""A predicate with, for each argument, the object if it is one, and its type."""


@dataclass(frozen=True, slots=True)
class Patterns:
    """Which cells two atoms may share, judged by their objects and types."""

    types: Mapping[str, str]
    parents: Mapping[str, str]

    def of(self, atom: Atom) -> Pattern:
        """The pattern of an atom."""
        known = [(None if a.startswith("?") else a, self.types[a]) for a in atom.arguments]
        return atom.name, tuple(known)

    def may_meet(self, first: Iterable[Atom], second: Iterable[Atom]) -> bool:
        """Whether one of the first may be one of the second."""
        others = [self.of(atom) for atom in second]
        return any(self.may_be(self.of(atom), other) for atom in first for other in others)

    def may_be(self, first: Pattern, second: Pattern) -> bool:
        """Whether two patterns have a cell in common."""
        if first[0] != second[0]:
            return False
        for (one, type_), (other, other_type) in zip(first[1], second[1], strict=True):
            if one is not None and other is not None:
                if one != other:
                    return False
            elif not self.related(type_, other_type):
                return False
        return True

    def related(self, first: str, second: str) -> bool:
        """Whether some object may be of both types."""
        above = ancestors(first, self.parents), ancestors(second, self.parents)
        return first in above[1] or second in above[0]


def terms(node: Formula | Number) -> Iterator[str]:
    """The variables and objects in it, bound ones included, from left to right."""
    match node:
        case Atom(arguments=arguments):
            yield from arguments
        case Equal(left=left, right=right):
            yield from (left, right)
        case Compare(left=left, right=right) | Arithmetic(left=left, right=right):
            yield from terms(left)
            yield from terms(right)
        case Not(operand=operand):
            yield from terms(operand)
        case Junction(operands=operands):
            for operand in operands:
                yield from terms(operand)
        case Quantified(variables=variables, body=body):
            yield from (variable.name for variable in variables)
            yield from terms(body)
        case int() | float():
            return


def bound_variables(formula: Formula) -> Iterator[Typed]:
    """The variables that quantifiers in a formula bind."""
    match formula:
        case Quantified(variables=variables, body=body):
            yield from variables
            yield from bound_variables(body)
        case Not(operand=operand):
            yield from bound_variables(operand)
        case Junction(operands=operands):
            for operand in operands:
                yield from bound_variables(operand)
        case _:
            return


def changed(domain: Domain) -> set[str]:
    """Predicates and functions that an action, or a definition that reads such a one, changes."""
    found = {effect.cell.name for action in domain.actions for effect in action.effects}
    while True:
        more = {d.name for d in domain.derived if reads(d.body) & found} - found
        if not more:
            return found
        found |= more


def negated(domain: Domain, problem: Problem | None) -> set[str]:
    """Predicates that some condition or goal wants to be false."""
    found: set[str] = set()
    for formula in _conditions(domain, problem):
        found |= set(_negated(formula, is_positive=True))
    for definition in domain.derived:
        # It may itself be wanted either way.
        found |= reads(definition.body)
    return found


def _conditions(domain: Domain, problem: Problem | None) -> Iterator[Formula]:
    for action in domain.actions:
        yield action.precondition
        yield from (effect.condition for effect in action.effects)
    if problem is not None:
        yield problem.goal


def _negated(formula: Formula, *, is_positive: bool) -> Iterator[str]:
    match formula:
        case Atom(name=name) if not is_positive:
            yield name
        case Not(operand=operand):
            yield from _negated(operand, is_positive=not is_positive)
        case Junction(operands=operands):
            for operand in operands:
                yield from _negated(operand, is_positive=is_positive)
        case Quantified(body=body):
            yield from _negated(body, is_positive=is_positive)
        case _:
            return


def conjuncts(formula: Formula) -> Iterator[Formula]:
    """The parts of a conjunction, however it is nested."""
    if isinstance(formula, Junction) and formula.operator == "and":
        for operand in formula.operands:
            yield from conjuncts(operand)
    else:
        yield formula


def conjunction(parts: Iterable[Formula]) -> Formula:
    """All of the parts."""
    kept = tuple(parts)
    return kept[0] if len(kept) == 1 else Junction("and", kept)


def disjunction(parts: Iterable[Formula]) -> Formula:
    """Any of the parts."""
    kept = tuple(dict.fromkeys(parts))
    return kept[0] if len(kept) == 1 else Junction("or", kept)


def renamed(node: Formula, names: dict[str, str]) -> Formula:
    """A formula with other names for its terms."""
    match node:
        case Atom(name=name, arguments=arguments):
            return Atom(name, tuple(names.get(a, a) for a in arguments))
        case Equal(left=left, right=right):
            return Equal(names.get(left, left), names.get(right, right))
        case Compare(operator=operator, left=left, right=right):
            return Compare(operator, renamed_number(left, names), renamed_number(right, names))
        case Not(operand=operand):
            return Not(renamed(operand, names))
        case Junction(operator=operator, operands=operands):
            return Junction(operator, tuple(renamed(o, names) for o in operands))
        case Quantified(quantifier=quantifier, variables=variables, body=body):
            fresh = tuple(replace(v, name=names.get(v.name, v.name)) for v in variables)
            return Quantified(quantifier, fresh, renamed(body, names))


def renamed_number(node: Number, names: dict[str, str]) -> Number:
    """A number with other names for its terms."""
    match node:
        case Atom(name=name, arguments=arguments):
            return Atom(name, tuple(names.get(a, a) for a in arguments))
        case Arithmetic(operator=operator, left=left, right=right):
            sides = renamed_number(left, names), renamed_number(right, names)
            return Arithmetic(operator, *sides)
        case int() | float():
            return node
