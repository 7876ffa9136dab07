"""The text of a PDDL domain and problem: deterministic, readable, no larger than a person's."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby

from cdlc.backends.errors import NotInPddl
from cdlc.backends.pddl.actions import Action, actions, parameter_list
from cdlc.backends.pddl.conditions import (
    NEVER,
    Lowering,
    NotPddl,
    SExpr,
    condition,
    type_name,
    typed,
)
from cdlc.backends.pddl.names import Names, legal_name, variable_name
from cdlc.diagnostics import Collector
from cdlc.ir.hoare import Model
from cdlc.ir.updates import NotModelled
from crow.problem import Problem
from crow.program import (
    Behavior,
    Do,
    Feature,
    Location,
    ObjectType,
    Program,
)
from crow.program.triples import Triple
from crow.program.types import is_boolean
from crow.program.walk import statements_within


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

    @cached_property
    def actions_by_name(self) -> dict[str, Action]:
        """Actions by lower-cased PDDL name."""
        return {action.name.lower(): action for action in self.actions}


def to_pddl(
    model: Model, triples: tuple[Triple, ...], problem: Problem | None, found: Collector
) -> PddlTask | None:
    """Emit a program and, if given, a problem. None, with diagnostics, for what is not discrete."""
    program = model.program
    before = len(found.found)
    _report_unfit(program, found)
    if len(found.found) > before:
        return None
    names = Names()
    for type_ in program.types:
        if type_.is_object:
            names.add("type", type_.name)
    for feature in program.features:
        names.add("feature", feature.name)
    for constant in program.constants:
        names.add("object", constant.name)
    try:
        made = actions(model, triples, names)
        renamed = names.changed()
        goal = None if problem is None else _goal(model, problem, names)
    except NotPddl as refused:
        location = refused.location or Location("", 1, 1, 1, 1)
        found.add(NotInPddl(location=location, construct=refused.construct))
        return None
    domain = _renamings(renamed) + _domain(program, made, names, goal)
    domain = _heading("domain", program.name) + domain
    if problem is None or goal is None:
        return PddlTask(program, made, names, domain, None)
    text = _renamings(names.changed()[len(renamed) :]) + _problem(program, problem, goal, names)
    text = _heading("problem", problem.name) + text
    return PddlTask(program, made, names, domain, text, is_hopeless=goal == NEVER)


def _heading(kind: str, name: str) -> str:
    shown = "".join(c if c.isprintable() else " " for c in name)
    return f'; Emitted by cdlc from the CDL {kind} "{shown}".\n'


def _renamings(renamed: list[tuple[str, str]]) -> str:
    lines = [f";   {name} is {pddl}\n" for name, pddl in renamed]
    return "; Names that PDDL does not take or tell apart:\n" + "".join(lines) if lines else ""


def _report_unfit(program: Program, found: Collector) -> None:
    """Report features that are no predicates, and methods whose controllers no action would run."""
    for feature in program.features:
        if not is_boolean(feature.type):
            location = feature.location or Location("", 1, 1, 1, 1)
            construct = f"feature `{feature.name}` of type `{feature.type}`"
            found.add(NotInPddl(location=location, construct=construct))
    for behavior in program.behaviors:
        if behavior.effect is None:
            for call in _calls(behavior):
                location = call.location or Location("", 1, 1, 1, 1)
                construct = f"`{call.controller}` run by `{behavior.name}`, which has no effect,"
                found.add(NotInPddl(location=location, construct=construct))


def _calls(behavior: Behavior) -> Iterator[Do]:
    return (s for s in statements_within(behavior.body) if isinstance(s, Do))


def _goal(model: Model, problem: Problem, names: Names) -> SExpr:
    if problem.minimize is not None:
        raise NotPddl("`minimize`", problem.minimize.location)
    for name in problem.world.objects:
        names.add("object", name)
    try:
        goal = model.formula(problem.goal)
    except NotModelled as refused:
        raise NotPddl(refused.construct, refused.location) from None
    return condition(goal, Lowering(names, {}))


# ------------------------------------------------------------------------------------------ domain


def _domain(program: Program, made: tuple[Action, ...], names: Names, goal: SExpr | None) -> str:
    parts = [
        f"(:requirements {' '.join(_requirements(program, made, goal))})",
        *_types(program, names),
        *_constants(program, names),
        *_predicates(program, names),
        *(_action(action, names) for action in made),
    ]
    return f"(define (domain {legal_name(program.name)})\n{_sections(parts)})\n"


def _sections(parts: list[str]) -> str:
    return "\n".join("  " + part.replace("\n", "\n  ") for part in parts)


def _requirements(program: Program, made: tuple[Action, ...], goal: SExpr | None) -> Iterator[str]:
    """The requirements that are used, in the order of the PDDL manuals."""
    conditions = [a.precondition for a in made] + ([] if goal is None else [goal])
    guards = [guard for a in made for e in a.effects for guard in _guards(e)]
    conditions += guards
    words = {word for c in conditions for word in _words(c)}
    yield ":strips"
    if any(type_.is_object for type_ in program.types):
        yield ":typing"
    if "not" in words:
        yield ":negative-preconditions"
    if "or" in words or any(_negates_compound(c) for c in conditions):
        yield ":disjunctive-preconditions"
    if "=" in words:
        yield ":equality"
    if "exists" in words:
        yield ":existential-preconditions"
    if "forall" in words:
        yield ":universal-preconditions"
    if guards or any(e[0] == "forall" for a in made for e in a.effects):
        yield ":conditional-effects"


def _guards(effect: SExpr) -> Iterator[SExpr]:
    match effect:
        case ("when", guard, _):
            yield guard
        case ("forall", _, inner):
            yield from _guards(inner)
        case _:
            return


def _words(formula: SExpr) -> Iterator[str]:
    if isinstance(formula, tuple) and formula:
        if isinstance(formula[0], str):
            yield formula[0]
        for part in formula[1:]:
            yield from _words(part)


def _negates_compound(formula: SExpr) -> bool:
    match formula:
        case ("not", ("and" | "exists" | "forall", *_)):
            return True
        case tuple():
            return any(_negates_compound(part) for part in formula)
        case _:
            return False


def _types(program: Program, names: Names) -> Iterator[str]:
    """Types with their parents; siblings together, and roots last, as people write them."""
    listed = [(t.name, str(t.base)) for t in program.types if t.is_object]
    if not listed:
        return
    if all(parent == "object" for _, parent in listed):
        yield f"(:types {' '.join(names.get('type', name) for name, _ in listed)})"
        return
    by_parent: dict[str, list[str]] = {}
    for name, parent in listed:
        by_parent.setdefault(parent, []).append(names.get("type", name))
    lines = [
        f"{' '.join(children)} - {type_name(ObjectType(parent), names)}"
        for parent, children in sorted(by_parent.items(), key=lambda item: item[0] == "object")
    ]
    yield "(:types\n  " + "\n  ".join(lines) + ")"


def _constants(program: Program, names: Names) -> Iterator[str]:
    if program.constants:
        listed = [(names.get("object", c.name), c.type) for c in program.constants]
        yield _printed((":constants", *typed(listed, names)))


def _predicates(program: Program, names: Names) -> Iterator[str]:
    lines = [_printed(_predicate(feature, names)) for feature in program.features]
    if lines:
        yield "(:predicates\n  " + "\n  ".join(lines) + ")"


def _predicate(feature: Feature, names: Names) -> SExpr:
    chosen: list[str] = []
    for parameter in feature.parameters:
        chosen.append(variable_name(parameter.name, chosen))
    types = [parameter.type for parameter in feature.parameters]
    declared = [(f"?{name}", type_) for name, type_ in zip(chosen, types, strict=True)]
    return (names.get("feature", feature.name), *typed(declared, names))


def _action(action: Action, names: Names) -> str:
    sources = ", ".join(source.behavior for source in action.sources)
    return "\n".join(
        (
            f"(:action {action.name}  ; {sources}",
            f"  :parameters {_printed(parameter_list(action, names))}",
            f"  :precondition {_clauses(_conjuncts(action.precondition))}",
            f"  :effect {_clauses(action.effects)})",
        )
    )


def _conjuncts(formula: SExpr) -> tuple[SExpr, ...]:
    return formula[1:] if formula[0] == "and" and isinstance(formula, tuple) else (formula,)


def _clauses(parts: tuple[SExpr, ...]) -> str:
    """A conjunction, one clause a line."""
    if not parts:
        return "(and)"
    return "(and\n    " + "\n    ".join(_printed(part) for part in parts) + ")"


def _printed(formula: SExpr) -> str:
    if isinstance(formula, str):
        return formula
    return "(" + " ".join(_printed(part) for part in formula) + ")"


# ----------------------------------------------------------------------------------------- problem


def _problem(program: Program, problem: Problem, goal: SExpr, names: Names) -> str:
    world = problem.world
    constants = {c.name for c in program.constants}
    listed = [(n, t) for n, t in world.objects.items() if n not in constants]
    groups = (list(group) for _, group in groupby(listed, key=lambda item: item[1]))
    lines = [
        " ".join(map(_printed, typed([(names.get("object", n), t) for n, t in group], names)))
        for group in groups
    ]
    facts = [
        _printed((names.get("feature", f), *(names.get("object", a) for a in arguments)))
        for f, arguments in _true_facts(problem)
    ]
    parts = [
        f"(:domain {legal_name(program.name)})",
        "(:objects\n  " + "\n  ".join(lines) + ")" if lines else "(:objects)",
        "(:init\n  " + "\n  ".join(facts) + ")" if facts else "(:init)",
        f"(:goal {_clauses(_conjuncts(goal))})".replace("\n    ", "\n  "),
    ]
    return f"(define (problem {legal_name(problem.name)})\n{_sections(parts)})\n"


def _true_facts(problem: Problem) -> list[tuple[str, tuple[str, ...]]]:
    """The facts that hold initially, by feature and by objects in order of declaration."""
    features = {f.name: index for index, f in enumerate(problem.world.program.features)}
    objects = {name: index for index, name in enumerate(problem.world.objects)}
    true = [cell for cell, value in problem.initial.cells.items() if value is True]
    return sorted(true, key=lambda c: (features[c[0]], [objects[a] for a in c[1]]))
