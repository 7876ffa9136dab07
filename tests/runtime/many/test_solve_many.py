"""`crow.solve_many`: one record a problem, the same in this process and in others."""

import multiprocessing
import os
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator
from itertools import count
from pathlib import Path

import pytest
from many_tasks import GOALS, NEVER_ENDS, suite, sussman, written
from processes import assert_gone, is_running
from support import ROOT
from troubles import MARK, troubled

import crow
from crow.many.processes import Processes
from crow.many.records import Record
from crow.many.tasks import Configuration, Task
from crow.problem import Problem

QUICK = Configuration(time_limit=2, node_limit=100_000)


@pytest.fixture(scope="module")
def processes() -> Iterator[Processes]:
    """Workers that stay from test to test, whatever happens to them."""
    with Processes(2, grace=0.5) as shared:
        yield shared


def statuses(records: list[Record]) -> dict[str, str]:
    """Status, or kind of fault, by problem."""
    return {r.problem: r.status if r.fault is None else r.fault.kind for r in records}


# ------------------------------------------------------------------------------------------ results


def test_processes_give_what_this_process_gives(processes: Processes) -> None:
    tasks = suite()
    here = list(crow.solve_many(tasks))
    there = list(crow.solve_many(tasks, executor=processes))
    assert written(here) == written(there)
    kinds = Counter(record.status for record in here)
    assert kinds.keys() == {"plan", "limit"}
    assert min(kinds.values()) >= 5
    assert [record.index for record in here] == list(range(len(tasks)))
    assert sorted(record.index for record in there) == list(range(len(tasks)))


def test_a_plan_from_a_process_is_the_plan(processes: Processes) -> None:
    problem = sussman()
    (record,) = crow.solve_many([problem], executor=processes)
    assert isinstance(record.result, crow.Plan)
    assert record.result.steps == crow.plan(problem).steps
    from crow.replay import replay_to_goal

    assert replay_to_goal(problem, record.result.trace).is_sound
    assert (record.key, record.status, record.fault) == (problem.name, "plan", None)


def test_an_unsolvable_problem_is_told_as_such(processes: Processes) -> None:
    problem = troubled("never")
    for executor in ("in-process", processes):
        (record,) = crow.solve_many([problem], QUICK, executor=executor)
        assert record.status == "unsolvable", record
        assert record.result is not None
        assert record.result.explanation


def test_time_ends_a_search_wherever_it_runs(processes: Processes) -> None:
    for executor in ("in-process", processes):
        limited = Configuration(engine="iddfs", time_limit=0.3)
        (record,) = crow.solve_many([sussman(NEVER_ENDS)], limited, executor=executor)
        assert record.status == "timeout"
        assert not record.is_repeatable
        assert 0.3 <= record.seconds < 2


def test_problems_are_taken_as_there_is_room(processes: Processes) -> None:
    taken: list[int] = []

    def problems() -> Iterator[Problem]:
        for number in count():
            taken.append(number)
            yield sussman(GOALS[0])

    records = crow.solve_many(problems(), executor=processes)
    for seen in range(1, 21):
        next(records)
        assert len(taken) <= seen + processes.jobs + 1
    records.close()  # type: ignore[attr-defined]
    assert processes.room == processes.jobs


def test_what_problems_raise_passes_and_nothing_is_left(processes: Processes) -> None:
    def problems() -> Iterator[Problem]:
        yield troubled("sleeps")
        yield sussman()
        raise OSError("no more")

    with pytest.raises(OSError, match="no more"):
        list(crow.solve_many(problems(), executor=processes))
    assert processes.room == processes.jobs


def test_wrong_arguments_are_refused() -> None:
    with pytest.raises(ValueError, match="at least one job, not 0"):
        list(crow.solve_many([], jobs=0))
    with pytest.raises(ValueError, match="no executor `threads`"):
        list(crow.solve_many([], executor="threads"))  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="no engine `fast`"):
        Configuration(engine="fast")
    with pytest.raises(ValueError, match="`time_limit` has to be positive, not 0"):
        Configuration(time_limit=0)
    assert list(crow.solve_many([], jobs=2)) == []


# ------------------------------------------------------------------------------------------- faults

FAULTS = {
    "raises": ("function", "raised KeyError"),
    "spins": ("hung", "with a time limit of 2 s, and was killed"),
    "insists": ("hung", "with a time limit of 2 s, and was killed"),
    "dies": ("killed", "its process was killed by SIGKILL"),
    "aborts": ("killed", "its process was killed by SIGABRT"),
    "exits": ("function", "`sys.exit(7)`"),
}


