"""The Hoare model of a whole program, or what keeps it from having one."""

from collections.abc import Iterator

from cdlc.diagnostics import Collector
from cdlc.ir.errors import NoHoareModel
from cdlc.ir.hoare import Model, Triple
from cdlc.ir.updates import NotModelled
from crow.program import Location


def triples(model: Model, found: Collector) -> tuple[Triple, ...]:
    """The triples of all behaviors with effects, in source order.

    A behavior without a model is reported to `found` and left out.
    """
    return tuple(_triples(model, found))


def _triples(model: Model, found: Collector) -> Iterator[Triple]:
    for behavior in model.program.behaviors:
        try:
            yield from model.triples(behavior)
        except NotModelled as missing:
            location = missing.location or behavior.location or Location("", 1, 1, 1, 1)
            found.add(
                NoHoareModel(location=location, construct=missing.construct, behavior=behavior.name)
            )
