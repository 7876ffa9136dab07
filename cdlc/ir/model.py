"""The Hoare model of a whole program."""

from collections.abc import Iterator

from cdlc.diagnostics import Collector
from cdlc.ir.errors import NoHoareModel
from cdlc.ir.hoare import NotModelled, Triple, triple
from crow.program import Location, Program


def model(program: Program, found: Collector) -> tuple[Triple, ...]:
    """The triples of all behaviors with effects, in source order.

    A behavior without a model is reported to `found` and left out.
    """
    return tuple(_triples(program, found))


def _triples(program: Program, found: Collector) -> Iterator[Triple]:
    for behavior in program.behaviors:
        try:
            modelled = triple(program, behavior)
        except NotModelled as missing:
            location = missing.location or behavior.location or Location("", 1, 1, 1, 1)
            found.add(
                NoHoareModel(location=location, construct=missing.construct, behavior=behavior.name)
            )
        else:
            if modelled is not None:
                yield modelled
