"""PDDL of a program and a problem, or diagnostics for what is not discrete."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from cdlc.backends.errors import NotInPddl
from cdlc.backends.pddl.actions import Action, actions, normal_forms
from cdlc.backends.pddl.axioms import (
    axioms,
    kept_predicates,
    opaque_model,
    opaque_triples,
    used_axioms,
)
from cdlc.backends.pddl.conditions import atom, condition, lowering_of
from cdlc.backends.pddl.costs import Costs, charged
from cdlc.backends.pddl.domain import Domain, domain_text
from cdlc.backends.pddl.enumerated import enumerated
from cdlc.backends.pddl.fit import report_split, report_unfit, report_unmodelled, report_unset
from cdlc.backends.pddl.names import Names, imported_name
from cdlc.backends.pddl.normal import plain
from cdlc.backends.pddl.numbers import numeric
from cdlc.backends.pddl.parts import Part, closing, parts_of, with_parts
from cdlc.backends.pddl.problems import problem_text
from cdlc.backends.pddl.sexpr import NEVER, NotPddl, SExpr, TooLarge, words
from cdlc.diagnostics import Collector
from cdlc.ir.hoare import Model
from cdlc.ir.model import triples_of
from cdlc.ir.updates import NotModelled
from crow.problem import Problem
from crow.program import Feature, Location, Program
from crow.program.triples import Triple


@dataclass(frozen=True, slots=True)
class Sections:
    """What the texts of a task are made of; `goal` and `metric` are those of the problem."""

    model: Model
    domain: Domain
    heading: str
    goal: SExpr | None
    metric: SExpr | None
    problem_heading: str = ""


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
    sections: Sections
    is_hopeless: bool = False
    has_axioms: bool = False

    @cached_property
    def actions_by_name(self) -> dict[str, Action]:
        """Actions by lower-cased PDDL name."""
        return {action.name.lower(): action for action in self.actions}

    @property
    def unseen_methods(self) -> tuple[str, ...]:
        """The methods that are no action: what they run changes nothing by itself."""
        seen = {source.behavior for action in self.actions for source in action.sources}
        methods = (b.name for b in self.program.behaviors if b.effect is None)
        return tuple(name for name in methods if name not in seen)


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
        parts = _parts(model.program, found)
        program = with_parts(model.program, parts)
        inside = model if program is model.program else Model(program, model.pool.level)
        transitions = _transitions(inside, parts, found)
        if found.errors > before:
            return None
        stated = None if problem is None else closing(problem, program, parts)
        return _smallest(inside, transitions, stated, emission)
    except NotPddl as refused:
        location = refused.location or Location("", 1, 1, 1, 1)
        found.add(NotInPddl(location=location, construct=refused.construct, cure=refused.cure))
        return None


def _parts(program: Program, found: Collector) -> tuple[Part, ...]:
    """The parts of all behaviors in source order; those that are split are reported."""
    parts: list[Part] = []
    for behavior in program.behaviors:
        own = parts_of(program, behavior)
        report_split(behavior, own, found)
        parts += own
    return tuple(parts)


@dataclass(frozen=True, slots=True)
class _Transition:
    part: Part
    triples: tuple[Triple, ...]


def _transitions(model: Model, parts: Sequence[Part], found: Collector) -> tuple[_Transition, ...]:
    """The parts with their triples; one without is reported."""
    return tuple(
        _Transition(part, tuple(triples_of(model, part.behavior, found))) for part in parts
    )


def _smallest(
    model: Model,
    transitions: Sequence[_Transition],
    problem: Problem | None,
    emission: Emission,
) -> PddlTask:
    """The task with its derived functions unfolded, if that has an end and is wanted; those that
    were derived predicates in PDDL are so again.
    """
    steps = {t.part.name: t.part for t in transitions}
    triples = [triple for t in transitions for triple in t.triples]
    if emission.enumerates:
        inside, made, stated = enumerated(model, triples, problem)
        return _task(inside, inside, made, steps, stated)
    every = kept_predicates(model.program, every=True)
    kept = every if emission.axioms else kept_predicates(model.program, every=False)
    while True:
        opaque = opaque_model(model, kept) if kept else model
        behaviors = [t.part.behavior for t in transitions]
        some = tuple(opaque_triples(opaque, model, behaviors)) if kept else triples
        try:
            return _task(opaque, model, some, steps, problem)
        except TooLarge:
            if kept == every:
                raise
            kept = every


def _task(
    model: Model,
    unfolding: Model,
    all_: Sequence[Triple],
    steps: dict[str, Part],
    problem: Problem | None,
) -> PddlTask:
    """The task of all transitions in the formulas of a model; `unfolding` is that which unfolds all
    it can.
    """
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
        made_of = Sections(model, domain, heading, None, None)
        return PddlTask(program, made, names, text, None, made_of, has_axioms=bool(used))
    own = _heading("problem", problem.name) + _renamings(names.changed()[len(renamed) :])
    made_of = Sections(model, domain, heading, goal, metric, own)
    stated = own + problem_text(problem, goal, domain, metric)
    return PddlTask(program, made, names, text, stated, made_of, goal == NEVER, bool(used))


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
    lowering = lowering_of(model, names, {})
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
    return condition(plain(goal, model.pool), lowering_of(model, names, {}))
