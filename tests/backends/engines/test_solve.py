"""Real runs of Fast Downward: what they answer, and that nothing of them stays behind."""

import ast
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from typing import TypeVar

import pytest

from cdlc.backends.engines import (
    EngineFailed,
    EngineMissing,
    EngineResult,
    EngineStatus,
    EngineUnsupported,
    PddlStep,
    catalogue,
    installed,
    solve,
)
from cdlc.backends.engines.spelling import Spelling

psutil = pytest.importorskip("psutil")
if "fast-downward" not in installed():
    pytest.skip("needs the extra `planners`", allow_module_level=True)

ROOMS = """
(define (domain Rooms-1) (:requirements :strips :typing)
  (:types Room - object)
  (:constants HOME - Room) ; (:constants home - Room) in a comment does not count
  (:predicates (at ?r - Room) (door ?a ?b - Room))
  (:action Go-To :parameters (?a ?b - Room) :precondition (and (at ?a) (door ?a ?b))
    :effect (and (not (at ?a)) (at ?b))))
"""


def rooms(goal: str) -> str:
    return f"""(define (problem P) (:domain Rooms-1) (:objects Room-A room_B - Room)
      (:init (at HOME) (door HOME Room-A) (door Room-A room_B)) (:goal (and {goal})))"""


# Every action keeps the parity of the lamps that are on, which no heuristic sees.
LAMPS = """
(define (domain lamps) (:requirements :strips :negative-preconditions)
  (:predicates (on ?x) (next ?x ?y))
  (:action both-on :parameters (?a ?b) :precondition (and (next ?a ?b) (not (on ?a)) (not (on ?b)))
    :effect (and (on ?a) (on ?b)))
  (:action both-off :parameters (?a ?b) :precondition (and (next ?a ?b) (on ?a) (on ?b))
    :effect (and (not (on ?a)) (not (on ?b))))
  (:action swap :parameters (?a ?b) :precondition (and (next ?a ?b) (on ?a) (not (on ?b)))
    :effect (and (not (on ?a)) (on ?b))))
"""


def lamps(count: int) -> str:
    names = [f"l{i}" for i in range(count)]
    ring = "".join(f"(next {a} {b})" for a, b in zip(names, names[1:] + names[:1], strict=True))
    off = "".join(f"(not (on {name}))" for name in names[1:])
    return f"""(define (problem ring) (:domain lamps) (:objects {" ".join(names)})
      (:init {ring}) (:goal (and (on l0) {off})))"""


# Fast Downward's translator runs through every combination of the parameters.
WIDE = """
(define (domain wide) (:predicates (p ?x) (r ?x))
  (:action a :parameters (?a ?b ?c ?d ?e) :precondition (and (p ?a) (p ?b) (p ?c) (p ?d) (p ?e))
    :effect (r ?a)))
"""


def wide(count: int) -> str:
    names = [f"x{i}" for i in range(count)]
    return f"""(define (problem many) (:domain wide) (:objects {" ".join(names)})
      (:init {"".join(f"(p {name})" for name in names)}) (:goal (r x0)))"""


COUNTER = """
(define (domain counter) (:requirements :numeric-fluents) (:functions (n))
  (:action inc :parameters () :precondition (and) :effect (increase (n) 1)))
"""
COUNT_TO_2 = """
(define (problem two) (:domain counter) (:init (= (n) 0)) (:goal (>= (n) 2)))
"""

RUNS: dict[str, Callable[[], EngineResult]] = {
    "memory": lambda: solve(WIDE, wide(25), memory_limit_mb=150, time_limit=60),
    "plan": lambda: solve(ROOMS, rooms("(at room_b)")),
    "optimal": lambda: solve(ROOMS, rooms("(at room_b)"), engine="fast-downward-opt"),
    "nothing to do": lambda: solve(ROOMS, rooms("(at home)")),
    "exhausted": lambda: solve(LAMPS, lamps(4)),
    "unbalanced": lambda: solve(ROOMS + ")", rooms("(at home)")),
    "numeric": lambda: solve(COUNTER, COUNT_TO_2),
    "unknown engine": lambda: solve(ROOMS, rooms("(at home)"), engine="no-such-engine"),
    "little memory": lambda: solve(ROOMS, rooms("(at home)"), memory_limit_mb=20),
}


