"""Write the `foreach` of bodies out for given objects (App. A)."""

from collections.abc import Iterable, Mapping
from dataclasses import fields, replace
from itertools import product
from typing import Any

from crow.program import (
    Behavior,
    Bind,
    Expression,
    ForEach,
    ForRange,
    Group,
    Hierarchy,
    Let,
    Object,
    Parameter,
    Program,
    Statement,
)
from crow.program.rewrite import substitute


def expand_foreach(program: Program, objects: Iterable[Parameter] = ()) -> Program:
    """The program with each `foreach` of a body as an unordered group, a sequence an object.

    `objects` are those of a problem; the program's constants come before them. Effects are left
    alone: there a `foreach` is parallel. Before and after, with the objects `a` and `b`:

        foreach o: T:            unordered:
          achieve f(o)             sequential:
                                     achieve f(a)
                                   sequential:
                                     achieve f(b)
    """
    constants = (Object(c.name, c.type) for c in program.constants)
    expander = _Expander(
        (*constants, *(Object(o.name, o.type) for o in objects)), Hierarchy.of(program.types)
    )
    return replace(program, behaviors=tuple(map(expander.behavior, program.behaviors)))


class _Expander:
    def __init__(self, objects: tuple[Object, ...], hierarchy: Hierarchy) -> None:
        self.objects = objects
        self.hierarchy = hierarchy

    def behavior(self, behavior: Behavior) -> Behavior:
        promotable = behavior.promotable
        if promotable is not None:
            promotable = replace(promotable, members=self.block(promotable.members))
        return replace(
            behavior,
            left=self.block(behavior.left),
            promotable=promotable,
            right=self.block(behavior.right),
        )

    def block(self, statements: tuple[Statement, ...]) -> tuple[Statement, ...]:
        return tuple(map(self.statement, statements))

    def statement(self, node: Statement) -> Statement:
        if isinstance(node, ForEach):
            return self.group(node)
        blocks: dict[str, Any] = {
            name: self.block(getattr(node, name))
            for name in ("body", "then", "otherwise")
            if hasattr(node, name)
        }
        return replace(node, **blocks) if blocks else node

    def group(self, node: ForEach) -> Group:
        domains = [
            [o for o in self.objects if self.hierarchy.is_subtype(o.type, variable.type)]
            for variable in node.variables
        ]
        names = [variable.name for variable in node.variables]
        iterations = tuple(
            Group(
                "sequential",
                self.block(substitute_all(node.body, dict(zip(names, chosen, strict=True)))),
                location=node.location,
            )
            for chosen in product(*domains)
        )
        return Group("unordered", iterations, annotations=node.annotations, location=node.location)


def substitute_all(
    statements: tuple[Statement, ...], values: Mapping[str, Expression]
) -> tuple[Statement, ...]:
    """Statements with variables replaced by closed expressions; new variables hide outer ones."""
    done: list[Statement] = []
    for statement in statements:
        hidden = {variable.name for variable in _introduced(statement)}
        inner = {name: value for name, value in values.items() if name not in hidden}
        done.append(_substituted(statement, values, inner))
        if isinstance(statement, Let | Bind):
            values = inner
    return tuple(done)


def _introduced(statement: Statement) -> tuple[Parameter, ...]:
    match statement:
        case Bind(variables=variables) | ForEach(variables=variables):
            return variables
        case Let(variable=variable) | ForRange(variable=variable):
            return (variable,)
        case _:
            return ()


def _substituted(
    statement: Statement, outer: Mapping[str, Expression], inner: Mapping[str, Expression]
) -> Statement:
    """One statement; the value of a `let` is the only part that does not see its variable."""
    values = outer if isinstance(statement, Let) else inner
    changed: dict[str, Any] = {}
    cls: Any = type(statement)
    for field in fields(cls):
        if field.name in ("location", "annotations"):
            continue
        value = getattr(statement, field.name)
        if isinstance(value, Expression):
            changed[field.name] = substitute(value, values)
        elif isinstance(value, tuple) and value and isinstance(value[0], Statement):
            changed[field.name] = substitute_all(value, values)
        elif isinstance(value, tuple) and value and isinstance(value[0], Expression):
            changed[field.name] = tuple(substitute(item, values) for item in value)
    return replace(statement, **changed)
