"""The text of a PDDL domain: deterministic, readable, no larger than a person's."""

from collections.abc import Iterator
from dataclasses import dataclass

from cdlc.backends.pddl.actions import Action, parameter_list
from cdlc.backends.pddl.axioms import Axiom
from cdlc.backends.pddl.conditions import type_name, typed
from cdlc.backends.pddl.costs import Costs, CostTable
from cdlc.backends.pddl.names import Names, legal_name, variable_name
from cdlc.backends.pddl.sexpr import SExpr, conjuncts, printed, words
from crow.program import Feature, ObjectType, Program
from crow.program.types import is_boolean, is_number, is_object


@dataclass(frozen=True, slots=True)
class Domain:
    """What the text of a domain is made of.

    `features` are those that PDDL keeps; `conditions` those outside of actions that the
    requirements have to cover. `predicates` and `tasks`, sections of text, are further ones, for
    planners that decompose tasks.
    """

    program: Program
    names: Names
    actions: tuple[Action, ...]
    features: tuple[Feature, ...]
    costs: Costs
    axioms: tuple[Axiom, ...] = ()
    conditions: tuple[SExpr, ...] = ()
    predicates: tuple[SExpr, ...] = ()
    tasks: tuple[str, ...] = ()

    @property
    def tables(self) -> tuple[CostTable, ...]:
        """The tables of costs of its actions."""
        return tuple(action.table for action in self.actions if action.table is not None)


def domain_text(domain: Domain) -> str:
    """The domain, without its heading."""
    program, names = domain.program, domain.names
    parts = [
        f"(:requirements {' '.join(_requirements(domain))})",
        *_types(program, names),
        *_constants(program, names),
        *_predicates(domain),
        *_functions(domain),
        *(axiom.text(names) for axiom in domain.axioms),
        *domain.tasks,
        *(_action(action, names) for action in domain.actions),
    ]
    return f"(define (domain {legal_name(program.name)})\n{sections(parts)})\n"


def sections(parts: list[str]) -> str:
    """Sections, indented under a `define`."""
    return "\n".join("  " + part.replace("\n", "\n  ") for part in parts)


def clauses(parts: tuple[SExpr, ...]) -> str:
    """A conjunction, one clause a line."""
    if not parts:
        return "(and)"
    return "(and\n    " + "\n    ".join(printed(part) for part in parts) + ")"


# ------------------------------------------------------------------------------------ requirements


def _requirements(domain: Domain) -> Iterator[str]:
    """The requirements that are used, in the order of the PDDL manuals."""
    made = domain.actions
    guards = [guard for a in made for e in a.effects for guard in _guards(e)]
    bodies = (a.body for a in domain.axioms)
    conditions = [*(a.precondition for a in made), *domain.conditions, *guards, *bodies]
    used = {word for c in conditions for word in words(c)}
    yield ":strips"
    if any(type_.is_object for type_ in domain.program.types):
        yield ":typing"
    if "not" in used:
        yield ":negative-preconditions"
    if "or" in used or any(_negates_compound(c) for c in conditions):
        yield ":disjunctive-preconditions"
    if any(_has_equality(c) for c in conditions):
        yield ":equality"
    if "exists" in used:
        yield ":existential-preconditions"
    if "forall" in used:
        yield ":universal-preconditions"
    if guards or any(e[0] == "forall" for a in made for e in a.effects):
        yield ":conditional-effects"
    if domain.axioms:
        yield ":derived-predicates"
    if _needs_numbers(domain):
        yield ":numeric-fluents"
    if domain.costs.are_used:
        yield ":action-costs"
    if domain.tasks:
        yield ":hierarchy"
    if any(":precondition" in text for text in domain.tasks):
        yield ":method-preconditions"


def _needs_numbers(domain: Domain) -> bool:
    """Whether a function is more than a cost that never changes."""
    numbers = {domain.names.get("feature", f.name) for f in domain.features if is_number(f.type)}
    charges = [e[2] for a in domain.actions for e in a.effects if is_charge(e)]
    return bool(numbers - {charge[0] for charge in charges})


def is_charge(effect: SExpr) -> bool:
    """Whether an effect is the cost of its action."""
    return effect[:2] == ("increase", ("total-cost",))


def _guards(effect: SExpr) -> Iterator[SExpr]:
    match effect:
        case ("when", guard, _):
            yield guard
        case ("forall", _, inner):
            yield from _guards(inner)
        case _:
            return


def _has_equality(formula: SExpr) -> bool:
    """Whether objects are compared; numbers are another requirement's."""
    match formula:
        case ("=", str(left), str(right)):
            return left.startswith("?") or right.startswith("?") or not _is_number(right)
        case tuple():
            return any(_has_equality(part) for part in formula)
        case _:
            return False


def _is_number(text: str) -> bool:
    return text.removeprefix("-")[:1].isdigit()


def _negates_compound(formula: SExpr) -> bool:
    match formula:
        case ("not", ("and" | "exists" | "forall", *_)):
            return True
        case tuple():
            return any(_negates_compound(part) for part in formula)
        case _:
            return False


# ------------------------------------------------------------------------------------ declarations


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
        yield printed((":constants", *typed(listed, names)))


def _predicates(domain: Domain) -> Iterator[str]:
    features = [f for f in domain.features if not is_number(f.type)]
    lines = [printed(_declared(f, domain.names)) for f in features]
    lines += [printed(axiom.head(domain.names)) for axiom in domain.axioms]
    lines += map(printed, domain.predicates)
    if lines:
        yield "(:predicates\n  " + "\n  ".join(lines) + ")"


def _functions(domain: Domain) -> Iterator[str]:
    features = [f for f in domain.features if is_number(f.type)]
    lines = [printed(_declared(f, domain.names)) for f in features]
    lines += [printed(_declared_table(t, domain.names)) for t in domain.tables]
    lines += ["(total-cost)"] * domain.costs.are_used
    if domain.costs.are_used:
        lines[-1] += " - number"
    if lines:
        yield "(:functions\n  " + "\n  ".join(lines) + ")"


def _declared(feature: Feature, names: Names) -> SExpr:
    """A feature with its parameters; an object-valued one has its value as the last of them."""
    parameters = [(p.name, p.type) for p in feature.parameters]
    if is_object(feature.type):
        parameters.append(("value", feature.type))
    assert is_boolean(feature.type) or is_number(feature.type) or is_object(feature.type)
    chosen: list[str] = []
    for name, _ in parameters:
        chosen.append(variable_name(name, chosen))
    declared = [(f"?{n}", type_) for n, (_, type_) in zip(chosen, parameters, strict=True)]
    return (names.get("feature", feature.name), *typed(declared, names))


def _declared_table(table: CostTable, names: Names) -> SExpr:
    chosen: list[str] = []
    for parameter in table.parameters:
        chosen.append(variable_name(parameter.name, chosen))
    types = [p.type for p in table.parameters]
    return (table.name, *typed([(f"?{n}", t) for n, t in zip(chosen, types, strict=True)], names))


def _action(action: Action, names: Names) -> str:
    sources = ", ".join(dict.fromkeys(source.behavior for source in action.sources))
    return "\n".join(
        (
            f"(:action {action.name}  ; {sources}",
            f"  :parameters {printed(parameter_list(action, names))}",
            f"  :precondition {clauses(conjuncts(action.precondition))}",
            f"  :effect {clauses(action.effects)})",
        )
    )
