"""The Hoare model of a whole program, or what keeps it from having one."""

from collections.abc import Iterator

from cdlc.diagnostics import Collector
from cdlc.ir.errors import FormulaTooLarge, NoHoareModel
from cdlc.ir.hoare import Model
from cdlc.ir.text import MAX_WRITTEN, oversized
from cdlc.ir.updates import NotModelled
from crow.program import Behavior, Location
from crow.program.triples import HoareModel, Triple, Unmodelled

NOWHERE = Location("", 1, 1, 1, 1)


def triples(model: Model, found: Collector) -> tuple[Triple, ...]:
    """The triples of all behaviors with effects, in source order.

    A behavior without a model is reported to `found` and left out.
    """
    return tuple(t for b in model.program.behaviors for t in triples_of(model, b, found))


def writable(triples: tuple[Triple, ...], found: Collector) -> bool:
    """Whether all formulas can be written as text; those that cannot are reported to `found`."""
    is_writable = True
    for triple in triples:
        for formula, place in oversized(triple):
            location = place or NOWHERE
            found.add(
                FormulaTooLarge(
                    location=location, formula=formula, behavior=triple.behavior, limit=MAX_WRITTEN
                )
            )
            is_writable = False
    return is_writable


def carried(model: Model) -> HoareModel:
    """The model as compiled programs carry it, with the behaviors that have none."""
    found: list[Triple] = []
    missing: list[Unmodelled] = []
    for behavior in model.program.behaviors:
        try:
            found += model.triples(behavior)
        except NotModelled as error:
            place = error.location or behavior.location
            missing.append(Unmodelled(behavior.name, error.construct, place))
    return HoareModel(str(model.pool.level), tuple(found), tuple(missing))


def triples_of(model: Model, behavior: Behavior, found: Collector) -> Iterator[Triple]:
    """The triples of a behavior; one without a model is reported to `found`."""
    try:
        yield from model.triples(behavior)
    except NotModelled as missing:
        location = missing.location or behavior.location or NOWHERE
        found.add(
            NoHoareModel(location=location, construct=missing.construct, behavior=behavior.name)
        )