def test_every_problem_has_one_record_whatever_its_python_does(processes: Processes) -> None:
    names = [*FAULTS, "sleeps"]
    problems = [troubled(n) for name in names for n in (name, f"none_{name}")]
    records = list(crow.solve_many(problems, QUICK, executor=processes))
    assert sorted(r.index for r in records) == list(range(len(problems)))
    expected = {name: kind for name, (kind, _) in FAULTS.items()} | {"sleeps": "timeout"}
    assert statuses(records) == expected | {f"none_{name}": "plan" for name in names}
    for record in records:
        if record.problem in FAULTS:
            assert record.fault is not None
            assert FAULTS[record.problem][1] in record.fault.message
    (raised,) = (r.fault for r in records if r.problem == "raises")
    assert raised is not None
    assert "troubles.py" in raised.traceback
    assert "externals.py" not in raised.traceback


def test_a_function_that_raises_is_a_fault_in_this_process_too() -> None:
    records = list(crow.solve_many([troubled("raises"), troubled("exits"), troubled("none")]))
    assert statuses(records) == {"raises": "function", "exits": "function", "none": "plan"}


@pytest.mark.skipif(sys.platform != "linux", reason="the limit of data is Linux's")
def test_memory_ends_a_search_and_what_follows_has_it_again(processes: Processes) -> None:
    limited = Configuration(memory_limit_mb=300, time_limit=30)
    names = ["hoards", "none_a", "allocates", "none_b", "hoards_b", "none_c"]
    problems = [troubled(name) for name in names]
    found = statuses(list(crow.solve_many(problems, limited, executor=processes)))
    expected = {n: "plan" if n.startswith("none") else "memory" for n in names}
    assert found == expected


def test_a_worker_that_holds_much_is_replaced() -> None:
    others = set(multiprocessing.active_children())
    with Processes(1) as one:
        list(crow.solve_many([troubled("none")], executor=one))
        (first,) = set(multiprocessing.active_children()) - others
        list(crow.solve_many([troubled("none_again")], executor=one))
        assert set(multiprocessing.active_children()) - others == {first}
        (record,) = crow.solve_many([troubled("keeps")], executor=one)
        assert record.status == "plan"
        assert set(multiprocessing.active_children()) == others
        (record,) = crow.solve_many([troubled("none")], executor=one)
        assert record.status == "plan"


def test_workers_that_are_killed_cost_a_record_each() -> None:
    others = set(multiprocessing.active_children())
    problems = [troubled(f"naps_{number}") for number in range(24)]
    with Processes(2) as executor:
        records = []
        for record in crow.solve_many(problems, executor=executor):
            records.append(record)
            if record.index % 6 == 0 and record.status == "plan":
                (child, *_) = set(multiprocessing.active_children()) - others
                assert child.pid is not None
                os.kill(child.pid, signal.SIGKILL)
    assert sorted(record.index for record in records) == list(range(24))
    found = Counter(statuses(records).values())
    assert found.keys() == {"plan", "killed"}
    assert 1 <= found["killed"] <= 8


def test_workers_that_died_with_nothing_to_do_cost_nothing() -> None:
    others = set(multiprocessing.active_children())
    with Processes(2) as executor:
        for _ in range(2):
            records = list(
                crow.solve_many([troubled(f"none_{i}") for i in "ab"], executor=executor)
            )
            assert statuses(records) == {"none_a": "plan", "none_b": "plan"}
            for child in set(multiprocessing.active_children()) - others:
                child.kill()
                child.join()


def test_what_is_cancelled_ends_at_once_and_its_worker_stays_if_it_hears() -> None:
    others = set(multiprocessing.active_children())
    with Processes(2, grace=0.5) as executor:
        assert len(list(crow.solve_many([troubled("naps")] * 2, executor=executor))) == 2
        workers = set(multiprocessing.active_children()) - others
        for deaf in (False, True):
            tasks = [troubled("none"), troubled("spins" if deaf else "sleeps")]
            records = crow.solve_many(tasks, executor=executor)
            assert next(records).status == "plan"
            time.sleep(0.3)
            start = time.monotonic()
            records.close()  # type: ignore[attr-defined]
            assert time.monotonic() - start < 2
            left = (set(multiprocessing.active_children()) - others) & workers
            assert len(left) == (1 if deaf else 2)
        assert next(crow.solve_many([troubled("none")], executor=executor)).status == "plan"


