"""Public PDDL domains imported, checked and emitted again: the task is as large as it was."""

from pathlib import Path

import pytest

from benchmarks.imports import FOLDER, domain_of, instances, same_size, through_cdl
from benchmarks.translator import task_size
from cdlc.backends.engines import installed
from cdlc.driver import CompileError

pytestmark = [
    pytest.mark.skipif("fast-downward" not in installed(), reason="needs `planners`"),
    pytest.mark.skipif(not instances(), reason=f"there is no PDDL in {FOLDER.name}/"),
]
REFUSED = {"psr-middle": "the recursive definition of `upstream` cannot be imported"}
SMALL = {"assembly", "blocks", "miconic-fulladl", "schedule", "trucks", "zenotravel"}


def check(problem: Path) -> None:
    reason = REFUSED.get(problem.parent.name)
    if reason is not None:
        with pytest.raises(CompileError) as raised:
            through_cdl(problem)
        assert [d.message() for d in raised.value.diagnostics] == [reason]
        return
    task = through_cdl(problem)
    assert task.problem is not None
    before = task_size(domain_of(problem).read_text(), problem.read_text())
    after = task_size(task.domain, task.problem)
    assert same_size(before, after), (before, after)


FIRST = {p.parent.name: p for p in reversed(instances())}


@pytest.mark.parametrize("domain", sorted(SMALL | {*REFUSED}))
def test_a_task_comes_back_as_large_as_it_was(domain: str) -> None:
    check(FIRST[domain])


@pytest.mark.slow
@pytest.mark.parametrize("problem", instances(), ids=lambda p: f"{p.parent.name}/{p.stem}")
def test_every_task_comes_back_as_large_as_it_was(problem: Path) -> None:
    check(problem)
