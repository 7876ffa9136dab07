"""PDDL domains and problems as the syntax tree of CDL files (lowering.md §3)."""

from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from itertools import groupby

from cdlc.frontend import syntax
from cdlc.frontend.pddl.actions import Dynamics, definitions
from cdlc.frontend.pddl.analysis import (
    Pattern,
    bound_variables,
    changed,
    disjunction,
    negated,
    reads,
    renamed,
)
from cdlc.frontend.pddl.context import Context, PddlError
from cdlc.frontend.pddl.effects import EffectsConflictError
from cdlc.frontend.pddl.naming import NOWHERE, Naming, annotations
from cdlc.frontend.pddl.nodes import (
    TRUE,
    Arithmetic,
    Derived,
    Domain,
    Formula,
    Number,
    Problem,
    Schema,
)
from cdlc.frontend.pddl.trees import Trees, literal, name, primitive

COST = "total-cost"


class Translation:
    """One domain and perhaps a problem of it, which share their names.

    What the problem wants to be false decides which deletes are worth a behavior.
    """

    def __init__(self, domain: Domain, problem: Problem | None, context: Context) -> None:
        self.domain = domain
        self.problem = problem
        self.context = context
        self.naming = Naming()
        objects = [*domain.constants, *(() if problem is None else problem.objects)]
        self.trees = Trees(self.naming, domain.types, types={o.name: o.type for o in objects})
        self.floats = _floats(domain, problem)
        self.derived = {d.name for d in domain.derived}
        added, deleted = _written(domain, self.trees)
        self.dynamics = Dynamics(
            frozenset(changed(domain)), added, deleted, frozenset(negated(domain, problem))
        )

    # ------------------------------------------------------------------------------------ domain

    def domain_module(self) -> syntax.Module | None:
        """The domain's file; None, with a diagnostic, for what CDL has no form for."""
        try:
            return syntax.Module(tuple(self._definitions()), span=NOWHERE)
        except PddlError:
            return None

    def _definitions(self) -> Iterator[syntax.Definition]:
        domain, naming = self.domain, self.naming
        self._refuse()
        # Names are given in this order: what is written most keeps its own.
        for kind, named in (
            ("predicate", domain.predicates),
            ("function", domain.functions),
            ("action", domain.actions),
            ("object", domain.constants),
        ):
            for each in named:
                naming.value(kind, each.name)
        yield syntax.Title("domain", domain.name, span=NOWHERE)
        yield from self._types()
        yield from self._constants()
        for predicate in domain.predicates:
            if predicate.name not in self.derived:
                yield self._feature("predicate", predicate, None)
        for function in domain.functions:
            type_ = primitive("float64" if function.name in self.floats else "int64")
            yield self._feature("function", function, type_)
        yield from self._functions()
        for action in domain.actions:
            try:
                yield from definitions(action, self.trees, self.dynamics)
            except EffectsConflictError:
                construct = f"the effect of `{action.name}`"
                reason = "its quantified parts change what conditions of the others read"
                raise self.context.unsupported(action.span, construct, reason) from None

    def _refuse(self) -> None:
        """Refuse what reading alone does not show."""
        for action in self.domain.actions:
            for effect in action.effects:
                if effect.cell.name == COST and (effect.condition != TRUE or effect.variables):
                    construct = "a cost that depends on a condition"
                    reason = "planners take costs that are the same in every state"
                    raise self.context.unsupported(effect.span, construct, reason)
        graph: dict[str, set[str]] = {d.name: set() for d in self.domain.derived}
        for definition in self.domain.derived:
            graph[definition.name] |= reads(definition.body) & self.derived
        try:
            TopologicalSorter(graph).prepare()
        except CycleError as error:
            cycle = [str(part) for part in error.args[1]]
            first = next(d for d in self.domain.derived if d.name in cycle)
            construct = f"the recursive definition of `{first.name}`"
            reason = f"it is defined by itself: {' → '.join(cycle)}"
            raise self.context.unsupported(first.span, construct, reason) from None

    def _types(self) -> Iterator[syntax.Definition]:
        for type_, parent in self.domain.types.items():
            called = self.naming.type(type_)
            base = None if parent == "object" else self.trees.type(parent)
            pddl = annotations(type_, called)
            yield syntax.TypeDefinition(name(called), base, annotations=pddl, span=NOWHERE)

    def _constants(self) -> Iterator[syntax.Definition]:
        for constant in self.domain.constants:
            called = self.naming.value("object", constant.name)
            pddl = annotations(constant.name, called)
            type_ = self.trees.type(constant.type)
            yield syntax.ObjectConstant((name(called),), type_, annotations=pddl, span=NOWHERE)

    def _feature(self, kind: str, schema: Schema, type_: syntax.Type | None) -> syntax.Definition:
        called = self.naming.value(kind, schema.name)
        pddl = annotations(schema.name, called)
        keys: list[str] = []
        for position, parameter in enumerate(schema.parameters, 1):
            is_taken = parameter.name in keys
            keys.append(f"{parameter.name}_{position}" if is_taken else parameter.name)
        names = self.naming.variables(keys)
        parameters = tuple(
            syntax.TypedName(name(names[key]), self.trees.type(p.type), span=NOWHERE)
            for key, p in zip(keys, schema.parameters, strict=True)
        )
        return syntax.Feature(name(called), parameters, type_, annotations=pddl, span=NOWHERE)

    def _functions(self) -> Iterator[syntax.Definition]:
        """A `def` for each derived predicate: it holds where any of its definitions does."""
        grouped: dict[str, list[Derived]] = {}
        for definition in self.domain.derived:
            grouped.setdefault(definition.name, []).append(definition)
        for heads in grouped.values():
            head = heads[0]
            body = disjunction(_with_parameters_of(head, other) for other in heads)
            typed = [*head.parameters, *bound_variables(body)]
            names = self.naming.variables(dict.fromkeys(t.name for t in typed))
            trees = self.trees.inside(names, typed)
            called = self.naming.value("predicate", head.name)
            yield syntax.Function(
                name(called),
                trees.declared(head.parameters),
                primitive("bool"),
                (syntax.Return(trees.formula(body), span=NOWHERE),),
                # Says that it was derived in PDDL, so that it is so again.
                annotations=annotations(head.name, called, always=True),
                span=NOWHERE,
            )

    # ----------------------------------------------------------------------------------- problem

    def problem_module(self, domain_file: str) -> syntax.Module:
        """The problem's file; to be asked for after the domain's, which claims names first."""
        problem = self.problem
        assert problem is not None
        bound = list(bound_variables(problem.goal))
        names = self.naming.variables(dict.fromkeys(t.name for t in bound))
        trees = self.trees.inside(names, bound)
        parts: list[syntax.Definition] = [
            syntax.Title("problem", problem.name, span=NOWHERE),
            syntax.Title("domain", domain_file, span=NOWHERE),
        ]
        lines = tuple(self._objects(problem))
        if lines:
            parts.append(syntax.Objects(lines, span=NOWHERE))
        statements = tuple(_facts(problem, trees)) or (syntax.Word("pass", span=NOWHERE),)
        parts.append(syntax.Init(statements, span=NOWHERE))
        parts.append(syntax.Goal(trees.formula(problem.goal), None, span=NOWHERE))
        if problem.minimize is not None:
            parts.append(syntax.Minimize(trees.number(problem.minimize), span=NOWHERE))
        return syntax.Module(tuple(parts), span=NOWHERE)

    def _objects(self, problem: Problem) -> Iterator[syntax.ObjectsLine]:
        for type_, objects in groupby(problem.objects, key=lambda o: o.type):
            called = tuple(name(self.naming.value("object", o.name)) for o in objects)
            yield syntax.ObjectsLine(called, self.trees.type(type_), span=NOWHERE)


