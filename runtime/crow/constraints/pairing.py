"""Which generators may give values to the unknowns of a requirement (App. B.1)."""

from collections.abc import Iterator
from dataclasses import dataclass

from crow.conditions import MIRRORED, NEGATED, plain
from crow.constraints.knowledge import Knowledge
from crow.constraints.python import Cells
from crow.constraints.terms import Ground, Open, is_known, unknowns_of
from crow.program import (
    Apply,
    Compare,
    Constant,
    Expression,
    Generator,
    Not,
    Object,
    Read,
    Variable,
)
from crow.program.types import is_object
from crow.unknowns import Unknown

_CALLED = ("call", "named", "read")


@dataclass(frozen=True, slots=True, eq=False)
class Pairing:
    """A generator with what its inputs and outputs are in one requirement.

    `read` are unknowns in the cells that its Python reads: it can be asked when they are known.
    """

    generator: Generator
    inputs: tuple[Ground, ...]
    outputs: tuple[Ground, ...]
    cells: Cells
    read: tuple[Unknown, ...]

    @property
    def wanted(self) -> dict[Unknown, None]:
        """The unknowns that its outputs give values to, in order."""
        return dict.fromkeys(u for output in self.outputs for u in unknowns_of(output))


def pairings(knowledge: Knowledge, term: Ground, is_wanted: bool) -> tuple[Pairing, ...]:
    """The generators whose goal matches a term that has to be true, or false.

    Function or feature, polarity and comparison are the same, an equation in either orientation.
    """
    if type(term) is not Open or not knowledge.goals:
        return ()
    while term.operator == "not":
        term, is_wanted = term.operands[0], not is_wanted
        if type(term) is not Open:
            return ()
    found = []
    for generator in knowledge.world.program.generators:
        for bound, atom in _matches(knowledge, plain(generator.goal), term, is_wanted):
            pairing = _paired(knowledge, generator, bound, atom)
            if pairing is not None:
                found.append(pairing)
    return tuple(found)


def _paired(
    knowledge: Knowledge, generator: Generator, bound: dict[str, Ground], atom: Open
) -> Pairing | None:
    python = knowledge.python.generators.get(generator.name)
    if python is None or atom.cells is None:
        return None
    if any(p.name not in bound or not _is_of(knowledge, p.type, bound[p.name])
           for p in generator.parameters):  # fmt: skip
        return None
    outputs = tuple(bound[name] for name in generator.outputs)
    if all(map(is_known, outputs)):
        return None
    read = tuple(dict.fromkeys(knowledge.unknowns_read(atom.cells, python.reads)))
    inputs = tuple(bound[name] for name in generator.inputs)
    return Pairing(generator, inputs, outputs, atom.cells, read)


def _is_of(knowledge: Knowledge, type_: object, ground: Ground) -> bool:
    """Whether an object may stand for a parameter; other values do when the function's do."""
    if not is_object(type_) or not is_known(ground):  # type: ignore[arg-type]
        return True
    return knowledge.world.is_of(ground, type_)  # type: ignore[arg-type]


def _matches(
    knowledge: Knowledge, goal: Expression, term: Open, is_wanted: bool
) -> Iterator[tuple[dict[str, Ground], Open]]:
    """What the parameters of a goal are for a term that has to be true, or false; with its atom."""
    match goal:
        case Not(operand=operand):
            yield from _matches(knowledge, operand, term, not is_wanted)
        case Apply() | Read():
            if is_wanted:
                yield from _atoms(goal, term, {})
        case Compare(operator=wanted) if term.operator in NEGATED:
            own = term.operator if is_wanted else NEGATED[term.operator]  # type: ignore[index]
            left, right = term.operands
            for op, sides in ((own, (left, right)), (MIRRORED[own], (right, left))):  # type: ignore[index]
                if op == wanted:
                    yield from _compared(goal, *sides)
        case _:
            return


def _compared(
    goal: Compare, left: Ground, right: Ground
) -> Iterator[tuple[dict[str, Ground], Open]]:
    """Both sides of a comparison, as they stand."""
    pairs = ((goal.left, left, goal.right, right), (goal.right, right, goal.left, left))
    for pattern, term, other, value in pairs:
        if isinstance(pattern, Apply | Read) and type(term) is Open:
            bound: dict[str, Ground] = {}
            if _bound(other, value, bound):
                yield from _atoms(pattern, term, bound)


def _atoms(
    pattern: Apply | Read, term: Open, bound: dict[str, Ground]
) -> Iterator[tuple[dict[str, Ground], Open]]:
    name = pattern.function if isinstance(pattern, Apply) else pattern.feature
    if term.operator not in _CALLED or term.name != name:
        return
    arguments = term.operands[1:] if term.operator == "named" else term.operands
    count = len(pattern.arguments)
    own = dict(bound)
    if all(_bound(p, a, own) for p, a in zip(pattern.arguments, arguments[:count], strict=True)):
        yield own, term


def _bound(pattern: Expression, ground: Ground, bound: dict[str, Ground]) -> bool:
    """Whether a ground may stand for an argument of a goal; a parameter is bound to it."""
    match pattern:
        case Variable(name=name):
            if name not in bound:
                bound[name] = ground
                return True
            return _is_one(bound[name], ground)
        case Constant(value=value):
            return is_known(ground) and bool(ground == value)
        case Object(name=name):
            return is_known(ground) and bool(ground == name)
        case _:
            return False


def _is_one(left: Ground, right: Ground) -> bool:
    if left is right:
        return True
    return is_known(left) and is_known(right) and bool(left == right)
