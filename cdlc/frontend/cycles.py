"""Calls in a circle: functions and behaviors may not call themselves (language.md §5, D.3)."""

from collections.abc import Iterator, Mapping

from crow.program import Apply, Behavior, Call, Expression, Location, Program, Statement
from crow.program.walk import expressions_of, statements_within, subexpressions

from cdlc.diagnostics import Collector
from cdlc.frontend import errors


def report_recursion(program: Program, found: Collector) -> None:
    """Report each circle of calls once, at the definition in it that stands first."""
    functions = {f.name: tuple(_functions_in(f.body or ())) for f in program.functions}
    behaviors = {
        b.name: tuple(_behaviors_in((*b.left, *_members(b), *b.right))) for b in program.behaviors
    }
    places: dict[str, Location | None] = {f.name: f.location for f in program.functions}
    places |= {b.name: b.location for b in program.behaviors}
    for calls in (functions, behaviors):
        for chain in _cycles(calls):
            location = places[chain[0]]
            assert location is not None
            found.add(errors.RecursiveCall(location=location, chain=chain))


def _members(behavior: Behavior) -> tuple[Statement, ...]:
    return () if behavior.promotable is None else behavior.promotable.members


def _functions_in(body: tuple[Statement, ...]) -> Iterator[str]:
    for statement in statements_within(body):
        for expression in expressions_of(statement):
            yield from _applied(expression)


def _applied(expression: Expression) -> Iterator[str]:
    for part in subexpressions(expression):
        if isinstance(part, Apply):
            yield part.function


def _behaviors_in(body: tuple[Statement, ...]) -> Iterator[str]:
    return (s.behavior for s in statements_within(body) if isinstance(s, Call))


def _cycles(calls: Mapping[str, tuple[str, ...]]) -> Iterator[tuple[str, ...]]:
    """The circles in a call graph, each from its first definition back to it."""
    reported: set[str] = set()
    for start in calls:
        chain = _way_back(start, calls)
        if chain is not None and not reported & set(chain):
            reported |= set(chain)
            yield chain


def _way_back(start: str, calls: Mapping[str, tuple[str, ...]]) -> tuple[str, ...] | None:
    """A shortest chain of calls from a definition to itself."""
    chains: dict[str, tuple[str, ...]] = {start: (start,)}
    pending = [start]
    for name in pending:
        for called in calls.get(name, ()):
            if called == start:
                return (*chains[name], start)
            if called not in chains:
                chains[called] = (*chains[name], called)
                pending.append(called)
    return None
