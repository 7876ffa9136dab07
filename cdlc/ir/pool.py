"""Hash-consed expressions: equal ones are one object, so formulas are graphs, not trees.

`for i in range(30): if f[x] > i: f[x] -= 1` has a formula whose tree has 2**30 leaves and whose
graph has a hundred nodes. Everything that builds formulas goes through a Pool; its constructors
also simplify, as far as its level says. Pooled expressions are compared with `is`: comparing or
hashing their structure would unfold the graph.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any

from cdlc.ir.formulas import Formulas
from cdlc.ir.graph import in_order
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


class Pool(Formulas):
    """The expressions of one model, each once: with quantifiers, and rebuilt from others."""

    # --------------------------------------------------------------------------------- quantifiers

    def quantified(
        self, quantifier: Any, variables: tuple[Expression, ...], body: Expression
    ) -> Expression:
        """`forall` or `exists` over fresh variables, which are renamed by how deep they stand.

        So formulas that differ only in the names of bound variables are one.
        """
        if not variables:
            return body
        used = self.free_variables(body)
        bound = [v for v in variables if isinstance(v, Variable) and v.name in used]
        if not bound or body is self.true or body is self.false:
            # `forall x: c` is true where there is no x at all; only then does it matter.
            if body is (self.true if quantifier == "forall" else self.false):
                return body
            bound = [v for v in variables if isinstance(v, Variable)]
        height = self._heights[id(body)] + 1
        named = [replace_name(v, f"_{height}_{i}") for i, v in enumerate(bound)]
        renaming = {
            old.name: self.variable(new.name, new.type)
            for old, new in zip(bound, named, strict=True)
        }
        renamed = self.substitute(body, renaming)
        parameters = tuple(Parameter(v.name, v.type) for v in named)
        key = (quantifier, *((p.name, p.type) for p in parameters), id(renamed))
        return self._intern(key, lambda: Quantified(quantifier, parameters, renamed))

    # --------------------------------------------------------------------------------- rebuilding

    def substitute(self, node: Expression, values: Mapping[str, Expression]) -> Expression:
        """A pooled expression with free variables replaced, and none captured by a quantifier."""
        if self._free[id(node)].isdisjoint(values):
            return node
        return self.rebuild(node, values)

    def rebuild(
        self,
        node: Expression,
        values: Mapping[str, Expression],
        rule: Callable[[Expression], Expression] | None = None,
    ) -> Expression:
        """The expression built anew, innermost first, each shared part once.

        Free variables are replaced by `values`; `rule` says what stands for each node. An
        expression from outside comes into the pool in this way, too.
        """
        done: dict[int, Expression] = {}
        for part in in_order(node, into_quantifiers=False):
            match part:
                case Variable(name=name) if name in values:
                    made = values[name]
                case Quantified():
                    made = self._rebuild_quantified(part, values, rule)
                case _:
                    made = self.again(part, done)
                    made = made if rule is None else rule(made)
            done[id(part)] = made
        return done[id(node)]

    def given(self, node: Expression, facts: Iterable[Expression]) -> Expression:
        """The expression where some conditions are known to hold: they are true in it."""
        known: dict[int, Expression] = {}
        for fact in facts:
            plain, value = (
                (fact.operand, self.false) if isinstance(fact, Not) else (fact, self.true)
            )
            if isinstance(plain, Constant):
                continue
            known[id(plain)] = value
            if isinstance(plain, Compare) and plain.operator == "==":
                known[id(self.equal(plain.right, plain.left))] = value
        return self.rebuild(node, {}, lambda part: known.get(id(part), part))

    def _rebuild_quantified(
        self,
        node: Quantified,
        values: Mapping[str, Expression],
        rule: Callable[[Expression], Expression] | None,
    ) -> Expression:
        if rule is None and id(node) in self._free:
            free = self._free[id(node)]
            if free.isdisjoint(values):
                return node
            used = [values[name] for name in free if name in values]
            if not any(self._heights[id(value)] for value in used):
                return self._substituted_inside(node, values)
        opened = tuple(self.fresh(v) for v in node.variables)
        names = {v.name: o for v, o in zip(node.variables, opened, strict=True)}
        body = self.rebuild(node.body, {**values, **names}, rule)
        made = self.quantified(node.quantifier, opened, body)
        return made if rule is None else rule(made)

    def _substituted_inside(self, node: Quantified, values: Mapping[str, Expression]) -> Expression:
        """A quantifier over a changed body, its own variables as they were.

        Values without quantifiers leave how deep it stands, and so its variables' names, alone; and
        those names are free in no value.
        """
        bound = {v.name for v in node.variables}
        inner = {name: value for name, value in values.items() if name not in bound}
        body = self.rebuild(node.body, inner)
        if body is self.true or body is self.false or not bound <= self._free[id(body)]:
            opened = tuple(self.variable(v.name, v.type) for v in node.variables)
            return self.quantified(node.quantifier, opened, body)
        key = (node.quantifier, *((p.name, p.type) for p in node.variables), id(body))
        return self._intern(key, lambda: Quantified(node.quantifier, node.variables, body))

    def again(self, node: Expression, done: Mapping[int, Expression]) -> Expression:
        """An expression but for quantifiers, from what stands for its parts."""

        def new(part: Expression) -> Expression:
            return done[id(part)]

        match node:
            case Constant(value=value, type=type_):
                return self.constant(value, type_, node.location)
            case Variable(name=name, type=type_):
                return self.variable(name, type_)
            case Object(name=name, type=type_):
                return self.named_object(name, type_)
            case Read(feature=name, arguments=arguments, type=type_):
                return self.read(name, tuple(map(new, arguments)), type_, node.location)
            case Apply(function=name, arguments=arguments, type=type_):
                return self.apply(name, tuple(map(new, arguments)), type_, node.location)
            case Builtin(function=name, arguments=arguments, type=type_):
                return self.builtin(name, tuple(map(new, arguments)), type_)
            case Vector(elements=elements, type=type_):
                return self.vector(tuple(map(new, elements)), type_)
            case Not(operand=operand):
                return self.negation(new(operand))
            case And(operands=operands):
                return self.conjunction(map(new, operands))
            case Or(operands=operands):
                return self.disjunction(map(new, operands))
            case Xor(left=left, right=right):
                return self.exclusive(new(left), new(right))
            case Compare(operator=op, left=left, right=right):
                return self.compare(op, new(left), new(right))
            case Negative(operand=operand, type=type_):
                return self.negative(new(operand), type_)
            case Arithmetic(operator=op, left=left, right=right, type=type_):
                return self.arithmetic(op, new(left), new(right), type_, node.location)
            case Conditional(condition=condition, then=then, otherwise=otherwise):
                return self.choice(new(condition), new(then), new(otherwise))
            case Quantified():
                raise AssertionError("quantifiers are opened before their bodies are rebuilt")


def replace_name(variable: Variable, name: str) -> Variable:
    """The variable under another name."""
    return replace(variable, name=name)