@pytest.fixture(scope="module")
def run() -> Iterator[Callable[[str], EngineResult]]:
    """Results by name; the runs share the cores, in threads, as a caller may use them."""
    with ThreadPoolExecutor(2) as pool:
        runs: dict[str, Future[EngineResult]] = {n: pool.submit(f) for n, f in RUNS.items()}
        yield lambda name: runs[name].result()


@pytest.mark.parametrize("name", ["plan", "optimal"])
def test_a_plan_is_spelled_as_the_task_is(run: Callable[[str], EngineResult], name: str) -> None:
    result = run(name)
    assert result.status is EngineStatus.PLAN
    assert result.steps == (
        PddlStep("Go-To", ("HOME", "Room-A")),
        PddlStep("Go-To", ("Room-A", "room_B")),
    )
    assert "Solution found" in result.log
    assert 0 < result.seconds < 60


def test_a_goal_that_holds_needs_no_steps(run: Callable[[str], EngineResult]) -> None:
    result = run("nothing to do")
    assert (result.status, result.steps) == (EngineStatus.PLAN, ())
    assert result.engine == "fast-downward"


def test_unsolvable(run: Callable[[str], EngineResult]) -> None:
    result = run("exhausted")
    assert (result.status, result.steps) == (EngineStatus.UNSOLVABLE, ())


@pytest.mark.skipif(sys.platform != "linux", reason="the limit may have no effect elsewhere")
def test_memory_limit(run: Callable[[str], EngineResult]) -> None:
    result = run("memory")
    assert result.status is EngineStatus.MEMORY
    assert "translate exit code: 20" in result.log
    assert len(result.log.encode()) <= 8192


@pytest.mark.skipif(sys.platform != "linux", reason="the limit may have no effect elsewhere")
def test_a_memory_limit_below_what_the_worker_takes(run: Callable[[str], EngineResult]) -> None:
    result = run("little memory")
    assert result.status is EngineStatus.MEMORY
    assert "unified-planning alone takes" in result.log


def test_malformed_pddl_gives_the_readers_message(run: Callable[[str], EngineResult]) -> None:
    with pytest.raises(
        EngineFailed, match="cannot read the PDDL: Expected end of text, found"
    ) as e:
        run("unbalanced")
    assert "line:8" in e.value.reason


def test_unsupported_features_are_named(run: Callable[[str], EngineResult]) -> None:
    with pytest.raises(EngineUnsupported, match="does not take numbers") as e:
        run("numeric")
    assert e.value.engine == "fast-downward"


def test_an_unknown_engine_is_told_the_known_ones(run: Callable[[str], EngineResult]) -> None:
    with pytest.raises(EngineMissing, match=r"`no-such-engine` .*fast-downward"):
        run("unknown engine")


