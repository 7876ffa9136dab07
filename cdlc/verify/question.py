"""Questions about one triple: is there a state in which these conditions hold together?

What is asked is more than the interpreter may do, never less: every run of the behavior that ends
without an error satisfies all of the conditions. So `no` is a proof; `yes` is tried out.
"""

from dataclasses import dataclass
from functools import cached_property

from cdlc.ir.graph import in_order
from cdlc.ir.hoare import Model
from crow.program import (
    Apply,
    Constant,
    Expression,
    Object,
    ObjectType,
    Parameter,
    Quantified,
    Read,
    Type,
    Variable,
    Vector,
    VectorType,
)
from crow.program.triples import Triple
from crow.program.types import is_integer, is_number, is_object, underlying


@dataclass(frozen=True)
class Question:
    """The conditions `pre` and `claims` of a triple, over the state before.

    `ends` says that the effect comes to its end without an error. `hints` are conditions that
    counterexamples are looked for with; they are no part of a proof.
    """

    model: Model
    triple: Triple
    claims: tuple[Expression, ...] = ()
    ends: bool = True
    hints: tuple[Expression, ...] = ()

    @cached_property
    def variables(self) -> tuple[Parameter, ...]:
        """The triple's variables, and others that the claims are about."""
        known = {p.name: p for p in self.triple.parameters}
        free = self.model.pool.free_variables
        for claim in (*self.claims, *self.hints):
            missing = free(claim) - known.keys()
            for node in in_order(claim) if missing else ():
                if isinstance(node, Variable) and node.name in missing:
                    known.setdefault(node.name, Parameter(node.name, node.type))
        return tuple(known.values())

    @cached_property
    def formulas(self) -> tuple[Expression, ...]:
        """Every formula of the question."""
        updates = self.triple.post if self.ends else ()
        written = (e for u in updates for e in (*u.arguments, u.guard, u.value, *u.variables))
        return (*self.triple.pre, *self.claims, *self.hints, *written)

    @cached_property
    def kinds(self) -> tuple[str, ...]:
        """The object types that make a difference, in order of declaration."""
        program = self.model.program
        features = {f.name: f for f in program.features}
        functions = {f.name: f for f in program.functions}
        found: set[Type] = {p.type for p in self.variables}
        for node in in_order(*self.formulas):
            match node:
                case Quantified(variables=variables):
                    found |= {v.type for v in variables}
                case Read(feature=name):
                    found |= {features[name].type, *(p.type for p in features[name].parameters)}
                case Apply(function=name):
                    function = functions[name]
                    found |= {function.type, *(p.type for p in function.parameters)}
                case Object(type=type_) | Variable(type=type_):
                    found.add(type_)
                case _:
                    pass
        found |= set(self.constants.values())
        names = {str(t) for t in map(underlying, found) if isinstance(t, ObjectType)}
        declared = [t.name for t in program.types if t.is_object]
        return tuple(n for n in (*declared, "object") if n in names)

    @cached_property
    def constants(self) -> dict[str, Type]:
        """Objects that every world has, and those that formulas name."""
        found: dict[str, Type] = {c.name: c.type for c in self.model.program.constants}
        for node in in_order(*self.formulas):
            if isinstance(node, Object):
                found.setdefault(node.name, node.type)
        return found

    @cached_property
    def has_floats(self) -> bool:
        """Whether any formula computes with floats."""
        return any(
            _is_float(node.type) and not isinstance(node, Constant | Vector)
            for node in in_order(*self.formulas)
        )

    @property
    def enough_objects(self) -> int:
        """How many objects a counterexample is looked for with, at the most."""
        variables = sum(is_object(v.type) for v in self.variables)
        return min(MOST_OBJECTS, max(LEAST_OBJECTS, variables + 1))


LEAST_OBJECTS = 3
MOST_OBJECTS = 6


def _is_float(type_: Type) -> bool:
    """Whether a type is a float, or a vector of them."""
    plain = underlying(type_)
    if isinstance(plain, VectorType):
        return _is_float(plain.element)
    return is_number(plain) and not is_integer(plain)
