"""Parallel writes: iterations of a `foreach` that write different values to one cell (D.3).

Reported as an error where it can be proved, as a warning where only equal values would save it;
everything else, such as a write under a condition on the loop variable, is for the run.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

from cdlc.diagnostics import Collector
from cdlc.frontend import errors
from crow.program import (
    Assign,
    Expression,
    ForEach,
    ForRange,
    If,
    Let,
    Location,
    Parameter,
    SetLocal,
    Statement,
    Variable,
)
from crow.program.walk import statements_within, subexpressions
from crow.text import expression_text


@dataclass(frozen=True, slots=True)
class _Around:
    """What is known at a place: the loop variables, what locals depend on, and the conditions."""

    loops: tuple[tuple[Parameter, Location | None], ...] = ()
    locals: Mapping[str, frozenset[str]] = field(default_factory=dict)
    guards: frozenset[str] = frozenset()

    def dependencies(self, *expressions: Expression) -> frozenset[str]:
        """The loop variables that expressions depend on, through locals too."""
        names = {name for e in expressions for name in _free_names(e)}
        loops = {variable.name for variable, _ in self.loops}
        through = (self.locals[name] for name in names if name in self.locals)
        return frozenset((names & loops) - self.locals.keys()).union(*through)


def check_writes(statements: tuple[Statement, ...], found: Collector) -> None:
    """Report parallel writes in an effect or `init`."""
    for assign, around in _writes(statements, _Around()):
        for variable, loop in around.loops:
            _check(assign, variable, loop, around, found)


def _writes(statements: tuple[Statement, ...], around: _Around) -> Iterator[tuple[Assign, _Around]]:
    for statement in statements:
        match statement:
            case Assign():
                yield statement, around
            case Let(variable=Parameter(name=name), value=value):
                around = _with_local(around, name, around.dependencies(value))
            case SetLocal(variable=name, value=value):
                old = around.locals.get(name, frozenset())
                around = _with_local(around, name, old | around.dependencies(value) | around.guards)
            case ForEach(variables=variables, body=body):
                yield from _writes(body, _inside(around, variables, statement.location))
            case ForRange(variable=variable, body=body):
                inner = _with_local(around, variable.name, frozenset())
                # What one iteration assigns, later ones see.
                yield from _writes(body, _after(body, inner))
                around = _after(body, around)
            case If(condition=condition, then=then, otherwise=otherwise):
                guards = around.guards | around.dependencies(condition)
                for block in (then, otherwise):
                    yield from _writes(block, replace(around, guards=guards))
                around = _after((*then, *otherwise), replace(around, guards=guards), around.guards)
            case _:
                pass


def _inside(
    around: _Around, variables: tuple[Parameter, ...], location: Location | None
) -> _Around:
    names = {v.name for v in variables}
    kept = tuple(loop for loop in around.loops if loop[0].name not in names)
    return _Around(
        (*kept, *((variable, location) for variable in variables)),
        {n: d for n, d in around.locals.items() if n not in names},
        around.guards,
    )


def _with_local(around: _Around, name: str, dependencies: frozenset[str]) -> _Around:
    return replace(around, locals={**around.locals, name: dependencies})


def _after(
    body: tuple[Statement, ...], around: _Around, guards: frozenset[str] | None = None
) -> _Around:
    """What is known after a block that may or may not have run, of the locals it assigns."""
    for statement in statements_within(body):
        if isinstance(statement, SetLocal):
            old = around.locals.get(statement.variable, frozenset())
            new = old | around.dependencies(statement.value) | around.guards
            around = _with_local(around, statement.variable, new)
    return around if guards is None else replace(around, guards=guards)


def _free_names(expression: Expression) -> Iterator[str]:
    # A quantified variable of the same name makes this too many names, which only errs on the
    # side of the run.
    return (part.name for part in subexpressions(expression) if isinstance(part, Variable))


def _check(
    assign: Assign,
    variable: Parameter,
    loop: Location | None,
    around: _Around,
    found: Collector,
) -> None:
    name = variable.name
    if name in around.dependencies(*assign.arguments) or assign.location is None:
        return
    arguments = ", ".join(expression_text(a) for a in assign.arguments) or "..."
    cell = f"{assign.feature}[{arguments}]"
    if assign.operator != "=":
        found.add(
            errors.WriteConflict(
                location=assign.location, cell=cell, variable=name, loop=loop, augments=True
            )
        )
    elif name not in around.dependencies(assign.value) or name in around.guards:
        return
    elif _differs(assign.value, variable, around):
        found.add(
            errors.WriteConflict(
                location=assign.location, cell=cell, variable=name, loop=loop, augments=False
            )
        )
    else:
        found.add(
            errors.PossibleWriteConflict(
                location=assign.location, cell=cell, variable=name, loop=loop
            )
        )


def _differs(value: Expression, variable: Parameter, around: _Around) -> bool:
    """Whether every object in the place of a loop variable gives another value."""
    match value:
        case Variable(name=name):
            return name == variable.name and name not in around.locals
        case _:
            return False
