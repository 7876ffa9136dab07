"""The Hoare model as text, in the style of Appendix D.5.

Text has no sharing: a formula whose graph is small may be endless as text, so there is a limit.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import zip_longest

from cdlc.ir.graph import parts, written_size
from cdlc.ir.names import shown_name
from crow.program import (
    And,
    Apply,
    Arithmetic,
    Builtin,
    Compare,
    Conditional,
    Constant,
    Expression,
    Location,
    Negative,
    Not,
    Object,
    Or,
    Parameter,
    Quantified,
    Read,
    Variable,
    Vector,
    Xor,
)
from crow.program.triples import Triple, Update
from crow.values import shown

# Nodes of one formula written out; more than anyone reads.
MAX_WRITTEN = 100_000

LIMITED = "too large for level full, left at basic"

Names = Mapping[str, str]
"""What each variable is called in the text."""


@dataclass(frozen=True, slots=True)
class Line:
    """A conjunct or update as text, the statements behind it, and whether `full` gave it up."""

    text: str
    sources: tuple[Location, ...]
    is_limited: bool


def hoare_text(triples: tuple[Triple, ...]) -> str:
    """Every triple as an action: precondition, and what each written cell becomes.

    None of them may be `oversized`.
    """
    return "\n".join(_action(triple) for triple in triples)


def oversized(triple: Triple) -> Iterator[tuple[str, Location | None]]:
    """The formulas of a triple too large to write out: what each is for, and its place."""
    for formula, sources in zip_longest(triple.pre, triple.reasons):
        if written_size(formula) > MAX_WRITTEN:
            yield "the precondition", sources[0] if sources else triple.location
    for update in triple.post:
        if any(
            written_size(f) > MAX_WRITTEN for f in (*update.arguments, update.guard, update.value)
        ):
            yield f"the new value of `{update.feature}`", update.location


def preconditions(triple: Triple) -> list[Line]:
    """The conjuncts of a triple's precondition."""
    names = names_of(triple)
    return [
        Line(sexpr(part, names), sources or (), index in triple.limited)
        for index, (part, sources) in enumerate(zip_longest(triple.pre, triple.reasons))
    ]


def effects(triple: Triple) -> list[Line]:
    """The updates of a triple."""
    names = names_of(triple)
    return [Line(_update(u, names), u.sources, u.is_limited) for u in triple.post]


def names_of(triple: Triple) -> Names:
    """What the parameters of a triple are called."""
    return {p.name: p.name for p in triple.parameters}


def _action(triple: Triple) -> str:
    lines = [
        f"(:action {triple.behavior}",
        f"  :parameters ({typed(triple.parameters, names_of(triple))})",
        *_section(":precondition", preconditions(triple)),
        *_section(":effect", effects(triple)),
    ]
    return "\n".join(lines) + ")\n"


def _section(name: str, lines: list[Line]) -> Iterator[str]:
    if not lines:
        yield f"  {name} (and)"
        return
    yield f"  {name} (and"
    for index, line in enumerate(lines):
        if line.is_limited:
            yield f"    ; {LIMITED}"
        yield f"    {line.text}{')' * (index == len(lines) - 1)}"


def _update(update: Update, names: Names) -> str:
    """`(= cell value)`; a guard becomes a choice between the new value and the old one."""
    bound = tuple(Parameter(v.name, v.type) for v in update.variables if isinstance(v, Variable))
    inner = _with_names(bound, names)
    cell = f"({' '.join((update.feature, *(sexpr(a, inner) for a in update.arguments)))})"
    value, guard = sexpr(update.value, inner), sexpr(update.guard, inner)
    if not bound:
        return (
            f"(= {cell} {value})"
            if guard == "true"
            else f"(= {cell} (condition {guard} {value} {cell}))"
        )
    assigned = f"(= {cell} {value})"
    guarded = assigned if guard == "true" else f"(when {guard} {assigned})"
    return f"(forall ({typed(bound, inner)}) {guarded})"


def _with_names(variables: tuple[Parameter, ...], names: Names) -> Names:
    inner = dict(names)
    for variable in variables:
        inner[variable.name] = shown_name(variable, set(inner.values()))
    return inner


def typed(variables: tuple[Parameter, ...], names: Names) -> str:
    """Variables with their types, as PDDL writes them."""
    return " ".join(f"?{names[v.name]} - {v.type}" for v in variables)


def sexpr(node: Expression, names: Names) -> str:
    """An expression in prefix form; `condition` is the conditional, as the paper writes it.

    Formulas can be nested deeper than Python's stack allows, so what is still to be written is kept
    in a list.
    """
    written: list[str] = []
    pending: list[tuple[Expression, Names] | str] = [(node, names)]
    while pending:
        match pending.pop():
            case str(text):
                written.append(text)
            case part, inner:
                head, names_inside = _head(part, inner)
                operands = parts(part)
                if not operands and not isinstance(part, Read | Apply | Vector):
                    written.append(head)
                    continue
                written.append(f"({head}")
                pending.append(")")
                for operand in reversed(operands):
                    pending += [(operand, names_inside), " "]
    return "".join(written)


def _head(node: Expression, names: Names) -> tuple[str, Names]:
    """The first word of an expression, and the names of variables after it."""
    match node:
        case Constant(value=bool(value)):
            return str(value).lower(), names
        case Constant(value=value, type=type_):
            return shown(value, type_), names
        case Variable(name=name):
            return f"?{names[name]}", names
        case Quantified(quantifier=quantifier, variables=variables):
            inner = _with_names(variables, names)
            return f"{quantifier} ({typed(variables, inner)})", inner
        case Compare(operator=operator):
            return {"==": "=", "!=": "distinct"}.get(operator, operator), names
        case Arithmetic(operator=operator):
            return operator, names
        case Read(feature=name) | Apply(function=name) | Builtin(function=name) | Object(name=name):
            return name, names
        case Negative():
            return "-", names
        case Conditional():
            return "condition", names
        case Vector() | Not() | And() | Or() | Xor():
            return type(node).__name__.lower(), names
