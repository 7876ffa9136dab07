"""Formulas to PDDL conditions, as nested tuples that `emit` prints."""

from dataclasses import dataclass, field

from cdlc.backends.pddl.names import Names, variable_name
from cdlc.ir.graph import in_order
from cdlc.ir.names import shown_name
from crow.program import (
    OBJECT,
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

ALWAYS: SExpr = ("and",)
NEVER: SExpr = ("or",)


class NotPddl(Exception):  # noqa: N818 - becomes a diagnostic
    """An expression that PDDL cannot say, with its place."""

    def __init__(self, construct: str, location: Location | None) -> None:
        super().__init__(construct)
        self.construct = construct
        self.location = location


# Past this a condition is no text that anyone reads, and planners choke on it.
_MOST_PARTS = 20_000


@dataclass(frozen=True, slots=True)
class Lowering:
    """How names of one action, or of the goal, are written: `variables` maps to `?x`."""

    names: Names
    variables: dict[str, str]
    # What was lowered already, by identity: formulas are graphs.
    _done: dict[int, "SExpr"] = field(default_factory=dict)

    def with_variables(self, variables: tuple[Parameter, ...]) -> "Lowering":
        """As before, with quantified variables, named apart from those around them."""
        inner = dict(self.variables)
        taken = {written[1:] for written in inner.values()}
        for variable in variables:
            name = variable_name(shown_name(variable, ()), taken)
            taken.add(name)
            inner[variable.name] = f"?{name}"
        return Lowering(self.names, inner)

    def lowered(self, node: Expression) -> "SExpr":
        """A Boolean expression as a PDDL condition, however large."""
        if id(node) not in self._done:
            self._done[id(node)] = _lowered(node, self)
        return self._done[id(node)]


def condition(node: Expression, lowering: Lowering) -> SExpr:
    """A Boolean expression as a PDDL condition. Raises NotPddl, also for one of endless text."""
    formula = lowering.lowered(node)
    if _written_size(formula, {}) > _MOST_PARTS:
        location = next((p.location for p in in_order(node) if p.location), None)
        raise NotPddl("a condition that is too large when written out", location)
    return formula


def _written_size(formula: SExpr, known: dict[int, int]) -> int:
    if isinstance(formula, str):
        return 1
    if id(formula) not in known:
        known[id(formula)] = sum(_written_size(part, known) for part in formula)
    return known[id(formula)]


def _lowered(node: Expression, lowering: Lowering) -> SExpr:
    of = lowering.lowered
    match node:
        case Constant(value=True):
            return ALWAYS
        case Constant(value=False):
            return NEVER
        case Read():
            return atom(node, lowering)
        case Not(operand=operand):
            return _negated(of(operand))
        case And(operands=operands):
            return _joined("and", list(map(of, operands)))
        case Or(operands=operands):
            return _joined("or", list(map(of, operands)))
        case Xor(left=left, right=right):
            return _either(of(left), of(right))
        case Compare(operator="==" | "!=", left=left) if is_object(left.type):
            return _equality(node, lowering)
        case Compare(operator="==" | "!=" as op, left=left, right=right) if is_boolean(left.type):
            other = of(right) if op == "!=" else _negated(of(right))
            return _either(of(left), other)
        case Conditional(condition=test, then=then, otherwise=otherwise):
            yes = _joined("and", [of(test), of(then)])
            no = _joined("and", [_negated(of(test)), of(otherwise)])
            return _joined("or", [yes, no])
        case Quantified():
            return _quantified(node, lowering)
        case _:
            raise NotPddl(_described(node), node.location)


def _quantified(node: Quantified, lowering: Lowering) -> SExpr:
    inner = lowering.with_variables(node.variables)
    body = inner.lowered(node.body)
    if body == (ALWAYS if node.quantifier == "forall" else NEVER):
        return body
    declared = typed([(inner.variables[v.name], v.type) for v in node.variables], inner.names)
    return (node.quantifier, declared, body)


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
    """A typed list: `?x ?y - block ?p - place`; without types in a task that declares none."""
    if not pddl_names.has("type"):
        return tuple(name for name, _ in names)
    items: list[SExpr] = []
    for index, (name, type_) in enumerate(names):
        items.append(name)
        if index + 1 == len(names) or names[index + 1][1] != type_:
            items += ["-", type_name(type_, pddl_names)]
    return tuple(items)


def type_name(type_: Type, names: Names) -> str:
    """The PDDL name of an object type; the root has the same name in both languages."""
    return OBJECT.name if type_ == OBJECT else names.get("type", str(type_))


def _equality(node: Compare, lowering: Lowering) -> SExpr:
    equal: SExpr = ("=", term(node.left, lowering), term(node.right, lowering))
    return equal if node.operator == "==" else _negated(equal)


def _either(left: SExpr, right: SExpr) -> SExpr:
    one = _joined("and", [left, _negated(right)])
    return _joined("or", [one, _joined("and", [_negated(left), right])])


def _negated(inner: SExpr) -> SExpr:
    if inner in (ALWAYS, NEVER):
        return NEVER if inner == ALWAYS else ALWAYS
    match inner:
        case ("not", operand):
            return operand
        case _:
            return ("not", inner)


def _joined(word: str, parts: list[SExpr]) -> SExpr:
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


def _described(node: Expression) -> str:
    if isinstance(node, Apply):
        return f"the external function `{node.function}`"
    if isinstance(node, Read):
        return f"`{node.feature}` of type `{node.type}`"
    return f"`{expression_text(node)}`"