def _written(domain: Domain, trees: Trees) -> tuple[frozenset[Pattern], frozenset[Pattern]]:
    """What actions make true and false; what a definition reads may change it either way."""
    changing = changed(domain)
    derived = {d.name: d for d in domain.derived if d.name in changing}
    both = {(d.name, tuple((None, p.type) for p in d.parameters)) for d in derived.values()}
    added: set[Pattern] = {*both}
    deleted: set[Pattern] = {*both}
    for action in domain.actions:
        for effect in action.effects:
            patterns = trees.inside({}, (*action.parameters, *effect.variables)).patterns
            (deleted if effect.value is False else added).add(patterns.of(effect.cell))
    return frozenset(added), frozenset(deleted)


def _facts(problem: Problem, trees: Trees) -> Iterator[syntax.Statement]:
    for fact in problem.facts:
        target = trees.call("predicate", fact, bracketed=True)
        yield syntax.Assignment(target, "=", literal(value=True), span=NOWHERE)
    for cell, value in problem.numbers:
        target = trees.call("function", cell, bracketed=True)
        yield syntax.Assignment(target, "=", literal(value), span=NOWHERE)


def _with_parameters_of(first: Derived, other: Derived) -> Formula:
    """The body of another definition, over the parameters of the first."""
    pairs = zip(other.parameters, first.parameters, strict=True)
    return renamed(other.body, {own.name: shared.name for own, shared in pairs})


def _floats(domain: Domain, problem: Problem | None) -> set[str]:
    """Functions whose values are not all integers."""
    found = {
        c.name for c, v in (() if problem is None else problem.numbers) if isinstance(v, float)
    }
    changes = [
        (e.cell.name, e.operator, e.value)
        for action in domain.actions
        for e in action.effects
        if not isinstance(e.value, bool)
    ]
    while True:
        more = {f for f, op, v in changes if op == "/=" or _is_float(v, found)} - found
        if not more:
            return found
        found |= more


def _is_float(value: Number, floats: set[str]) -> bool:
    match value:
        case Arithmetic(operator="/"):
            return True
        case Arithmetic(left=left, right=right):
            return _is_float(left, floats) or _is_float(right, floats)
        case int():
            return False
        case float():
            return True
        case _:
            return value.name in floats
