"""`cdlc bench`: whatever ends it, each run has one record, and it goes on where it stopped."""

import json
import os
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from processes import assert_gone, below
from referencing import Registry, Resource
from support import ROOT, cdlc
from terminal import is_unbroken, on_terminal
from troubles import DOMAIN

from cdlc.bench.results import Appender
from cdlc.bench.suite import Suite
from cdlc.diagnostics import Collector
from crow.many.records import comparable

SCHEMAS = {
    name: json.loads((ROOT / "cdlc" / "schemas" / f"{name}.json").read_text())
    for name in ("bench", "plan")
}
REGISTRY: Registry[Any] = Registry().with_resources(
    [(f"{name}.json", Resource.from_contents(schema)) for name, schema in SCHEMAS.items()]
)
LINES = jsonschema.Draft202012Validator(SCHEMAS["bench"], registry=REGISTRY)

PYTHON = """
import os, signal, sys, time

def trouble(x):
    what, _, _ = x.partition("_")
    if what == "naps":
        time.sleep(0.2)
    while what == "waits" and not os.path.exists("go"):
        time.sleep(0.01)
    if what == "raises":
        raise KeyError(x)
    if what == "sleeps":
        time.sleep(1000)
    if what == "dies":
        os.kill(os.getpid(), signal.SIGKILL)
    while what == "hoards":
        kept.append(bytearray(b"x" * (8 << 20)))
    return -1 if what == "never" else 0

kept = []
"""


def write(folder: Path, *names: str) -> None:
    """A domain, its Python and a problem for each name: what it says is what its Python does."""
    (folder / "domain.cdl").write_text(DOMAIN)
    (folder / "python.py").write_text(PYTHON)
    for name in names:
        (folder / f"{name}.cdl").write_text(
            f'problem "{name}"\ndomain "domain.cdl"\nobjects:\n  {name}: thing\n'
            f"goal: done({name})\n"
        )


def lines(file: Path) -> list[dict[str, Any]]:
    """The records of a file; all of it is as the schema says."""
    documents = [json.loads(line) for line in file.read_text("utf-8").splitlines()]
    for document in documents:
        LINES.validate(document)
    assert "suite" in documents[0]
    assert len({d["key"] for d in documents[1:]}) == len(documents) - 1
    return documents[1:]


def same(documents: list[dict[str, Any]]) -> list[str]:
    """What is to be the same of records of all runs, in order."""
    return sorted(json.dumps(comparable(document), sort_keys=True) for document in documents)


# The others need functions in Python, each its own.
DISCRETE = (
    "blocks", "briefcase", "cupboard", "gripper", "jugs", "kitchen", "logistics", "tutorial",
)  # fmt: skip


def folder(name: str) -> str:
    """The problems of an example, for a suite."""
    return json.dumps(f"{ROOT.as_posix()}/examples/{name}/*.cdl")


@pytest.fixture
def examples(tmp_path: Path) -> Path:
    """A suite of the examples under limits that are the same everywhere."""
    (tmp_path / "suite.toml").write_text(
        f"problems = [{', '.join(map(folder, DISCRETE))}]\n"
        'seeds = [0, 5]\nnode-limit = 200\n[[configurations]]\nengine = "auto"\n'
        '[[configurations]]\nengine = "best"\nh = "add"\n'
    )
    return tmp_path


# ------------------------------------------------------------------------------------------ results


def test_results_are_the_same_on_any_number_of_processes(examples: Path) -> None:
    for jobs in ("1", "2"):
        ran = cdlc("bench", "suite.toml", "--jobs", jobs, "--out", f"{jobs}.jsonl", cwd=examples)
        assert (ran.status, ran.out) == (0, ""), ran
    alone, several = lines(examples / "1.jsonl"), lines(examples / "2.jsonl")
    assert same(alone) == same(several)
    assert len(alone) > 40
    assert Counter(d["status"] for d in alone).keys() == {"plan", "limit"}
    assert ran.err.startswith(f"{len(alone)} runs: ")


def test_without_a_file_records_are_the_output(tmp_path: Path) -> None:
    write(tmp_path, "never", "naps")
    ran = cdlc("bench", ".", "--functions", "python.py", "--engine", "iddfs", cwd=tmp_path)
    assert ran.status == 0
    documents = [json.loads(line) for line in ran.out.splitlines()]
    for document in documents:
        LINES.validate(document)
    assert [(d["file"], d["status"]) for d in documents] == [
        ("naps.cdl", "plan"), ("never.cdl", "unsolvable"),
    ]  # fmt: skip
    assert documents[0]["configuration"] == {"engine": "iddfs"}
    assert ran.err == "2 runs: 1 plan, 1 unsolvable\n"


