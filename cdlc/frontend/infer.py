"""The types of untyped parameters of behaviors and generators, from their uses (language.md §4).

Works on syntax and declarations alone, before any body is checked: each use of a parameter where a
type is implied is a demand on it, a call of a behavior passes the demands of its parameters on, and
the most specific type demanded wins if it fits everywhere else.
"""

from collections.abc import Iterable
from dataclasses import replace

from cdlc.diagnostics import Collector
from cdlc.frontend import errors, syntax
from cdlc.frontend.check_declarations import Sourced
from cdlc.frontend.demands import Demands, Names, Slot
from cdlc.frontend.scope import (
    Context,
    Declarations,
    Scope,
    Signature,
)
from cdlc.frontend.uses import Uses
from cdlc.source import SourceFile
from crow.program import UNKNOWN, Type


def infer_signatures(
    definitions: Iterable[Sourced], declared: Declarations, found: Collector
) -> None:
    """Give every untyped parameter of a behavior or generator its type, or report it."""
    untyped = [
        (Context(source, declared, found), node)
        for source, node in definitions
        if isinstance(node, syntax.Procedure) and _is_to_infer(node, source, declared)
    ]
    if not untyped:
        return
    demands = Demands(declared)
    for _, node in untyped:
        demands.open(node)
    for context, node in untyped:
        Uses(demands, context).definition(node)
    demands.close()
    for context, node in untyped:
        _settle(node, demands, context)


def type_from_use(
    name: str, condition: syntax.Expression, scope: Scope, context: Context
) -> Type | None:
    """The type that the uses of a bound variable in its own condition imply; None if none does."""
    demands = Demands(context.declarations)
    slot = Slot(name, 0)
    demands.slots.add(slot)
    names: Names = {n: local.variable.type for n, local in scope.locals.items()}
    Uses(demands, context).condition(condition, {**names, name: slot})
    type_, _ = demands.resolve(slot)
    return type_


def _is_to_infer(node: syntax.Procedure, source: SourceFile, declared: Declarations) -> bool:
    return (
        node.keyword != "controller"
        and any(p.type is None for p in node.parameters)
        and declared.places.get(node.name.text) == source.location(node.name.span)
    )


def _settle(node: syntax.Procedure, demands: Demands, context: Context) -> None:
    """Put the inferred types into the signature of a definition."""
    declared, name = context.declarations, node.name.text
    signature = declared.signature(name)
    assert signature is not None
    parameters = list(signature.parameters)
    for index, written in enumerate(node.parameters):
        if written.type is not None:
            continue
        slot = Slot(name, index)
        type_, candidates = demands.resolve(slot)
        if type_ is None:
            type_ = UNKNOWN
            if candidates or name not in demands.broken:
                location = context.location(written.span)
                context.found.add(
                    errors.UninferableParameter(
                        location=location, name=written.name.text, candidates=candidates
                    )
                )
        parameters[index] = replace(parameters[index], type=type_)
    table = declared.behaviors if name in declared.behaviors else declared.generators
    table[name] = Signature(name, tuple(parameters))