def test_what_cannot_travel_says_so(processes: Processes) -> None:
    here = troubled("none", {"trouble": lambda x: 0})
    (record,) = crow.solve_many([here], executor=processes)
    assert record.fault is not None
    assert record.fault.kind == "not-sent"
    assert "the Python of `trouble` cannot travel" in record.fault.message


def test_a_worker_that_lacks_a_file_says_so(processes: Processes, tmp_path: Path) -> None:
    file = tmp_path / "python_for_trouble.py"
    file.write_text("def trouble(x):\n    return len(x)\n")
    problem = troubled("none", str(file))
    (record,) = crow.solve_many([problem], executor=processes)
    assert record.status == "plan", record.fault
    file.write_text("def other(x):\n    return 1\n")
    with Processes(1) as fresh:
        (record,) = crow.solve_many([problem], executor=fresh)
        assert record.fault is not None
        assert (record.fault.kind, "trouble" in record.fault.message) == ("not-loaded", True)


def test_what_functions_print_is_not_on_standard_output(capfd: pytest.CaptureFixture[str]) -> None:
    (record,) = crow.solve_many([troubled("prints")], executor="processes", jobs=1)
    assert record.status == "plan"
    shown = capfd.readouterr()
    assert (shown.out, shown.err) == ("", "said by a function\n")


# --------------------------------------------------------------------------------------------- ends


def test_leaving_the_loop_ends_what_runs() -> None:
    others = set(multiprocessing.active_children())
    problems = [troubled("none"), troubled("sleeps"), troubled("sleeps_more"), troubled("none_b")]
    start = time.monotonic()
    for record in crow.solve_many(problems, jobs=2):
        assert record.problem == "none"
        break
    del record
    import gc

    gc.collect()
    assert set(multiprocessing.active_children()) == others
    assert time.monotonic() - start < 20


DRIVER = """
import crow
from troubles import troubled

if __name__ == "__main__":
    list(crow.solve_many([troubled("marks_a"), troubled("marks_b")], jobs=2))
"""


def started(script: str, folder: Path) -> "subprocess.Popen[str]":
    file = folder / "driver.py"
    file.write_text(script)
    paths = [ROOT, ROOT / "runtime", ROOT / "tests"]
    own = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, paths)), MARK: str(folder)}
    return subprocess.Popen(
        [sys.executable, str(file)], env=own, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        text=True,
    )  # fmt: skip


@pytest.mark.skipif(sys.platform != "linux", reason="looks at /proc")
def test_workers_end_when_their_driver_is_killed(tmp_path: Path) -> None:
    driver = started(DRIVER, tmp_path)
    try:
        deadline = time.monotonic() + 60
        while len(pids := [int(f.name) for f in tmp_path.glob("[0-9]*")]) < 2:
            assert time.monotonic() < deadline
            assert driver.poll() is None, driver.communicate()
            time.sleep(0.05)
        assert all(map(is_running, pids))
    finally:
        driver.kill()
        driver.communicate()
    assert_gone(pids)


def test_a_script_without_its_main_part_is_told_so(tmp_path: Path) -> None:
    script = DRIVER.replace('if __name__ == "__main__":\n    ', "")
    driver = started(script, tmp_path)
    _, err = driver.communicate(timeout=60)
    assert driver.returncode == 1
    assert 'has to stand under `if __name__ == "__main__":`' in err.strip().splitlines()[-1]


# ------------------------------------------------------------------------------------------ records


def test_a_record_as_json_has_what_a_table_needs() -> None:
    task = Task(sussman(), Configuration(engine="best", seed=4), "mine")
    (record,) = crow.solve_many([task])
    document = record.json()
    assert document["key"] == "mine"
    assert document["configuration"] == {"engine": "best", "seed": 4}
    assert document["status"] == "plan"
    assert len(document["steps"]) == 6
    assert document["statistics"]["nodes"] > 0
    assert "trace" not in document


@pytest.mark.parametrize(
    ("configuration", "label"),
    [
        (Configuration(), "auto"),
        (Configuration(seed=3), "auto"),
        (Configuration(engine="best", h="add", node_limit=10), "best h=add node_limit=10"),
        (Configuration(engine="best", name="mine"), "mine"),
    ],
)
def test_configurations_have_labels(configuration: Configuration, label: str) -> None:
    assert configuration.label == label