FAULTS = {
    "dies": ("fault", "killed", "its process was killed by SIGKILL"),
    "raises": ("fault", "function", "`trouble(raises)` raised KeyError: 'raises'"),
    "sleeps": ("timeout", None, ""),
    "hoards": ("memory", None, ""),
    "broken": ("fault", "not-loaded", "error[unknown-feature]"),
    "naps": ("plan", None, ""),
}


@pytest.mark.skipif(sys.platform != "linux", reason="the limit of data is Linux's")
@pytest.mark.parametrize("jobs", ["1", "2"])
def test_every_run_has_a_record_whatever_happens_to_it(jobs: str, tmp_path: Path) -> None:
    write(tmp_path, *FAULTS)
    broken = tmp_path / "broken.cdl"
    broken.write_text(broken.read_text().replace("goal: done", "goal: dome"))
    ran = cdlc(
        "bench", ".", "--functions", "python.py", "--out", "r.jsonl", "--jobs", jobs,
        "--time-limit", "6", "--max-memory", "300", cwd=tmp_path,
    )  # fmt: skip
    assert ran.status == 1
    found = {d["problem"]: d for d in lines(tmp_path / "r.jsonl")}
    assert found.keys() == FAULTS.keys()
    for name, (status, kind, told) in FAULTS.items():
        assert found[name]["status"] == status, found[name]
        assert found[name].get("fault", {}).get("kind") == kind
        assert told in found[name].get("fault", {}).get("message", "")
    assert ran.err.startswith("6 runs: 1 plan, 1 timeout, 1 memory, 3 fault")


def test_python_that_hangs_while_a_problem_is_loaded_is_a_fault(tmp_path: Path) -> None:
    """A truth of objects alone is a table of facts, made before anything is searched."""
    write(tmp_path, "slow", "quick")
    for file in (tmp_path / "domain.cdl", tmp_path / "python.py"):
        file.write_text(
            file.read_text()
            .replace("def trouble(x: thing) -> int32", "def fine(x: thing) -> bool")
            .replace("trouble(x) >= 0", "fine(x)")
            .replace(
                "def trouble(x):", "def fine(x):\n    while x == 'slow': pass\n    return True"
            )
        )
    ran = cdlc(
        "bench", ".", "--functions", "python.py", "--time-limit", "3", "--out", "r.jsonl",
        cwd=tmp_path,
    )  # fmt: skip
    found = {d["problem"]: d for d in lines(tmp_path / "r.jsonl")}
    assert ran.status == 1
    assert found["quick"]["status"] == "plan"
    assert found["slow"]["fault"]["kind"] == "hung"


# ------------------------------------------------------------------------------------------- resume


@pytest.mark.parametrize("cut", [0, 150, 2_000])
def test_a_file_that_was_cut_off_goes_on(cut: int, tmp_path: Path) -> None:
    write(tmp_path, *(f"none_{number}" for number in range(12)))
    command = ("bench", ".", "--functions", "python.py", "--out", "r.jsonl")
    file = tmp_path / "r.jsonl"
    assert cdlc(*command, cwd=tmp_path).status == 0
    whole = same(lines(file))
    kept = file.read_bytes()[:cut]
    file.write_bytes(kept)
    before = kept[: kept.rfind(b"\n") + 1]
    ran = cdlc(*command, "--resume", cwd=tmp_path)
    assert ran.status == 0
    assert same(lines(file)) == whole
    assert file.read_bytes().startswith(before)
    there = max(0, before.count(b"\n") - 1)
    assert ran.err == (
        f"{12 - there} runs: {12 - there} plan\n" if there < 12 else "0 runs: none\n"
    )


def test_only_the_same_suite_goes_on(tmp_path: Path) -> None:
    write(tmp_path, "none_a", "none_b")
    command = ("bench", ".", "--functions", "python.py", "--out", "r.jsonl")
    assert cdlc(*command, cwd=tmp_path).status == 0
    ran = cdlc(*command, "--resume", "--seeds", "3", cwd=tmp_path)
    assert ran.status == 1
    assert "error[other-suite]: these are results of another suite: it has 2 runs, not 6" in ran.err
    found = Collector()
    assert Appender.resumed(tmp_path / "r.jsonl", Suite((), "another"), found) is None
    assert [diagnostic.code for diagnostic in found] == ["other-suite"]
    (tmp_path / "python.py").write_text("def trouble(x): return 1\n")
    before = (tmp_path / "r.jsonl").read_bytes()
    ran = cdlc(*command, "--resume", cwd=tmp_path)
    assert "a file, an engine, a seed or a limit is not what it was" in ran.err
    ran = cdlc(*command, cwd=tmp_path)
    assert (ran.status, ran.out) == (1, "")
    assert "error[results-exist]: `r.jsonl` is there already" in ran.err
    assert (tmp_path / "r.jsonl").read_bytes() == before
    (tmp_path / "r.jsonl").write_text("a letter\n")
    ran = cdlc(*command, "--resume", cwd=tmp_path)
    assert "error[bad-results]: not a file of results: a line is no JSON object" in ran.err
    assert (tmp_path / "r.jsonl").read_text() == "a letter\n"


