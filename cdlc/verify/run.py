"""The checks of a whole program."""

from collections.abc import Callable, Iterator
from importlib.util import find_spec
from typing import TYPE_CHECKING

from cdlc.ir.hoare import Model
from cdlc.ir.updates import NotModelled
from cdlc.verify.errors import SolverMissing
from cdlc.verify.ways import ways_of_triples
from crow.program import Behavior, Program

if TYPE_CHECKING:
    from cdlc.verify.checks import Subject
    from cdlc.verify.results import Check, Report, Verified
    from crow.program.triples import Triple

# Seconds for one check; most take milliseconds.
TIME_LIMIT = 10.0


def require() -> None:
    """Raise SolverMissing if z3 cannot be imported; imports nothing."""
    if find_spec("z3") is None:
        raise SolverMissing


def verify(
    file: str,
    program: Program,
    time_limit: float = TIME_LIMIT,
    started: Callable[[str], None] = lambda _name: None,
) -> "Report":
    """Check every behavior of a program that has an effect.

    `time_limit` is for one check of one triple; `started` hears the name of each behavior.
    Raises SolverMissing.
    """
    require()
    from cdlc.verify.results import Report
    from cdlc.verify.same import same_transitions

    model = Model(program)
    verified: list[Verified] = []
    singles: list[Triple] = []
    for behavior in program.behaviors:
        if behavior.effect is None:
            continue
        started(behavior.name)
        found, triples = _behavior(model, behavior, time_limit)
        verified.append(found)
        if len(triples) == 1:
            singles += triples
    same = same_transitions(model, singles, time_limit)
    return Report(file, tuple(verified), same)


def _behavior(
    model: Model, behavior: Behavior, time_limit: float
) -> "tuple[Verified, tuple[Triple, ...]]":
    from cdlc.verify.checks import Subject, unmodelled
    from cdlc.verify.results import Verified

    try:
        triples = model.triples(behavior)
    except NotModelled as missing:
        return Verified(behavior.name, (unmodelled("model", missing),)), ()
    cases = tuple(zip(triples, ways_of_triples(model.program, behavior, len(triples)), strict=True))
    subject = Subject(model, behavior, cases, time_limit)
    return Verified(behavior.name, tuple(_checks(subject))), triples


def _checks(subject: "Subject") -> "Iterator[Check]":
    from cdlc.verify import checks

    for name, check in (
        ("applicable", checks.check_applicable),
        ("goal", checks.check_goal),
        ("guards", checks.check_guards),
        ("writes", checks.check_writes),
    ):
        try:
            yield from check(subject)
        except NotModelled as missing:
            yield checks.unmodelled(name, missing)
