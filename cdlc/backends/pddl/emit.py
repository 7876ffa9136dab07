"""PDDL of a program and a problem, or diagnostics for what is not discrete."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from cdlc.backends.errors import NotInPddl
from cdlc.backends.pddl.actions import Action, actions, normal_forms
from cdlc.backends.pddl.axioms import (
    axioms,
    is_predicate,
    opaque_model,
    opaque_triples,
    used_axioms,
)
from cdlc.backends.pddl.conditions import Lowering, atom, condition
from cdlc.backends.pddl.costs import Costs, charged
from cdlc.backends.pddl.domain import Domain, domain_text
from cdlc.backends.pddl.enumerated import enumerated
from cdlc.backends.pddl.fit import report_unfit, report_unmodelled, report_unset
from cdlc.backends.pddl.methods import MethodStep, method_steps
from cdlc.backends.pddl.names import Names, imported_name
from cdlc.backends.pddl.normal import plain
from cdlc.backends.pddl.numbers import numeric
from cdlc.backends.pddl.problems import problem_text
from cdlc.backends.pddl.sexpr import NEVER, NotPddl, SExpr, TooLarge, words
from cdlc.diagnostics import Collector
from cdlc.ir.hoare import Model
from cdlc.ir.updates import NotModelled
from crow.problem import Problem
from crow.program import Feature, Location, Program
from crow.program.triples import Triple


@dataclass(frozen=True)
class PddlTask:
    """The PDDL of a program, and of a problem if there is one; `actions` lead back to behaviors.

    A hopeless task has a goal that is false in every state, which some readers do not take.
    """

    program: Program
    actions: tuple[Action, ...]
    names: Names
    domain: str
    problem: str | None
    is_hopeless: bool = False
    has_axioms: bool = False

    @cached_property
    def actions_by_name(self) -> dict[str, Action]:
        """Actions by lower-cased PDDL name."""
        return {action.name.lower(): action for action in self.actions}


@dataclass(frozen=True, slots=True)
class Emission:
    """How a program is emitted.

    `axioms` keeps derived functions as `:derived` predicates, `enumerates` makes whole numbers with
    bounds objects; with both, derived functions are unfolded.
    """

    axioms: bool = False
    enumerates: bool = False


def to_pddl(
    model: Model,
    triples: Sequence[Triple],
    problem: Problem | None,
    found: Collector,
    emission: Emission = Emission(),
) -> PddlTask | None:
    """Emit a program and, if given, a problem. None, with diagnostics, for what is not discrete.

    Derived functions become `:derived` predicates also where unfolding them has no end.
    """
    before = found.errors
    report_unfit(model.program, found)
    report_unmodelled(model.program, found)
    if problem is not None:
        report_unset(problem, found)
    if found.errors > before:
        return None
    try:
        return _smallest(model, triples, problem, emission)
    except NotPddl as refused:
        location = refused.location or Location("", 1, 1, 1, 1)
        found.add(NotInPddl(location=location, construct=refused.construct, cure=refused.cure))
        return None


def _smallest(
    model: Model, triples: Sequence[Triple], problem: Problem | None, emission: Emission
) -> PddlTask:
    """The task with its derived functions unfolded, if that has an end and is wanted."""
    if emission.enumerates:
        return _enumerated(model, triples, problem)
    if not any(map(is_predicate, model.program.functions)):
        return _task(model, model, triples, problem)
    if not emission.axioms:
        try:
            return _task(model, model, triples, problem)
        except TooLarge:
            pass
    opaque = opaque_model(model)
    wanted = {triple.behavior for triple in triples}
    behaviors = [b for b in model.program.behaviors if b.name in wanted]
    return _task(opaque, model, tuple(opaque_triples(opaque, model, behaviors)), problem)


def _enumerated(model: Model, triples: Sequence[Triple], problem: Problem | None) -> PddlTask:
    """The task with objects for numbers."""
    all_, steps = _with_methods(model, triples)
    inside, made, stated = enumerated(model, all_, problem)
    return _task_of(inside, inside, made, steps, stated)


def _task(
    model: Model, unfolding: Model, triples: Sequence[Triple], problem: Problem | None
) -> PddlTask:
    """The task in the formulas of a model; `unfolding` is that which unfolds all it can."""
    all_, steps = _with_methods(model, triples)
    return _task_of(model, unfolding, all_, steps, problem)


def _task_of(
    model: Model,
    unfolding: Model,
    all_: Sequence[Triple],
    steps: dict[str, MethodStep],
    problem: Problem | None,
) -> PddlTask:
    """The task of all transitions, `steps` of methods among them."""
    program = unfolding.program
    names = _names(program)
    kept = axioms(model, unfolding, names)
    transitions, costs = charged(unfolding, normal_forms(model, all_), problem)
    made = actions(model, transitions, names, costs, steps)
    if not made:  # nothing to charge for
        costs = Costs()
    renamed = names.changed()
    goal = None if problem is None else _goal(model, problem, names)
    metric = None if problem is None else _metric(model, problem, names, costs)
    others = (goal or (), metric or (), *(a.body for a in kept))
    features = tuple(_features(program, names, made, costs, others))
    formulas = [f for a in made for f in (a.precondition, *a.effects)]
    used = used_axioms(kept, [*others[:2], *formulas])
    domain = Domain(program, names, made, features, costs, used, () if goal is None else (goal,))
    heading = _heading("domain", program.name) + _renamings(renamed) + _scaling(costs)
    text = heading + domain_text(domain)
    if problem is None or goal is None:
        return PddlTask(program, made, names, text, None, has_axioms=bool(used))
    own = _renamings(names.changed()[len(renamed) :])
    stated = _heading("problem", problem.name) + own + problem_text(problem, goal, domain, metric)
    is_hopeless = goal == NEVER
    return PddlTask(program, made, names, text, stated, is_hopeless, has_axioms=bool(used))


def _with_methods(
    model: Model, triples: Sequence[Triple]
) -> tuple[list[Triple], dict[str, MethodStep]]:
    """The triples of behaviors and of the steps of methods, in source order; and those steps."""
    steps: dict[str, MethodStep] = {}
    by_behavior: dict[str, list[Triple]] = {}
    for triple in triples:
        by_behavior.setdefault(triple.behavior, []).append(triple)
    for method in model.program.behaviors:
        if method.effect is None:
            for step in method_steps(model.program, method):
                steps[step.behavior.name] = step
                by_behavior.setdefault(method.name, []).extend(_triples_of(model, step))
    names = [b.name for b in model.program.behaviors]
    return [t for name in names for t in by_behavior.get(name, ())], steps


def _triples_of(model: Model, step: MethodStep) -> tuple[Triple, ...]:
    try:
        return model.triples(step.behavior)
    except NotModelled as refused:
        raise NotPddl(refused.construct, refused.location) from None


def _names(program: Program) -> Names:
    names = Names()
    for type_ in program.types:
        if type_.is_object:
            names.add("type", type_.name, imported_name(type_))
    for feature in program.features:
        names.add("feature", feature.name, imported_name(feature))
    for constant in program.constants:
        names.add("object", constant.name, imported_name(constant))
    return names


def _heading(kind: str, name: str) -> str:
    shown = "".join(c if c.isprintable() else " " for c in name)
    return f'; Emitted by cdlc from the CDL {kind} "{shown}".\n'


def _renamings(renamed: list[tuple[str, str]]) -> str:
    lines = [f";   {name} is {pddl}\n" for name, pddl in renamed]
    return "; Names that PDDL does not take or tell apart:\n" + "".join(lines) if lines else ""


def _features(
    program: Program,
    names: Names,
    made: Sequence[Action],
    costs: Costs,
    others: tuple[SExpr, ...],
) -> Iterator[Feature]:
    """The features that PDDL keeps: not those that only are, or are put into, costs of actions."""
    gone = set(costs.weights)
    tabled = {read.feature for a in made if a.table for read, _ in a.table.cost.terms}
    if tabled:
        formulas = [f for a in made for f in (a.precondition, *a.effects)]
        used = {word for f in (*formulas, *others) for word in words(f)}
        gone |= {name for name in tabled if names.get("feature", name) not in used}
    return (f for f in program.features if f.name not in gone)


def _scaling(costs: Costs) -> str:
    return f"; Costs are multiplied by {costs.scale} to be whole.\n" if costs.scale != 1 else ""


def _metric(model: Model, problem: Problem, names: Names, costs: Costs) -> SExpr | None:
    """What planners are to minimize, if anything."""
    if costs.are_used:
        return ("total-cost",)
    if problem.minimize is None:
        return None
    lowering = Lowering(names, model.pool, {})
    minimize = plain(model.formula(problem.minimize), model.pool)
    try:
        return numeric(minimize, lambda read: atom(read, lowering))
    except NotPddl as refused:
        raise NotPddl(refused.construct, problem.minimize.location, refused.cure) from None


def _goal(model: Model, problem: Problem, names: Names) -> SExpr:
    for name in problem.world.objects:
        names.add("object", name)
    try:
        goal = model.formula(problem.goal)
    except NotModelled as refused:
        raise NotPddl(refused.construct, refused.location) from None
    return condition(plain(goal, model.pool), Lowering(names, model.pool, {}))
