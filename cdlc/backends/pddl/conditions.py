"""Formulas to PDDL conditions."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TypeGuard

from cdlc.backends.pddl.cases import cases, grouped, has_choice
from cdlc.backends.pddl.names import Names, variable_name
from cdlc.backends.pddl.numbers import comparison
from cdlc.backends.pddl.sexpr import (
    ALWAYS,
    MOST_PARTS,
    NEVER,
    NotPddl,
    SExpr,
    TooLarge,
    either,
    joined,
    negated,
    written_size,
)
from cdlc.ir.graph import in_order, parts
from cdlc.ir.hoare import Model
from cdlc.ir.names import shown_name
from cdlc.ir.pool import Pool
from crow.program import (
    OBJECT,
    And,
    Apply,
    Compare,
    Conditional,
    Constant,
    Expression,
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
from crow.program.types import is_boolean, is_number, is_object
from crow.text import expression_text


@dataclass(frozen=True, slots=True)
class Lowering:
    """How formulas of one action, or of the goal, are written: `variables` maps to `?x`."""

    names: Names
    pool: Pool
    variables: Mapping[str, str]
    parameters: Mapping[str, tuple[Type, ...]] = field(default_factory=dict)
    """The types of what each feature is about."""
    # What was lowered already, by identity: formulas are graphs.
    _done: dict[int, SExpr] = field(default_factory=dict)

    def with_variables(self, variables: tuple[Parameter, ...]) -> "Lowering":
        """As before, with quantified variables, named apart from those around them."""
        inner = dict(self.variables)
        taken = {written[1:] for written in inner.values()}
        for variable in variables:
            name = variable_name(shown_name(variable, ()), taken)
            taken.add(name)
            inner[variable.name] = f"?{name}"
        return Lowering(self.names, self.pool, inner, self.parameters)

    def lowered(self, node: Expression) -> SExpr:
        """A Boolean expression as a PDDL condition, however large."""
        if id(node) not in self._done:
            self._done[id(node)] = _lowered(node, self)
        return self._done[id(node)]


def lowering_of(model: Model, names: Names, variables: Mapping[str, str]) -> Lowering:
    """How formulas of a model are written."""
    parameters = {f.name: tuple(p.type for p in f.parameters) for f in model.program.features}
    return Lowering(names, model.pool, variables, parameters)


def condition(node: Expression, lowering: Lowering) -> SExpr:
    """A Boolean expression as a PDDL condition. Raises NotPddl, also for one of endless text."""
    formula = lowering.lowered(node)
    if written_size(formula) > MOST_PARTS:
        location = next((p.location for p in in_order(node) if p.location), None)
        raise TooLarge("a condition that is too large when written out", location)
    return formula


def _lowered(node: Expression, lowering: Lowering) -> SExpr:
    of = lowering.lowered
    match node:
        case Constant(value=True):
            return ALWAYS
        case Constant(value=False):
            return NEVER
        case Not(operand=operand):
            return negated(of(operand))
        case And(operands=operands):
            return joined("and", list(map(of, operands)))
        case Or(operands=operands):
            return joined("or", list(map(of, operands)))
        case Xor(left=left, right=right):
            return either(of(left), of(right))
        case Compare(operator="==" | "!=" as op, left=left, right=right) if is_boolean(left.type):
            other = of(right) if op == "!=" else negated(of(right))
            return either(of(left), other)
        case Conditional(condition=test, then=then, otherwise=otherwise):
            yes = joined("and", [of(test), of(then)])
            no = joined("and", [negated(of(test)), of(otherwise)])
            return joined("or", [yes, no])
        case Quantified():
            return _quantified(node, lowering)
        case Read() | Compare() | Apply():
            return _atomic(node, lowering)
        case _:
            raise NotPddl(described(node), node.location)


def _quantified(node: Quantified, lowering: Lowering) -> SExpr:
    # Apart from all others, because formulas that are built inside may have quantifiers, too.
    opened = {v.name: lowering.pool.fresh(v) for v in node.variables}
    variables = tuple(Parameter(v.name, v.type) for v in opened.values() if is_variable(v))
    inner = lowering.with_variables(variables)
    body = inner.lowered(lowering.pool.substitute(node.body, opened))
    if body == (ALWAYS if node.quantifier == "forall" else NEVER):
        return body
    declared = typed([(inner.variables[v.name], v.type) for v in variables], inner.names)
    return (node.quantifier, declared, body)


def is_variable(node: Expression) -> TypeGuard[Variable]:
    """Whether an expression is a variable."""
    return isinstance(node, Variable)


# ------------------------------------------------------------------------------------------- atoms


def _atomic(node: Expression, lowering: Lowering) -> SExpr:
    """A predicate or comparison whose terms may hold choices and reads of object features."""
    pool = lowering.pool
    if has_choice(node):
        ways = grouped(pool, cases(pool, (node,), location=node.location))
        parts_ = [pool.conjunction((when, value)) for when, (value,) in ways]
        return joined("or", [lowering.lowered(part) for part in parts_])
    found = nested_read(node, pool)
    if found is not None:
        return lowering.lowered(_opened(node, found, pool))
    match node:
        case Compare(operator=operator, left=left, right=right) if is_object(left.type):
            equal = _equality(left, right, lowering)
            return equal if operator == "==" else negated(equal)
        case Compare(left=left) if is_number(left.type):
            return comparison(node, lambda read: atom(read, lowering))
        case Read() if is_boolean(node.type):
            wide = _too_wide(node, lowering)
            return atom(node, lowering) if wide is None else lowering.lowered(wide)
        case Apply(function=name, arguments=arguments) if lowering.names.has("derived", name):
            return (
                lowering.names.get("derived", name),
                *(term(a, lowering) for a in arguments),
            )
        case Apply(function=name) if is_boolean(node.type):
            cure = "give the Python of a function of objects with `--functions FILE.py`"
            raise NotPddl(described(node), node.location, cure)
        case _:
            raise NotPddl(described(node), node.location)


def nested_read(node: Expression, pool: Pool) -> Read | None:
    """An innermost read of an object where PDDL takes a variable only.

    `loc(x) == p` is an atom as it stands, if every object of the type of `p` can be a `loc`.
    """
    plain = as_value(node, pool)
    for part in in_order(node, into_quantifiers=False):
        if isinstance(part, Read) and is_object(part.type) and (not plain or part is not plain[0]):
            return part
    return None


def as_value(node: Expression, pool: Pool) -> tuple[Read, Expression] | None:
    """The read and the variable or object of `loc(x) == p`, in either order."""
    if not isinstance(node, Compare) or node.operator not in ("==", "!="):
        return None
    for read, leaf in ((node.left, node.right), (node.right, node.left)):
        if isinstance(read, Read) and isinstance(leaf, Variable | Object):
            is_plain = all(isinstance(a, Variable | Object) for a in read.arguments)
            fits = is_object(leaf.type) and pool.hierarchy.is_subtype(leaf.type, read.type)
            return (read, leaf) if is_plain and fits else None
    return None


def _opened(node: Expression, read: Read, pool: Pool) -> Expression:
    """`clear(loc(x))` as `exists p: loc(x) == p and clear(p)`: a feature has just one value."""
    value = pool.fresh(Parameter(read.feature, read.type))
    body = pool.rebuild(node, {}, lambda part: value if part is read else part)
    if isinstance(node, Compare) and is_object(node.left.type) and not _has_read(body):
        # The same, and unified-planning cannot take `exists` of a variable of a narrower type.
        other = pool.disjunction((pool.negation(pool.equal(read, value)), body))
        return pool.quantified("forall", (value,), other)
    return pool.quantified("exists", (value,), pool.conjunction((pool.equal(read, value), body)))


def _too_wide(node: Read, lowering: Lowering) -> Expression | None:
    """`q(x)` as `forall u: u == x implies q(u)`, where the type of `x` is wider than that of `u`.

    A formula says elsewhere that `x` is of the narrower type; a reader of PDDL looks at types only.
    """
    pool = lowering.pool
    types = lowering.parameters.get(node.feature, ())
    for wide, type_ in zip(node.arguments, types, strict=False):
        if isinstance(wide, Variable) and not pool.hierarchy.is_subtype(wide.type, type_):
            narrow = pool.fresh(Parameter(node.feature, type_))
            new = tuple(narrow if argument is wide else argument for argument in node.arguments)
            read = pool.read(node.feature, new, node.type)
            other = pool.disjunction((pool.negation(pool.equal(narrow, wide)), read))
            return pool.quantified("forall", (narrow,), other)
    return None


def _has_read(node: Expression) -> bool:
    return any(isinstance(part, Read) for part in in_order(node))


def _equality(left: Expression, right: Expression, lowering: Lowering) -> SExpr:
    for read, value in ((left, right), (right, left)):
        if isinstance(read, Read):
            written = atom(read, lowering)
            assert isinstance(written, tuple)
            return (*written, term(value, lowering))
    return ("=", term(left, lowering), term(right, lowering))


def atom(node: Read, lowering: Lowering) -> SExpr:
    """A read as a predicate or function with its arguments. Raises NotPddl."""
    if not lowering.names.has("feature", node.feature):
        raise NotPddl(described(node), node.location)
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
            raise NotPddl(described(node), node.location)


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


def described(node: Expression) -> str:
    """An expression in words, for messages."""
    match node:
        case Apply(function=name):
            return f"the external function `{name}`"
        case Read(feature=name, type=type_):
            return f"`{name}` of type `{type_}`"
        case _ if any(isinstance(p, Apply) for p in parts(node)):
            return described(next(p for p in parts(node) if isinstance(p, Apply)))
        case _:
            return f"`{expression_text(node)}`"
