"""Formulas to PDDL conditions, as nested tuples that `emit` prints."""

from dataclasses import dataclass

from cdlc.backends.pddl.names import Names
from cdlc.ir.names import shown_name
from crow.program import (
    And,
    Apply,
    Compare,
    Conditional,
    Constant,
    Expression,
    Location,
    Not,
    Object,
    Or,
    Parameter,
    Quantified,
    Read,
    Type,
    Variable,
    Xor,
)
from crow.program.types import is_boolean, is_object
from crow.text import expression_text

SExpr = str | tuple["SExpr", ...]


class NotPddl(Exception):  # noqa: N818 - becomes a diagnostic
    """An expression that PDDL cannot say, with its place."""

    def __init__(self, construct: str, location: Location | None) -> None:
        super().__init__(construct)
        self.construct = construct
        self.location = location


@dataclass(frozen=True, slots=True)
class Lowering:
    """How names of one action, or of the goal, are written: `variables` maps to `?x`."""

    names: Names
    variables: dict[str, str]

    def with_variables(self, variables: tuple[Parameter, ...]) -> "Lowering":
        """As before, with quantified variables, named apart from those around them."""
        inner = dict(self.variables)
        for variable in variables:
            taken = {name[1:] for name in inner.values()}
            inner[variable.name] = f"?{shown_name(variable, taken)}"
        return Lowering(self.names, inner)


def condition(node: Expression, lowering: Lowering) -> SExpr:
    """A Boolean expression as a PDDL condition. Raises NotPddl."""
    match node:
        case Constant(value=True):
            return ("and",)
        case Constant(value=False):
            return ("or",)
        case Read():
            return atom(node, lowering)
        case Not(operand=operand):
            return _negated(condition(operand, lowering))
        case And(operands=operands):
            return _joined("and", [condition(o, lowering) for o in operands])
        case Or(operands=operands):
            return _joined("or", [condition(o, lowering) for o in operands])
        case Xor(left=left, right=right):
            return _either(condition(left, lowering), condition(right, lowering))
        case Compare(operator="==" | "!=", left=left) if is_object(left.type):
            return _equality(node, lowering)
        case Compare(operator="==" | "!=" as op, left=left, right=right) if is_boolean(left.type):
            differ = _either(condition(left, lowering), condition(right, lowering))
            return differ if op == "!=" else _negated(differ)
        case Conditional(condition=test, then=then, otherwise=otherwise):
            chosen = condition(test, lowering)
            yes = _joined("and", [chosen, condition(then, lowering)])
            no = _joined("and", [_negated(chosen), condition(otherwise, lowering)])
            return _joined("or", [yes, no])
        case Quantified(quantifier=quantifier, variables=variables, body=body):
            inner = lowering.with_variables(variables)
            declared = typed([(inner.variables[v.name], v.type) for v in variables], inner.names)
            return (quantifier, declared, condition(body, inner))
        case _:
            raise NotPddl(_described(node), node.location)


def atom(node: Read, lowering: Lowering) -> SExpr:
    """A read of a Boolean feature as an atom. Raises NotPddl."""
    if not is_boolean(node.type):
        raise NotPddl(_described(node), node.location)
    arguments = [term(a, lowering) for a in node.arguments]
    return (lowering.names.get("feature", node.feature), *arguments)


def term(node: Expression, lowering: Lowering) -> str:
    """An object expression as a PDDL term. Raises NotPddl."""
    match node:
        case Variable(name=name):
            return lowering.variables[name]
        case Object(name=name):
            return lowering.names.get("object", name)
        case _:
            raise NotPddl(_described(node), node.location)


def typed(names: list[tuple[str, Type]], pddl_names: Names) -> tuple[SExpr, ...]:
    """A typed list: `?x ?y - block ?p - place`."""
    items: list[SExpr] = []
    for index, (name, type_) in enumerate(names):
        items.append(name)
        if index + 1 == len(names) or names[index + 1][1] != type_:
            items += ["-", type_name(type_, pddl_names)]
    return tuple(items)


def type_name(type_: Type, names: Names) -> str:
    """The PDDL name of an object type; the root has the same name in both languages."""
    return "object" if str(type_) == "object" else names.get("type", str(type_))


def _equality(node: Compare, lowering: Lowering) -> SExpr:
    equal: SExpr = ("=", term(node.left, lowering), term(node.right, lowering))
    return equal if node.operator == "==" else _negated(equal)


def _either(left: SExpr, right: SExpr) -> SExpr:
    one = _joined("and", [left, _negated(right)])
    return _joined("or", [one, _joined("and", [_negated(left), right])])


def _negated(inner: SExpr) -> SExpr:
    match inner:
        case ("not", operand):
            return operand
        case ("and",):
            return ("or",)
        case ("or",):
            return ("and",)
        case _:
            return ("not", inner)


def _joined(word: str, parts: list[SExpr]) -> SExpr:
    """A conjunction or disjunction without nested ones of its kind."""
    flat: list[SExpr] = []
    for part in parts:
        flat += part[1:] if isinstance(part, tuple) and part[0] == word else (part,)
    return flat[0] if len(flat) == 1 else (word, *flat)


def _described(node: Expression) -> str:
    if isinstance(node, Apply):
        return f"the external function `{node.function}`"
    if isinstance(node, Read):
        return f"`{node.feature}` of type `{node.type}`"
    return f"`{expression_text(node)}`"
