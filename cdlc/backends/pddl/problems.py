"""The text of a PDDL problem: objects, initial state and goal."""

from collections.abc import Iterable, Iterator
from itertools import groupby
from typing import cast

from cdlc.backends.pddl.conditions import typed
from cdlc.backends.pddl.costs import table_facts
from cdlc.backends.pddl.domain import Domain, clauses, sections
from cdlc.backends.pddl.names import Names, legal_name
from cdlc.backends.pddl.numbers import number_text
from cdlc.backends.pddl.sexpr import SExpr, conjuncts, printed
from crow.problem import Cell, Problem, State, World
from crow.program import Feature
from crow.program.types import is_number, is_object
from crow.values import default_value


def problem_text(
    problem: Problem,
    goal: SExpr,
    domain: Domain,
    metric: SExpr | None,
    facts: Iterable[SExpr] = (),
    network: str | None = None,
) -> str:
    """The problem, without its heading; `metric` is what to minimize.

    `facts` hold initially besides those of the program; `network` is a section of text, for
    planners that decompose tasks.
    """
    names = domain.names
    program, world = problem.world.program, problem.world
    constants = {c.name for c in program.constants}
    listed = [(n, t) for n, t in world.objects.items() if n not in constants]
    groups = (list(group) for _, group in groupby(listed, key=lambda item: item[1]))
    lines = [
        " ".join(map(printed, typed([(names.get("object", n), t) for n, t in group], names)))
        for group in groups
    ]
    initial = [printed(fact) for fact in (*initial_facts(problem, domain), *facts)]
    parts = [
        f"(:domain {legal_name(program.name)})",
        "(:objects\n  " + "\n  ".join(lines) + ")" if lines else "(:objects)",
        *([] if network is None else [network]),
        "(:init\n  " + "\n  ".join(initial) + ")" if initial else "(:init)",
        f"(:goal {clauses(conjuncts(goal))})".replace("\n    ", "\n  "),
        *([] if metric is None else [f"(:metric minimize {printed(metric)})"]),
    ]
    return f"(define (problem {legal_name(problem.name)})\n{sections(parts)})\n"


def initial_facts(problem: Problem, domain: Domain) -> Iterator[SExpr]:
    """What holds initially, by feature and by objects in order of declaration.

    Truth values only where true, numbers and objects for every cell.
    """
    world, names = problem.world, domain.names
    order = {name: index for index, name in enumerate(world.objects)}
    true: dict[str, list[tuple[str, ...]]] = {}
    for (name, arguments), value in problem.initial.cells.items():
        if value is True:
            true.setdefault(name, []).append(arguments)
    for feature in domain.features:
        if is_number(feature.type) or is_object(feature.type):
            for where in world.cells(feature):
                if is_object(feature.type) and (feature.name, where) not in problem.initial.cells:
                    continue  # a table without an entry: what is unset has been reported
                yield _fact(feature, where, problem.initial, names)
        else:
            for where in sorted(true.get(feature.name, ()), key=lambda c: [order[a] for a in c]):
                yield _atom(feature, where, names)
    for table in domain.tables:
        for where, cost in table_facts(table, problem, domain.costs):
            yield ("=", (table.name, *(names.get("object", o) for o in where)), str(cost))
    if domain.costs.are_used:
        yield ("=", ("total-cost",), "0")


def _fact(feature: Feature, where: tuple[str, ...], initial: State, names: Names) -> SExpr:
    value = initial.cells.get((feature.name, where), default_value(feature.type))
    atom = _atom(feature, where, names)
    if is_number(feature.type):
        return ("=", atom, number_text(cast("float", value)))
    return (*atom, names.get("object", cast("str", value)))


def _atom(feature: Feature, where: tuple[str, ...], names: Names) -> tuple[SExpr, ...]:
    return (names.get("feature", feature.name), *(names.get("object", a) for a in where))


def unset_cells(world: World, initial: State) -> Iterator[tuple[Feature, list[Cell]]]:
    """Features whose values have to be set, with the cells that are not."""
    for feature in world.program.features:
        if is_object(feature.type):
            cells = [(feature.name, where) for where in world.cells(feature)]
            unset = [cell for cell in cells if cell not in initial.cells]
            if unset:
                yield feature, unset