def test_arguments_that_do_not_go_together_are_usage_errors(tmp_path: Path) -> None:
    for arguments, told in (
        (("--resume",), "name it with --out"),
        (("--ray", "auto", "--jobs", "2"), "a cluster uses all of its cores"),
        (("--engine", "lama"), "bench takes the engines of the runtime, not lama"),
    ):
        ran = cdlc("bench", ".", *arguments, cwd=tmp_path)
        assert ran.status == 2
        assert told in ran.err


# --------------------------------------------------------------------------------------------- ends


@pytest.mark.skipif(sys.platform != "linux", reason="looks at /proc")
@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_whatever_ends_it_no_process_is_left_and_it_goes_on(
    how: signal.Signals, tmp_path: Path
) -> None:
    write(tmp_path, *(f"{what}_{number}" for what in ("naps", "waits") for number in range(9)))
    command = ["bench", ".", "--functions", "python.py", "--out", "r.jsonl", "--jobs", "2"]
    process = subprocess.Popen(
        [sys.executable, "-m", "cdlc", *command], cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(map(str, (ROOT, ROOT / "runtime")))},
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        # A shell may have made this process ignore SIGINT; the child must not inherit that.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )  # fmt: skip
    file = tmp_path / "r.jsonl"
    try:
        deadline = time.monotonic() + 60
        while not file.exists() or file.read_bytes().count(b"\n") < 6:
            assert time.monotonic() < deadline
            assert process.poll() is None, process.communicate()
            time.sleep(0.02)
        workers = below(process.pid)
        assert len(workers) >= 2
        start = time.monotonic()
        process.send_signal(how)
        _, err = process.communicate(timeout=20)
    finally:
        process.kill()
    if how is signal.SIGKILL:
        assert process.returncode == -signal.SIGKILL
    else:
        assert time.monotonic() - start < 5
        assert process.returncode == 130
        first, last = err.splitlines()
        assert "left" in first
        assert last == "interrupted"
    assert_gone(workers)
    done = file.read_bytes()[: file.read_bytes().rfind(b"\n") + 1]
    assert 6 <= done.count(b"\n") <= 10
    (tmp_path / "go").touch()
    ran = cdlc(*command, "--resume", cwd=tmp_path)
    assert ran.status == 0
    assert file.read_bytes().startswith(done)
    assert Counter(d["status"] for d in lines(file)) == {"plan": 18}


def test_two_runs_do_not_write_one_file(tmp_path: Path) -> None:
    import fcntl

    write(tmp_path, "none")
    command = ("bench", ".", "--functions", "python.py", "--out", "r.jsonl")
    assert cdlc(*command, cwd=tmp_path).status == 0
    with (tmp_path / "r.jsonl").open() as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        ran = cdlc(*command, "--resume", cwd=tmp_path)
    assert (ran.status, ran.out) == (1, "")
    assert ran.err.startswith("error[results-in-use]: `r.jsonl` is being written by another run")


def test_a_bar_shows_how_far_it_is(tmp_path: Path) -> None:
    write(tmp_path, *(f"naps_{number}" for number in range(4)))
    ran = on_terminal(
        "bench", tmp_path, "--functions", tmp_path / "python.py", "--out", tmp_path / "r.jsonl",
        folder=tmp_path, environment={"COLUMNS": "100"},
    )  # fmt: skip
    assert (ran.status, ran.out) == (0, "")
    assert "3/4" in ran.shown
    assert "3 plan" in ran.shown
    assert is_unbroken(ran.shown)
    assert ran.shown.rstrip().endswith("4 runs: 4 plan")


def test_no_cluster_is_told(tmp_path: Path) -> None:
    pytest.importorskip("ray", reason="Ray is not installed (extra `ray`)")
    write(tmp_path, "none")
    ran = cdlc("bench", ".", "--ray", "auto", "--functions", "python.py", cwd=tmp_path)
    assert (ran.status, ran.out) == (1, "")
    assert "error[no-cluster]: Ray does not find one at `auto`: " in ran.err
    assert "Traceback" not in ran.err
