"""The Hoare model as text, in the style of Appendix D.5."""

from collections.abc import Iterator

from cdlc.ir.hoare import Triple, Update
from cdlc.ir.logic import conjunction
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


def hoare_text(triples: tuple[Triple, ...]) -> str:
    """Every triple as an action: precondition, and what each written cell becomes."""
    return "\n".join(_triple(triple) for triple in triples)


def _triple(triple: Triple) -> str:
    lines = [
        f"(:action {triple.behavior}",
        f"  :parameters ({_typed(triple.parameters)})",
        *_section(":precondition", [sexpr(part) for part in triple.pre]),
        *_section(":effect", [_update(update) for update in triple.post]),
    ]
    return "\n".join(lines) + ")\n"


def _section(name: str, parts: list[str]) -> Iterator[str]:
    if not parts:
        yield f"  {name} (and)"
        return
    yield f"  {name} (and"
    yield from (f"    {part}" for part in parts[:-1])
    yield f"    {parts[-1]})"


def _update(update: Update) -> str:
    return f"(= {_call(update.feature, update.arguments)} {sexpr(update.value)})"


def _typed(variables: tuple[Parameter, ...]) -> str:
    return " ".join(f"?{v.name} - {v.type}" for v in variables)


def _call(name: str, arguments: tuple[Expression, ...]) -> str:
    return f"({' '.join((name, *map(sexpr, arguments)))})"


def sexpr(node: Expression) -> str:
    """An expression in prefix form; `condition` is the conditional, as the paper writes it."""
    match node:
        case Constant(value=bool(value)):
            return "true" if value else "false"
        case Constant(value=value, type=type_):
            return shown(value, type_)
        case Variable(name=name):
            return f"?{name}"
        case Object(name=name):
            return name
        case Read(feature=name, arguments=arguments) | Apply(function=name, arguments=arguments):
            return _call(name, arguments)
        case Builtin(function=name, arguments=arguments):
            return _call(name, arguments)
        case Vector(elements=elements):
            return _call("vector", elements)
        case Not(operand=operand):
            return _call("not", (operand,))
        case And(operands=operands):
            return _call("and", operands)
        case Or(operands=operands):
            return _call("or", operands)
        case Xor(left=left, right=right):
            return _call("xor", (left, right))
        case Compare(operator=operator, left=left, right=right):
            word = {"==": "=", "!=": "distinct"}.get(operator, operator)
            return _call(word, (left, right))
        case Negative(operand=operand):
            return _call("-", (operand,))
        case Arithmetic(operator=operator, left=left, right=right):
            return _call(operator, (left, right))
        case Conditional(condition=condition, then=then, otherwise=otherwise):
            return _call("condition", (condition, then, otherwise))
        case Quantified(quantifier=quantifier, variables=variables, body=body):
            return f"({quantifier} ({_typed(variables)}) {sexpr(body)})"


def precondition(triple: Triple) -> Expression:
    """The precondition as one formula."""
    return conjunction(triple.pre)
