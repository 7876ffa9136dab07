"""Calls in a circle: functions and behaviors may not call themselves (language.md §5, D.3)."""

from collections.abc import Iterable, Iterator, Mapping
from itertools import pairwise

from crow.program import Apply, Behavior, Call, Function, Location, Program
from crow.program.walk import expressions_of, statements_within, subexpressions

from cdlc.diagnostics import Collector
from cdlc.frontend import errors

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
    reported: set[str] = set()
    for start in calls:
        chain = _way_back(start, calls)
        if chain is not None and not reported & set(chain):
            reported |= set(chain)
            yield chain


def _way_back(start: str, calls: Calls) -> tuple[str, ...] | None:
    """A shortest chain of calls from a definition to itself."""
    chains: dict[str, tuple[str, ...]] = {start: (start,)}
    pending = [start]
    for name in pending:
        for called, _ in calls.get(name, ()):
            if called == start:
                return (*chains[name], start)
            if called not in chains:
                chains[called] = (*chains[name], called)
                pending.append(called)
    return None
