"""What HDDL has no form for though PDDL has, seen before anything is emitted."""

from collections.abc import Iterator

from cdlc.backends.errors import NotInFormat
from cdlc.backends.pddl import PddlTask
from cdlc.backends.up import derived
from cdlc.diagnostics import Collector
from crow.program import Location, Parameter
from crow.program.types import is_number, is_object

FORMAT = "HDDL"


def report_unfit(task: PddlTask, found: Collector) -> None:
    """Report derived predicates, numbers that are more than costs, and values as parameters."""
    if task.has_axioms:
        found.add(derived(task, FORMAT))
    for feature in task.sections.domain.features:
        if is_number(feature.type):
            found.add(refused(f"`{feature.name}`, a number,", feature.location))
    for owner, parameter in _values(task):
        construct = f"parameter `{parameter.name}` of `{owner}`, of type `{parameter.type}`,"
        found.add(refused(construct, parameter.location))


def refused(construct: str, location: Location | None, cure: str | None = None) -> NotInFormat:
    """A construct that HDDL has not."""
    return NotInFormat(
        location=location or Location("", 1, 1, 1, 1),
        construct=construct,
        format=FORMAT,
        cure=cure or "the runtime plans with the CDL program itself",
    )


def _values(task: PddlTask) -> Iterator[tuple[str, Parameter]]:
    """The parameters of behaviors that are no objects."""
    for behavior in task.program.behaviors:
        if "'" in behavior.name:
            continue  # the effect of another one alone
        for parameter in behavior.parameters:
            if not is_object(parameter.type):
                yield behavior.name, parameter
