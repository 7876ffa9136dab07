"""Derived functions as `:derived` predicates, instead of being unfolded where they are read (§2).

A derived predicate is of the state before the transition, so what an effect reads after its own
writes is unfolded all the same.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from cdlc.backends.pddl.conditions import condition, lowering_of, typed
from cdlc.backends.pddl.names import Names, imported_name, variable_name
from cdlc.backends.pddl.normal import plain
from cdlc.backends.pddl.sexpr import SExpr, printed, words
from cdlc.ir.hoare import Model
from cdlc.ir.updates import NotModelled
from crow.program import Annotation, Apply, Behavior, Function, Parameter, Program, Variable
from crow.program.triples import Triple
from crow.program.types import is_boolean, is_object


@dataclass(frozen=True, slots=True)
class Axiom:
    """A derived predicate: its name and parameters, and when it holds."""

    name: str
    parameters: tuple[Parameter, ...]
    body: SExpr

    def head(self, names: Names) -> SExpr:
        """The predicate with its typed parameters."""
        declared = [(f"?{p.name}", p.type) for p in self.parameters]
        return (self.name, *typed(declared, names))

    def text(self, names: Names) -> str:
        """The `:derived` section."""
        return f"(:derived {printed(self.head(names))}\n  {printed(self.body)})"


def is_predicate(function: Function) -> bool:
    """Whether a function can be a derived predicate: derived, Boolean, over objects."""
    has_objects = all(is_object(p.type) for p in function.parameters)
    return function.body is not None and is_boolean(function.type) and has_objects


def kept_predicates(program: Program, *, every: bool) -> frozenset[str]:
    """The derived predicates to keep: every one, or those that were such in PDDL."""
    predicates = (f for f in program.functions if is_predicate(f))
    return frozenset(f.name for f in predicates if every or imported_name(f) is not None)


def opaque_model(model: Model, kept: frozenset[str]) -> Model:
    """The model in which some derived predicates are not unfolded, over the same formulas."""
    functions = tuple(_opaque(f) if f.name in kept else f for f in model.program.functions)
    made = Model(replace(model.program, functions=functions), model.pool.level)
    made.pool = model.pool
    return made


def _opaque(function: Function) -> Function:
    """A function like an external one that reads the state."""
    reads = Annotation("reads", "all")
    return replace(function, body=None, annotations=(*function.annotations, reads))


def opaque_triples(opaque: Model, model: Model, behaviors: Iterable[Behavior]) -> Iterator[Triple]:
    """Triples that keep derived predicates, unfolded only where a behavior reads its own writes."""
    for behavior in behaviors:
        try:
            yield from opaque.triples(behavior)
        except NotModelled:
            yield from model.triples(behavior)


def axioms(model: Model, unfolding: Model, names: Names) -> tuple[Axiom, ...]:
    """The functions of a program that a model keeps as predicates, in order of declaration."""
    pairs = zip(model.program.functions, unfolding.program.functions, strict=True)
    kept = tuple(unfolded for opaque, unfolded in pairs if opaque is not unfolded)
    for function in kept:
        names.add("derived", function.name, imported_name(function))
    return tuple(_axiom(f, kept, unfolding, names) for f in kept)


def _axiom(function: Function, kept: Sequence[Function], model: Model, names: Names) -> Axiom:
    functions = tuple(
        _opaque(f) if f in kept and f is not function else f for f in model.program.functions
    )
    inside = Model(replace(model.program, functions=functions), model.pool.level)
    inside.pool = model.pool
    arguments = tuple(Variable(p.name, p.type) for p in function.parameters)
    formula = inside.formula(Apply(function.name, arguments, function.type))
    chosen: list[str] = []
    for parameter in function.parameters:
        chosen.append(variable_name(parameter.name, chosen))
    own = [p.name for p in function.parameters]
    written = {name: f"?{pddl}" for name, pddl in zip(own, chosen, strict=True)}
    body = condition(plain(formula, model.pool), lowering_of(model, names, written))
    parameters = tuple(
        replace(p, name=pddl) for p, pddl in zip(function.parameters, chosen, strict=True)
    )
    return Axiom(names.get("derived", function.name), parameters, body)


def used_axioms(all_: Sequence[Axiom], formulas: Iterable[SExpr]) -> tuple[Axiom, ...]:
    """The axioms that formulas need, and those these need, in order."""
    used = {word for formula in formulas for word in words(formula)}
    while True:
        needed = [a for a in all_ if a.name in used]
        more = {word for a in needed for word in words(a.body)}
        if more <= used:
            return tuple(needed)
        used |= more
