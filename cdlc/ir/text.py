"""The Hoare model as text, in the style of Appendix D.5.

Text has no sharing: a formula whose graph is small may be endless as text, so there is a limit.
"""

from collections.abc import Iterator, Mapping

from cdlc.ir.graph import in_order, parts
from cdlc.ir.hoare import Triple
from cdlc.ir.names import shown_name
from cdlc.ir.updates import NotModelled, Update
from crow.program import (
    And,
    Apply,
    Arithmetic,
    Builtin,
    Compare,
    Conditional,
    Constant,
    Expression,
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
from crow.values import shown

# Nodes of one formula written out; more than anyone reads.
MAX_WRITTEN = 100_000

Names = Mapping[str, str]
"""What each variable is called in the text."""


def hoare_text(triples: tuple[Triple, ...]) -> str:
    """Every triple as an action: precondition, and what each written cell becomes.

    Raises NotModelled, naming the behavior, for a formula too large to write out.
    """
    return "\n".join(_triple(triple) for triple in triples)


def _triple(triple: Triple) -> str:
    names = {p.name: p.name for p in triple.parameters}
    for formula in (*triple.pre, *(f for u in triple.post for f in (u.guard, u.value))):
        if written_size(formula) > MAX_WRITTEN:
            construct = f"a formula of over {MAX_WRITTEN:,} parts, too large to write out,"
            raise NotModelled(construct, triple.location)
    lines = [
        f"(:action {triple.behavior}",
        f"  :parameters ({_typed(triple.parameters, names)})",
        *_section(":precondition", [sexpr(part, names) for part in triple.pre]),
        *_section(":effect", [_update(update, names) for update in triple.post]),
    ]
    return "\n".join(lines) + ")\n"


def written_size(formula: Expression) -> int:
    """How many nodes a formula has as text, every shared part counted where it stands."""
    sizes: dict[int, int] = {}
    for node in in_order(formula):
        sizes[id(node)] = 1 + sum(sizes[id(part)] for part in parts(node))
    return sizes[id(formula)]


def _section(name: str, lines: list[str]) -> Iterator[str]:
    if not lines:
        yield f"  {name} (and)"
        return
    yield f"  {name} (and"
    yield from (f"    {line}" for line in lines[:-1])
    yield f"    {lines[-1]})"


def _update(update: Update, names: Names) -> str:
    """`(= cell value)`; a guard becomes a choice between the new value and the old one."""
    bound = tuple(Parameter(v.name, v.type) for v in update.variables if isinstance(v, Variable))
    inner = _with_names(bound, names)
    cell = _call(update.feature, update.arguments, inner)
    value, guard = sexpr(update.value, inner), sexpr(update.guard, inner)
    if not bound:
        return (
            f"(= {cell} {value})"
            if guard == "true"
            else f"(= {cell} (condition {guard} {value} {cell}))"
        )
    assigned = f"(= {cell} {value})"
    guarded = assigned if guard == "true" else f"(when {guard} {assigned})"
    return f"(forall ({_typed(bound, inner)}) {guarded})"


def _with_names(variables: tuple[Parameter, ...], names: Names) -> Names:
    inner = dict(names)
    for variable in variables:
        inner[variable.name] = shown_name(variable, set(inner.values()))
    return inner


def _typed(variables: tuple[Parameter, ...], names: Names) -> str:
    return " ".join(f"?{names[v.name]} - {v.type}" for v in variables)


def _call(name: str, arguments: tuple[Expression, ...], names: Names) -> str:
    return f"({' '.join((name, *(sexpr(a, names) for a in arguments)))})"


def sexpr(node: Expression, names: Names) -> str:
    """An expression in prefix form; `condition` is the conditional, as the paper writes it."""

    def call(word: str, *operands: Expression) -> str:
        return _call(word, operands, names)

    match node:
        case Constant(value=bool(value)):
            return "true" if value else "false"
        case Constant(value=value, type=type_):
            return shown(value, type_)
        case Variable(name=name):
            return f"?{names[name]}"
        case Object(name=name):
            return name
        case Read(feature=name, arguments=arguments) | Apply(function=name, arguments=arguments):
            return call(name, *arguments)
        case Builtin(function=name, arguments=arguments):
            return call(name, *arguments)
        case Vector(elements=elements):
            return call("vector", *elements)
        case Not(operand=operand):
            return call("not", operand)
        case And(operands=operands):
            return call("and", *operands)
        case Or(operands=operands):
            return call("or", *operands)
        case Xor(left=left, right=right):
            return call("xor", left, right)
        case Compare(operator=operator, left=left, right=right):
            word = {"==": "=", "!=": "distinct"}.get(operator, operator)
            return call(word, left, right)
        case Negative(operand=operand):
            return call("-", operand)
        case Arithmetic(operator=operator, left=left, right=right):
            return call(operator, left, right)
        case Conditional(condition=condition, then=then, otherwise=otherwise):
            return call("condition", condition, then, otherwise)
        case Quantified(quantifier=quantifier, variables=variables, body=body):
            inner = _with_names(variables, names)
            return f"({quantifier} ({_typed(variables, inner)}) {sexpr(body, inner)})"