def test_a_missing_package_is_told_the_cure(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(catalogue, "find_spec", lambda name: None)
    assert installed() == ()
    with pytest.raises(EngineMissing, match=r'`fast-downward` .*pip install "cdlc\[planners\]"'):
        solve(ROOMS, rooms("(at home)"))


def test_a_missing_engine_outside_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    present = {"unified_planning": object(), "psutil": object()}
    monkeypatch.setattr(catalogue, "find_spec", present.get)
    with pytest.raises(EngineMissing, match=r"`symk` .*pip install up-symk"):
        solve(ROOMS, rooms("(at home)"), engine="symk")


def test_the_catalogue_is_unified_plannings() -> None:
    spec = find_spec("unified_planning")
    assert spec is not None
    assert spec.origin is not None
    tree = ast.parse(Path(spec.origin).with_name("engines").joinpath("factory.py").read_text())
    [table] = [
        ast.literal_eval(node.value)
        for node in tree.body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "DEFAULT_ENGINES"
    ]
    for engine, package in catalogue.PACKAGES.items():
        if engine == "kairos":  # registers itself
            continue
        assert table[engine][0].partition(".")[0] == package


def test_asking_what_is_installed_imports_nothing() -> None:
    code = """if True:
        import sys, cdlc.backends.engines as engines
        assert engines.installed()
        assert not {"unified_planning", "psutil", "numpy"} & set(sys.modules)"""
    subprocess.run([sys.executable, "-c", code], check=True)


def test_errors_can_be_pickled() -> None:
    import pickle

    for error in (
        EngineMissing("e", "c"),
        EngineUnsupported("e", ("F",)),
        EngineFailed("e", "r", "l"),
    ):
        copy = pickle.loads(pickle.dumps(error))
        assert (str(copy), vars(copy)) == (str(error), vars(error))


def test_a_type_does_not_lend_an_object_its_spelling() -> None:
    domain = "(define (domain d) (:types Block) (:action Put))"
    problem = "(define (problem p) (:objects a - Block block - (either Block A) c - B))"
    assert Spelling.of(domain, problem).step("PUT", ("A", "BLOCK", "C", "d")) == PddlStep(
        "Put", ("a", "block", "c", "d")
    )


# --- What is left behind -----------------------------------------------------------------------

SCRIPT = """
import sys, threading
from pathlib import Path
from cdlc.backends.engines import EngineFailed, solve
limit = float(sys.argv[1]) or None
try:
    result = solve(Path("domain").read_text(), Path("problem").read_text(), time_limit=limit)
except KeyboardInterrupt:
    sys.exit("interrupted")
except EngineFailed as error:
    sys.exit("failed")
assert not any(name.startswith("unified_planning") for name in sys.modules)
sys.exit(f"{result.status} {result.seconds}")
"""


Fact = TypeVar("Fact")


class Caller:
    """A process that calls `solve` on a task that takes hours, and what belongs to it."""

    def __init__(self, directory: Path, time_limit: float = 0) -> None:
        self.cwd, self.temporary = directory / "cwd", directory / "temporary"
        for created in (self.cwd, self.temporary):
            created.mkdir()
        (self.cwd / "domain").write_text(LAMPS)
        (self.cwd / "problem").write_text(lamps(40))
        self.process = subprocess.Popen(
            [sys.executable, "-c", SCRIPT, str(time_limit)],
            cwd=self.cwd,
            env={
                **os.environ,
                "TMPDIR": str(self.temporary),
                "PYTHONPATH": os.pathsep.join(filter(None, sys.path)),
            },
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
            # A shell that starts the tests in the background makes them ignore SIGINT.
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
        )

    def engine_processes(self) -> list["psutil.Process"]:
        return [p for p in psutil.process_iter() if _is_marked(p, self.temporary)]

    def await_search(self) -> None:
        wait_until(self._is_searching, 30)

    def _is_searching(self) -> bool:
        assert self.process.poll() is None, self.end()
        return any(_fact(process.name) == "downward" for process in self.engine_processes())

    def clean_up(self) -> None:
        """Leave nothing behind where a test has failed."""
        self.process.kill()
        for process in self.engine_processes():
            with suppress(psutil.Error):
                process.kill()
        self.process.communicate()

    def end(self) -> str:
        stdout, stderr = self.process.communicate(timeout=60)
        assert stdout == ""
        return stderr.strip()

    def assert_nothing_is_left(self, seconds: float) -> None:
        wait_until(
            lambda: not self.engine_processes() and not any(self.temporary.iterdir()), seconds
        )
        assert sorted(path.name for path in self.cwd.iterdir()) == ["domain", "problem"]


def _fact(ask: Callable[[], Fact]) -> Fact | None:
    """What is asked about a process, or None where it has just ended."""
    try:
        return ask()
    except psutil.Error:
        return None


def _is_marked(process: "psutil.Process", temporary: Path) -> bool:
    try:
        mark = process.environ().get("CDLC_ENGINE_RUN", "")
        return mark.startswith(str(temporary.resolve()))
    except psutil.Error:
        return False


def wait_until(condition: Callable[[], bool], seconds: float) -> None:
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.02)


