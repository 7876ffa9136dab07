"""Expressions as CDL writes them, for messages; parentheses only where precedence asks for them."""

from collections.abc import Mapping
from typing import Any

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

_CONDITIONAL, _OR, _AND, _NOT, _COMPARE, _XOR, _SUM, _PRODUCT, _UNARY, _POWER, _ATOM = range(11)
_ARITHMETIC = {
    "+": _SUM, "-": _SUM, "*": _PRODUCT, "/": _PRODUCT, "//": _PRODUCT, "%": _PRODUCT, "**": _POWER,
}  # fmt: skip


def expression_text(node: Expression) -> str:
    """The expression in CDL."""
    return _text(node)[0]


def variables_text(variables: tuple[Parameter, ...]) -> str:
    """`x: block, y: block`."""
    return ", ".join(f"{v.name}: {v.type}" for v in variables)


def _at(node: Expression, level: int) -> str:
    """The text of an operand, in parentheses if it binds weaker than `level`."""
    text, own = _text(node)
    return text if own >= level else f"({text})"


def _list(nodes: tuple[Expression, ...]) -> str:
    return ", ".join(expression_text(node) for node in nodes)


def _text(node: Expression) -> tuple[str, int]:
    match node:
        case Constant(value=value, type=type_):
            text = shown(value, type_)
            return text, _UNARY if text.startswith("-") else _ATOM
        case Variable(name=name) | Object(name=name):
            return name, _ATOM
        case Read(feature=name, arguments=arguments) | Apply(function=name, arguments=arguments):
            return f"{name}({_list(arguments)})", _ATOM
        case Builtin(function=function, arguments=arguments):
            return f"{function}({_list(arguments)})", _ATOM
        case Vector(elements=elements):
            return f"[{_list(elements)}]", _ATOM
        case Not(operand=operand):
            return f"not {_at(operand, _NOT)}", _NOT
        case And(operands=operands):
            return " and ".join(_at(o, _NOT) for o in operands), _AND
        case Or(operands=operands):
            return " or ".join(_at(o, _AND) for o in operands), _OR
        case Xor(left=left, right=right):
            return f"{_at(left, _XOR)} ^ {_at(right, _SUM)}", _XOR
        case Compare(operator=op, left=left, right=right):
            return f"{_at(left, _XOR)} {op} {_at(right, _XOR)}", _COMPARE
        case Negative(operand=operand):
            return f"-{_at(operand, _UNARY)}", _UNARY
        case Arithmetic(operator=op, left=left, right=right):
            level = _ARITHMETIC[op]
            sides = (level + 1, level - 1) if op == "**" else (level, level + 1)
            return f"{_at(left, sides[0])} {op} {_at(right, sides[1])}", level
        case Conditional(condition=condition, then=then, otherwise=otherwise):
            parts = _at(then, _OR), _at(condition, _OR), _at(otherwise, _CONDITIONAL)
            return "{} if {} else {}".format(*parts), _CONDITIONAL
        case Quantified(quantifier=quantifier, variables=variables, body=body):
            text = f"{quantifier} {variables_text(variables)}: {expression_text(body)}"
            # It takes everything to its right, so it is safe as an operand in parentheses only.
            return text, -1


# -------------------------------------------------------------------------------------- statistics

_LEFT_OUT = {
    "depth": "too deep",
    "width": "too wide",
    "duplicates": "seen before",
    "hopeless": "without hope",
}
_FIGURES = ("states", "effects", "evaluations")


def statistics_text(statistics: Mapping[str, Any]) -> str:
    """Figures of a search for people, in up to three lines."""
    depth = f", to depth {statistics['depth']}" if "depth" in statistics else ""
    depth += f" in width {statistics['width']}" if "width" in statistics else ""
    seconds = f" in {statistics['seconds']:.1f} s" if "seconds" in statistics else ""
    figures = ", ".join(f"{statistics[k]:,} {k}" for k in _FIGURES if k in statistics)
    text = f"searched {statistics.get('nodes', 0):,} nodes{seconds}{depth}"
    left_out = ", ".join(
        f"{number:,} {_LEFT_OUT.get(kind, kind)}"
        for kind, number in statistics.get("pruned", {}).items()
    )
    lines = [f"{text}: {figures}" if figures else text]
    if left_out:
        lines.append(f"left out: {left_out}")
    if drawn := statistics.get("generators"):
        told = (f"{tally['yielded']:,} from `{name}`" for name, tally in drawn.items())
        lines.append(f"values drawn: {', '.join(told)}")
    return "\n".join(lines)


def draws_text(generators: Mapping[str, Any]) -> str:
    """What became of the draws of each generator, for people; a line each."""
    lines = []
    for name, tally in generators.items():
        told = f"generator `{name}`: {_counted(tally['calls'], 'call')}"
        told += f", {_counted(tally['yielded'], 'value')}"
        for constraint, count in tally["rejected"].items():
            told += f", {count:,} rejected by {constraint}"
        lines.append(told)
    return "\n".join(lines)


def _counted(count: int, what: str) -> str:
    return f"{count:,} {what}{'' if count == 1 else 's'}"
