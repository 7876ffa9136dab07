"""Calls in a circle: functions and behaviors may not call themselves (language.md §5, D.3)."""

from collections.abc import Iterable, Iterator, Mapping
from itertools import pairwise

from cdlc.diagnostics import Collector
from cdlc.frontend import errors
from crow.program import Apply, Behavior, Call, Function, Location, Program
from crow.program.walk import expressions_of, statements_within, subexpressions

Calls = Mapping[str, tuple[tuple[str, Location | None], ...]]
"""What each definition calls, and where."""


def report_recursion(program: Program, found: Collector) -> None:
    """Report each circle of calls once, at the definition in it that stands first."""
    functions = {f.name: tuple(_applications(f)) for f in program.functions}
    behaviors = {b.name: tuple(_calls(b)) for b in program.behaviors}
    _report(functions, program.functions, found)
    _report(behaviors, program.behaviors, found)


def _report(calls: Calls, definitions: Iterable[Function | Behavior], found: Collector) -> None:
    places = {d.name: d.location for d in definitions}
    for chain in _cycles(calls):
        location = places[chain[0]]
        assert location is not None
        pairs = pairwise(chain)
        steps = tuple((caller, called, _place(calls, caller, called)) for caller, called in pairs)
        found.add(errors.RecursiveCall(location=location, chain=chain, steps=steps))


def _place(calls: Calls, caller: str, called: str) -> Location | None:
    return next(place for name, place in calls[caller] if name == called)


def _applications(function: Function) -> Iterator[tuple[str, Location | None]]:
    for statement in statements_within(function.body or ()):
        for expression in expressions_of(statement):
            for part in subexpressions(expression):
                if isinstance(part, Apply):
                    yield part.function, part.location


def _calls(behavior: Behavior) -> Iterator[tuple[str, Location | None]]:
    members = () if behavior.promotable is None else behavior.promotable.members
    for statement in statements_within((*behavior.left, *members, *behavior.right)):
        if isinstance(statement, Call):
            yield statement.behavior, statement.location


def _cycles(calls: Calls) -> Iterator[tuple[str, ...]]:
    """The circles in a call graph, each from its first definition back to it."""
    names = {name: tuple(called for called, _ in targets) for name, targets in calls.items()}
    inner = _peeled(_turned(_peeled(names)))
    reported: set[str] = set()
    for start in calls:
        if start in reported or start not in inner:
            continue
        chain = _way_back(start, names)
        if chain is not None and not reported & set(chain):
            reported |= set(chain)
            yield chain


Graph = Mapping[str, tuple[str, ...]]


def _peeled(graph: Graph) -> Graph:
    """What is left of a graph when all that lead nowhere are taken away, again and again."""
    callers = _turned(graph)
    open_ends = {name: sum(c in graph for c in called) for name, called in graph.items()}
    pending = [name for name, count in open_ends.items() if count == 0]
    for name in pending:
        for caller in callers[name]:
            open_ends[caller] -= 1
            if open_ends[caller] == 0:
                pending.append(caller)
    gone = set(pending)
    return {name: called for name, called in graph.items() if name not in gone}


def _turned(graph: Graph) -> Graph:
    callers: dict[str, list[str]] = {name: [] for name in graph}
    for name, called in graph.items():
        for target in called:
            if target in callers:
                callers[target].append(name)
    return {name: tuple(listed) for name, listed in callers.items()}


def _way_back(start: str, graph: Graph) -> tuple[str, ...] | None:
    """A shortest chain of calls from a definition to itself."""
    came_from: dict[str, str] = {}
    pending = [start]
    for name in pending:
        for called in graph.get(name, ()):
            if called not in came_from:
                came_from[called] = name
                pending.append(called)
            if called == start:
                return (*_chain(start, name, came_from), start)
    return None


def _chain(start: str, end: str, came_from: Mapping[str, str]) -> tuple[str, ...]:
    chain = [end]
    while chain[-1] != start:
        chain.append(came_from[chain[-1]])
    return tuple(reversed(chain))
