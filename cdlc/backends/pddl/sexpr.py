"""PDDL formulas as nested tuples, folded while they are built; `emit` prints them."""

from collections.abc import Iterator

from crow.program import Location

SExpr = str | tuple["SExpr", ...]

ALWAYS: SExpr = ("and",)
NEVER: SExpr = ("or",)

# Past this a formula is no text that anyone reads, and planners choke on it.
MOST_PARTS = 20_000


class NotPddl(Exception):  # noqa: N818 - becomes a diagnostic
    """Something that PDDL cannot say, with its place and perhaps what to do about it."""

    def __init__(self, construct: str, location: Location | None, cure: str | None = None) -> None:
        super().__init__(construct)
        self.construct = construct
        self.location = location
        self.cure = cure


class TooLarge(NotPddl):
    """A formula whose text has no end, though its graph is small."""


def negated(inner: SExpr) -> SExpr:
    """The opposite of a condition."""
    if inner in (ALWAYS, NEVER):
        return NEVER if inner == ALWAYS else ALWAYS
    match inner:
        case ("not", operand):
            return operand
        case _:
            return ("not", inner)


def joined(word: str, parts: list[SExpr]) -> SExpr:
    """A conjunction or disjunction, folded, without nested ones of its kind."""
    decisive = NEVER if word == "and" else ALWAYS
    flat: list[SExpr] = []
    for part in parts:
        if part == decisive:
            return decisive
        if part in (ALWAYS, NEVER):
            continue
        flat += part[1:] if isinstance(part, tuple) and part[0] == word else (part,)
    return flat[0] if len(flat) == 1 else (word, *flat)


def either(left: SExpr, right: SExpr) -> SExpr:
    """That exactly one of two conditions holds."""
    one = joined("and", [left, negated(right)])
    return joined("or", [one, joined("and", [negated(left), right])])


def conjuncts(formula: SExpr) -> tuple[SExpr, ...]:
    """The parts of a conjunction; another formula alone."""
    return formula[1:] if isinstance(formula, tuple) and formula[0] == "and" else (formula,)


def written_size(formula: SExpr) -> int:
    """How many names a formula has as text, every shared part counted where it stands."""
    return _size(formula, {})


def _size(formula: SExpr, known: dict[int, int]) -> int:
    if isinstance(formula, str):
        return 1
    if id(formula) not in known:
        known[id(formula)] = sum(_size(part, known) for part in formula)
    return known[id(formula)]


def words(formula: SExpr) -> Iterator[str]:
    """The first name of every part of a formula."""
    if isinstance(formula, tuple) and formula:
        if isinstance(formula[0], str):
            yield formula[0]
        for part in formula[1:]:
            yield from words(part)


def printed(formula: SExpr) -> str:
    """A formula on one line."""
    if isinstance(formula, str):
        return formula
    return "(" + " ".join(printed(part) for part in formula) + ")"
