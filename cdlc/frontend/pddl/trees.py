"""Formulas and numbers of PDDL as expressions of CDL."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from cdlc.frontend import syntax
from cdlc.frontend.pddl.analysis import Patterns
from cdlc.frontend.pddl.naming import NOWHERE, Naming
from cdlc.frontend.pddl.nodes import (
    Arithmetic,
    Atom,
    Compare,
    Equal,
    Formula,
    Junction,
    Not,
    Number,
    Quantified,
    Typed,
)


def name(text: str) -> syntax.Name:
    """An identifier."""
    return syntax.Name(text, span=NOWHERE)


def variable(text: str) -> syntax.NameExpression:
    """A name as an expression."""
    return syntax.NameExpression(text, span=NOWHERE)


def literal(value: bool | float | str) -> syntax.Expression:
    """A literal; a negative number is the negation of one."""
    if not isinstance(value, bool | str) and value < 0:
        return syntax.Unary("-", literal(-value), span=NOWHERE)
    return syntax.Literal(value, span=NOWHERE)


def primitive(type_: str) -> syntax.NamedType:
    """A type of CDL's own."""
    return syntax.NamedType(type_, span=NOWHERE)


@dataclass(frozen=True, slots=True)
class Trees:
    """Names for everything that formulas mention.

    `variables` are CDL names by PDDL variable, `types` the type of each variable and object,
    `parents` the type hierarchy.
    """

    naming: Naming
    parents: Mapping[str, str]
    variables: Mapping[str, str] = field(default_factory=dict)
    types: Mapping[str, str] = field(default_factory=dict)

    def inside(self, variables: Mapping[str, str], typed: Iterable[Typed]) -> "Trees":
        """The same within an action."""
        types = {**self.types, **{t.name: t.type for t in typed}}
        return replace(self, variables=variables, types=types)

    @property
    def patterns(self) -> Patterns:
        """What is known of its variables and objects."""
        return Patterns(self.types, self.parents)

    def type(self, type_: str) -> syntax.NamedType:
        """A type."""
        return syntax.NamedType(self.naming.type(type_), span=NOWHERE)

    def declared(self, variables: Iterable[Typed]) -> tuple[syntax.TypedName, ...]:
        """Declared variables."""
        return tuple(
            syntax.TypedName(name(self.variables[v.name]), self.type(v.type), span=NOWHERE)
            for v in variables
        )

    def term(self, term: str) -> syntax.Expression:
        """A variable or object."""
        if term.startswith("?"):
            return variable(self.variables[term])
        return variable(self.naming.value("object", term))

    def call(self, kind: str, atom: Atom, *, bracketed: bool = False) -> syntax.Call:
        """`f(a, b)`, or `f[a, b]`; a cell without arguments is `f[...]`."""
        arguments = tuple(self.term(a) for a in atom.arguments)
        if bracketed and not arguments:
            arguments = (syntax.Ellipsis_(span=NOWHERE),)
        called = name(self.naming.value(kind, atom.name))
        return syntax.Call(called, arguments, bracketed, span=NOWHERE)

    def formula(self, node: Formula) -> syntax.Expression:
        """A condition."""
        match node:
            case Atom():
                return self.call("predicate", node)
            case Equal(left=left, right=right):
                return self._equal(left, right, "==")
            case Not(operand=Equal(left=left, right=right)):
                return self._equal(left, right, "!=")
            case Compare(operator=operator, left=left, right=right):
                sides = self.number(left), self.number(right)
                return syntax.Comparison((operator,), sides, span=NOWHERE)
            case Not(operand=operand):
                return syntax.Unary("not", self.formula(operand), span=NOWHERE)
            case Junction(operator=operator, operands=()):
                return literal(operator == "and")
            case Junction(operands=(operand,)):
                return self.formula(operand)
            case Junction(operator=operator, operands=operands):
                parts = tuple(self.formula(operand) for operand in operands)
                return syntax.Connective(operator, parts, span=NOWHERE)
            case Quantified(variables=(), body=body):
                return self.formula(body)
            case Quantified(quantifier=quantifier, variables=variables, body=body):
                declared, inside = self.declared(variables), self.formula(body)
                return syntax.Quantified(quantifier, declared, None, inside, span=NOWHERE)

    def _equal(self, left: str, right: str, operator: str) -> syntax.Expression:
        """A comparison of objects; what no object can be both of is decided here."""
        if not self.patterns.related(self.types[left], self.types[right]):
            return literal(operator != "==")
        sides = self.term(left), self.term(right)
        return syntax.Comparison(("==" if operator == "==" else "!=",), sides, span=NOWHERE)

    def number(self, node: Number) -> syntax.Expression:
        """A numeric expression."""
        match node:
            case Atom():
                return self.call("function", node)
            case Arithmetic(operator="-", left=0, right=right):
                return syntax.Unary("-", self.number(right), span=NOWHERE)
            case Arithmetic(operator=operator, left=left, right=right):
                sides = self.number(left), self.number(right)
                return syntax.Binary(operator, *sides, span=NOWHERE)
            case int() | float():
                return literal(node)
