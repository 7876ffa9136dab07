"""Controllers whose effect on the world the program does not say."""

from collections.abc import Iterator

from cdlc.diagnostics import Collector
from cdlc.ir.behaviors import body_of, called_by_transitions
from cdlc.ir.errors import UnmodelledController
from cdlc.ir.lints.subject import Subject
from crow.program import Do, Program
from crow.program.walk import statements_within


def unmodelled_controllers(subject: Subject, found: Collector) -> None:
    """Report controllers without `eff` that only methods run.

    Quiet where no controller of the program carries an `eff`: there behaviors say what changes, as
    in Appendix C, or nobody does, as in a purely imperative program.
    """
    if all(c.effect is None for c in subject.program.controllers):
        return
    places = {c.name: c.location for c in subject.program.controllers}
    for call in unmodelled_calls(subject.program):
        if call.location is not None:
            found.add(
                UnmodelledController(
                    location=call.location,
                    controller=call.controller,
                    declared=places[call.controller],
                )
            )


def unmodelled_calls(program: Program) -> Iterator[Do]:
    """The first call of each controller without `eff` that no behavior with an effect runs."""
    modelled = {c.name for c in program.controllers if c.effect is not None}
    called = called_by_transitions(program)
    for behavior in program.behaviors:
        if behavior.effect is not None or behavior.name in called:
            inside = statements_within(body_of(behavior))
            modelled |= {s.controller for s in inside if isinstance(s, Do)}
    for behavior in program.behaviors:
        for statement in statements_within(body_of(behavior)):
            if isinstance(statement, Do) and statement.controller not in modelled:
                modelled.add(statement.controller)
                yield statement
