"""What a search may use, and how that is measured."""

import subprocess
import sys
import time
from collections.abc import Iterator

import pytest
from support import EXAMPLES

from cdlc.driver import problem_compilation
from crow import planning as planning_module
from crow.budget import Budget, Stopped, looking, resident_mb
from crow.planning import Planning
from crow.results import OutOfMemory


def test_time_is_looked_at_though_nodes_are_few() -> None:
    budget = Budget(time_limit=0.05)
    time.sleep(0.1)
    with pytest.raises(Stopped, match="time"):
        budget.check(1, dict)


def test_nodes() -> None:
    budget = Budget(node_limit=3)
    budget.check(2, dict)
    with pytest.raises(Stopped, match="nodes"):
        budget.check(3, dict)


def test_memory() -> None:
    with pytest.raises(Stopped, match="memory"):
        Budget(memory_limit_mb=1).look()
    Budget(memory_limit_mb=100_000).look()


def test_after_the_end_nothing_is_raised() -> None:
    budget = Budget(time_limit=0.0, node_limit=1)
    budget.end()
    budget.check(5, dict)
    budget.look()


def test_progress_is_reported_now_and_then() -> None:
    told: list[int] = []
    budget = Budget(on_progress=lambda statistics: told.append(statistics["nodes"]))
    while budget.seconds < 0.55:
        budget.check(7, lambda: {"nodes": 7})
    assert 2 <= len(told) <= 6


def test_loops_look_at_the_search_that_runs() -> None:
    budget = Budget(time_limit=0.05)
    with budget.running(), pytest.raises(Stopped, match="time"):
        for _ in looking(iter(int, 1)):
            pass
    assert list(looking(range(5000))) == list(range(5000))  # of no search


def test_memory_is_what_the_process_has_now() -> None:
    """Not the most it had, nor what the process had that it came from."""
    before = resident_mb()
    large = bytearray(b"x") * (200 << 20)
    assert resident_mb() > before + 150
    script = "from crow.budget import resident_mb; print(resident_mb())"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert 1 < float(done.stdout) < 100
    del large
    assert resident_mb() < before + 100


class Greedy:
    """An engine that has no memory left, while it is made or later."""

    def plans(self) -> Iterator[None]:
        yield None
        raise MemoryError

    def statistics(self) -> dict[str, int]:
        return {"nodes": 7}

    def explanation(self) -> None:
        return None


@pytest.mark.parametrize("when", ["made", "run"])
def test_no_memory_left_is_a_typed_result(when: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def engine(*_: object) -> Greedy:
        if when == "made":
            raise MemoryError
        return Greedy()

    monkeypatch.setattr(planning_module, "_engine", engine)
    problem = problem_compilation([str(EXAMPLES / "blocks" / "sussman.cdl")]).plannable
    result = Planning(problem).first()
    assert isinstance(result, OutOfMemory)
    assert result.statistics["nodes"] == (0 if when == "made" else 7)