@pytest.fixture
def call(tmp_path: Path) -> Iterator[Callable[..., Caller]]:
    """`call(time_limit=…)` starts a caller."""
    callers: list[Caller] = []

    def start(time_limit: float = 0) -> Caller:
        callers.append(Caller(tmp_path, time_limit))
        return callers[-1]

    yield start
    for caller in callers:
        caller.clean_up()


def test_time_limit(call: Callable[..., Caller]) -> None:
    # How far the run gets before the limit depends on the machine; what is left of it does not.
    caller = call(time_limit=4)
    status, seconds = caller.end().split()
    caller.assert_nothing_is_left(0)
    assert status == "timeout"
    assert float(seconds) >= 4


def test_time_limit_before_the_worker_runs(tmp_path: Path) -> None:
    assert solve(ROOMS, rooms("(at home)"), time_limit=0).status is EngineStatus.TIMEOUT


@pytest.mark.parametrize("presses", [1, 2])
def test_ctrl_c(call: Callable[..., Caller], presses: int) -> None:
    caller = call()
    caller.await_search()
    for _ in range(presses):
        os.killpg(caller.process.pid, signal.SIGINT)
        time.sleep(0.01)
    stderr = caller.end()
    # A second one may interrupt the caller's own clean-up; the worker does it all the same.
    caller.assert_nothing_is_left(0 if presses == 1 else 10)
    assert presses > 1 or stderr == "interrupted"


def test_caller_killed(call: Callable[..., Caller]) -> None:
    caller = call()
    caller.await_search()
    caller.process.kill()
    caller.assert_nothing_is_left(10)
    assert caller.end() == ""


# Any engine can be had by a unified-planning configuration file.
LIAR = """
import subprocess
import unified_planning as up
from unified_planning.engines import Engine, PlanGenerationResult, PlanGenerationResultStatus
from unified_planning.engines.mixins import OneshotPlannerMixin

class Liar(Engine, OneshotPlannerMixin):
    name = "liar"
    supports = staticmethod(lambda kind: True)
    supported_kind = staticmethod(up.model.ProblemKind)

    def __init__(self, **options):
        Engine.__init__(self)
        OneshotPlannerMixin.__init__(self)

    def _solve(self, problem, heuristic=None, timeout=None, output_stream=None):
        print("trust me")
        subprocess.Popen(["sh", "-c", "sleep 1000 & sleep 1000"], start_new_session=True)
        plan = up.plans.SequentialPlan([])
        return PlanGenerationResult(PlanGenerationResultStatus.SOLVED_SATISFICING, plan, self.name)
"""


def test_an_engine_that_lies_and_litters(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    tmp_path.joinpath("liar.py").write_text(LIAR)
    tmp_path.joinpath("up.ini").write_text("[engine liar]\nmodule_name: liar\nclass_name: Liar\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    with pytest.raises(EngineFailed, match=r"invalid plan: Goals .*room_b") as e:
        solve(ROOMS, rooms("(at room_b)"), engine="liar")
    assert "trust me" in e.value.log
    assert not [p for p in psutil.process_iter() if _is_marked(p, tmp_path)]


def test_worker_killed(call: Callable[..., Caller]) -> None:
    caller = call()
    caller.await_search()
    [worker] = [p for p in caller.engine_processes() if _fact(p.ppid) == caller.process.pid]
    worker.kill()
    assert caller.end() == "failed"
    caller.assert_nothing_is_left(0)
