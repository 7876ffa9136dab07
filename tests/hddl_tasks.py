"""HDDL of CDL texts."""

from typing import NamedTuple

from programs import emitted

from cdlc.backends.hddl import HddlTask, to_hddl
from cdlc.diagnostics import Collector
from crow.problem import Problem


class Stated(NamedTuple):
    """A task with the problem it states."""

    task: HddlTask
    problem: Problem

    @property
    def texts(self) -> tuple[str, str]:
        """The domain and the problem."""
        assert self.task.problem is not None
        return self.task.domain, self.task.problem


def hddl_of(domain: str, problem: str | None = None) -> tuple[HddlTask | None, Collector]:
    """The HDDL of a domain and, if given, of a problem, with what was reported."""
    pddl, found, of = emitted(domain, problem)
    assert pddl is not None, [d.message() for d in found]
    return to_hddl(pddl, of, found), found


def stated(domain: str, problem: str) -> Stated:
    """The HDDL of a domain and a problem, both fit for it."""
    pddl, found, of = emitted(domain, problem)
    assert pddl is not None
    assert of is not None
    task = to_hddl(pddl, of, found)
    assert task is not None, [d.message() for d in found]
    return Stated(task, of)
