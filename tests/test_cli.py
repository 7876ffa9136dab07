"""The command line as users and scripts see it: output, exit status, no traceback, nothing left."""

import itertools
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import jsonschema
import psutil
import pytest
from support import BLOCKS, ROOT, cdlc

SUSSMAN = BLOCKS / "sussman.cdl"
DOMAIN = BLOCKS / "blocks.cdl"


def schema(name: str) -> dict[str, object]:
    return json.loads((ROOT / "cdlc" / "schemas" / f"{name}.json").read_text())


# ------------------------------------------------------------------------------ ten wrong inputs

HEAD = "typedef block\nfeature clear(x: block)\nfeature on(x: block, y: block)\n"
PROBLEM = (
    f'problem "p"\ndomain "{DOMAIN}"\nobjects:\n  A, B: block\ninit:\n  on_table[A] = True\ngoal: '
)

WRONG_TEXTS = {
    "syntax": (HEAD + "behavior r(x: block):\n  goal: clear(x\n", "unclosed-bracket", 5),
    "near miss": (HEAD + "behavior r(x: block):\n  goal: claer(x)\n", "unknown-feature", 5),
    "arity": (HEAD + "behavior r(x: block):\n  goal: on(x)\n", "wrong-argument-count", 5),
    "type": (HEAD + "typedef room\nfeature in(r: room)\nbehavior r(x: block):\n  goal: in(x)\n",
             "wrong-argument-type", 7),
    "duplicate": (HEAD + "feature clear(x: block)\n", "duplicate-definition", 4),
    "goal object": (PROBLEM + "on(A, Z)\n", "unknown-name", 7),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG_TEXTS)
def test_wrong_text_is_a_diagnostic_with_code_and_place(case: str, tmp_path: Path) -> None:
    text, code, line = WRONG_TEXTS[case]
    file = tmp_path / "wrong.cdl"
    file.write_text(text)
    ran = cdlc("check", file)
    assert ran.status == 1
    assert f"error[{code}]" in ran.err
    assert f"{file}:{line}:" in ran.err
    assert ran.out == ""
    assert "Traceback" not in ran.err


def test_a_near_miss_is_suggested() -> None:
    text = WRONG_TEXTS["near miss"][0]
    assert "did you mean `clear`?" in cdlc("check", "-", stdin=text).err


def wrong_files(tmp_path: Path) -> dict[str, tuple[Path, str]]:
    binary, empty = tmp_path / "binary.cdl", tmp_path / "empty.cdl"
    binary.write_bytes(bytes(range(256)) * 8)
    empty.write_text("")
    return {
        "missing": (tmp_path / "missing.cdl", "unreadable-file"),
        "directory": (tmp_path, "unreadable-file"),
        "binary": (binary, "not-text"),
        "empty": (empty, "empty-file"),
    }


@pytest.mark.parametrize("case", ["missing", "directory", "binary", "empty"])
def test_wrong_file_is_a_diagnostic_naming_it(case: str, tmp_path: Path) -> None:
    file, code = wrong_files(tmp_path)[case]
    ran = cdlc("check", file)
    assert (ran.status, ran.out) == (1, "")
    assert f"error[{code}]" in ran.err
    assert str(file) in ran.err
    assert "Traceback" not in ran.err


@pytest.mark.parametrize("case", ["missing", "directory", "binary", "empty"])
@pytest.mark.parametrize(
    "command",
    [
        ("compile", "--emit", "pddl", "FILE"),
        ("plan", "FILE"),
        ("plan", str(DOMAIN), "FILE"),
        ("simulate", "FILE"),
        ("validate", str(SUSSMAN), "FILE"),
    ],
    ids=" ".join,
)
def test_every_command_reports_wrong_files(
    command: tuple[str, ...], case: str, tmp_path: Path
) -> None:
    file, _ = wrong_files(tmp_path)[case]
    ran = cdlc(*(str(file) if word == "FILE" else word for word in command))
    assert ran.status == 1
    assert "error[" in ran.err
    assert "Traceback" not in ran.err


@pytest.mark.parametrize(
    "arguments",
    [
        (),
        ("check",),
        ("frobnicate",),
        ("compile", str(DOMAIN)),
        ("compile", str(DOMAIN), "--emit", "cobol"),
        ("compile", str(DOMAIN), "--emit", "hoare", "--simplify", "most"),
        ("compile", str(DOMAIN), "--emit", "pddl", "--format", "json"),
        ("compile", str(DOMAIN), "--emit", "pddl", "--explain"),
        ("compile", str(DOMAIN), "--emit", "hddl", "--format", "json"),
        ("compile", str(DOMAIN), "--emit", "hddl", "--derived", "axioms"),
        ("compile", str(DOMAIN), "--emit", "hddl", "--numeric", "enumerate"),
        ("compile", str(SUSSMAN), "--emit", "up", "--derived", "axioms"),
        ("compile", str(DOMAIN), "--emit", "hoare", "--explain", "--format", "json"),
        ("plan", "a", "b", "c"),
        ("validate", str(SUSSMAN)),
        ("plan", str(SUSSMAN), "--time-limit", "-1"),
        ("plan", str(SUSSMAN), "--time-limit", "soon"),
        ("plan", str(SUSSMAN), "--time-limit", "nan"),
    ],
    ids=str,
)
def test_wrong_usage_has_status_2(arguments: tuple[str, ...]) -> None:
    ran = cdlc(*arguments)
    assert (ran.status, ran.out) == (2, "")
    assert "usage" in ran.err


# ----------------------------------------------------------------------------------------- check


def test_check_json_follows_its_schema_and_holds_every_error() -> None:
    text = HEAD + "behavior r(x: block):\n  goal: claer(x)\n  eff: cleer[x] = True\n"
    ran = cdlc("check", "-", "--format", "json", stdin=text)
    document = json.loads(ran.out)
    assert ran.status == 1
    codes = [d["code"] for d in document["diagnostics"]]
    assert codes == ["unknown-feature", "unknown-feature"]
    replacement = document["diagnostics"][0]["help"][0]["replacement"]
    assert replacement["text"] == "clear"


def test_warnings_are_errors_on_demand() -> None:
    file = BLOCKS / "blocks_as_printed.cdl"
    assert cdlc("check", file).status == 0
    assert cdlc("check", file, "--warnings", "error").status == 1


def test_check_loads_neither_sympy_nor_unified_planning() -> None:
    script = (
        "import sys; from cdlc.cli import main; status = main(sys.argv[1:]);"
        "heavy = {'sympy', 'unified_planning', 'numpy', 'psutil', 'rich', 'z3'} & set(sys.modules);"
        "sys.exit(f'{status} {heavy}' if status or heavy else 0)"
    )
    command = [sys.executable, "-c", script, "check", str(DOMAIN), str(SUSSMAN)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stderr) == (0, "")


# --------------------------------------------------------------------------------------- compile


@pytest.mark.parametrize("emitted", ["pddl", "hddl"])
def test_compile_writes_files_whole(emitted: str, tmp_path: Path) -> None:
    folder = tmp_path / "new" / "folder"
    ran = cdlc("compile", DOMAIN, SUSSMAN, "--emit", emitted, "-o", folder)
    assert (ran.status, ran.out, ran.err) == (0, "", "")
    names = [f"domain.{emitted}", f"problem.{emitted}"]
    assert sorted(f.name for f in folder.iterdir()) == names
    printed = cdlc("compile", DOMAIN, SUSSMAN, "--emit", emitted).out
    assert "\n".join((folder / name).read_text() for name in names) == printed


def test_compile_into_a_file_is_reported(tmp_path: Path) -> None:
    target = tmp_path / "file"
    target.write_text("kept")
    ran = cdlc("compile", DOMAIN, "--emit", "pddl", "-o", target)
    assert ran.status == 1
    assert "error[cannot-write]" in ran.err
    assert target.read_text() == "kept"


def test_compile_emits_hoare_and_ir() -> None:
    hoare = cdlc("compile", DOMAIN, "--emit", "hoare").out
    assert "(= (on ?x ?y) true)" in hoare
    document = json.loads(cdlc("compile", DOMAIN, SUSSMAN, "--emit", "ir").out)
    assert document["version"] == 1
    assert document["problem"]["name"] == "sussman"


LOOP = """
typedef tank
feature fuel(x: tank) -> int64
behavior burn(x: tank):
  eff:
    for i in range(3000):
      if fuel[x] > {bound}: fuel[x] -= 1
{other}"""
DOUBLING = LOOP.format(bound="i", other="")
CHAIN = LOOP.format(bound="0", other="      else: break\n")


@pytest.mark.parametrize("options", [(), ("--explain",), ("--simplify", "full")])
def test_text_that_would_be_endless_is_refused(options: tuple[str, ...], tmp_path: Path) -> None:
    folder = tmp_path / "out"
    ran = cdlc("compile", "-", "--emit", "hoare", *options, "-o", folder, stdin=DOUBLING)
    assert (ran.status, ran.out) == (1, "")
    assert "error[formula-too-large]" in ran.err
    assert "-:7:" in ran.err
    assert "--format json" in ran.err
    assert "Traceback" not in ran.err
    assert not folder.exists()


@pytest.mark.parametrize("options", [(), ("--explain",), ("--simplify", "full")])
def test_deep_formulas_are_written(options: tuple[str, ...]) -> None:
    """The paper's loop 3,000 times: its text is long, but not endless."""
    ran = cdlc("compile", "-", "--emit", "hoare", *options, stdin=CHAIN)
    assert (ran.status, ran.err) == (0, "")
    assert "(> (fuel ?x) 2999)" in ran.out
    assert ("too large for level full, left at basic" in ran.out) is ("full" in options)


def test_json_has_no_limit_of_text(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    ran = cdlc("compile", "-", "--emit", "hoare", "--format", "json", "-o", folder, stdin=DOUBLING)
    assert (ran.status, ran.out, ran.err) == (0, "", "")
    (file,) = folder.iterdir()
    assert file.name == "model.json"
    assert len(json.loads(file.read_text())["model"]["nodes"]) < 13_000
    program = json.loads(cdlc("compile", "-", "--emit", "ir", stdin=DOUBLING).out)
    assert len(program["model"]["nodes"]) < 13_000


def test_explanations_name_places() -> None:
    ran = cdlc("compile", DOMAIN, "--emit", "hoare", "--explain")
    assert (ran.status, ran.err) == (0, "")
    assert f"--> {DOMAIN}:" in ran.out
    assert "on[x, y] = True" in ran.out


def test_what_has_no_pddl_is_refused_with_its_place() -> None:
    text = "typedef ball\nfeature size(b: ball) -> string\nfeature red(b: ball)\n"
    ran = cdlc("compile", "-", "--emit", "pddl", stdin=text)
    assert (ran.status, ran.out) == (1, "")
    assert "error[not-discrete]" in ran.err
    assert "-:2:" in ran.err


def test_a_closed_pipe_is_no_error() -> None:
    command = f"{sys.executable} -m cdlc compile {DOMAIN} --emit ir | head -n 1"
    done = subprocess.run(
        command, shell=True, capture_output=True, text=True, timeout=60, cwd=ROOT, check=False
    )
    assert done.stderr == ""


# ------------------------------------------------------------------------------------------ plan


def test_plan_prints_steps_and_json_follows_its_schema() -> None:
    text = cdlc("plan", DOMAIN, SUSSMAN, "--engine", "fast-downward")
    assert (text.status, len(text.out.splitlines())) == (0, 6)
    assert "1. unstack(C, A)" in text.out
    ran = cdlc("plan", DOMAIN, SUSSMAN, "--engine", "fast-downward", "--format", "json")
    document = json.loads(ran.out)
    jsonschema.validate(document, schema("plan"))
    assert (document["status"], document["cost"]) == ("plan", 6)
    assert document["steps"][0] == {
        "behavior": "r_holding_from_stack",
        "behavior_arguments": ["C"],
        "bindings": {"y": "A"},
        "controller": "unstack",
        "arguments": ["C", "A"],
        "also": ["r_clear"],
    }


def test_no_plan_has_status_3() -> None:
    impossible = PROBLEM + "holding(A) and handempty()\n"
    ran = cdlc("plan", "-", "--engine", "fast-downward", stdin=impossible)
    assert (ran.status, ran.out) == (3, "")
    assert "no plan exists" in ran.err


@pytest.mark.parametrize("engine", [(), ("--engine", "iddfs"), ("--engine", "reference")])
def test_the_runtime_plans_by_default(engine: tuple[str, ...]) -> None:
    swap = ROOT / "examples" / "tutorial" / "swap.cdl"
    ran = cdlc("plan", swap, *engine, "--format", "json", "--seed", "7")
    document = json.loads(ran.out)
    jsonschema.validate(document, schema("plan"))
    assert (ran.status, ran.err, document["status"], document["seed"]) == (0, "", "plan", 7)
    assert document["engine"] == (engine[1] if engine else "auto")
    assert [step["controller"] for step in document["steps"]][:2] == ["pick", "go"]
    assert document["statistics"]["nodes"] > 0


def test_a_native_plan_is_validated_with_its_trace(tmp_path: Path) -> None:
    for example in ("tutorial/swap", "kitchen/tidy", "blocks/sussman"):
        problem, plan = ROOT / "examples" / f"{example}.cdl", tmp_path / "plan.json"
        assert cdlc("plan", problem, "--format", "json", "-o", plan).status == 0
        ran = cdlc("validate", problem, plan)
        assert ran.status == 0, ran.err
        assert "trace items" in ran.out


UNSOLVABLE = """problem "p"
domain "__empty__"
typedef door
feature open(d: door)
feature locked(d: door)
controller push(d: door)
behavior enter(d: door):
  goal: open(d)
  body:
    assert not locked(d)
    do push(d)
  eff: open[d] = True
objects:
  front: door
init: locked[front] = True
goal: open(front)
"""


def test_no_plan_is_explained() -> None:
    ran = cdlc("plan", "-", stdin=UNSOLVABLE)
    assert (ran.status, ran.out) == (3, "")
    assert "no plan exists by the program (auto" in ran.err
    assert "`not locked(d)` at -:10:5 with d = front: it is false here" in ran.err
    document = json.loads(cdlc("plan", "-", "--format", "json", stdin=UNSOLVABLE).out)
    jsonschema.validate(document, schema("plan"))
    assert document["status"] == "unsolvable"
    assert "locked(front) is True" in document["explanation"]
    solvable = UNSOLVABLE.replace("locked[front] = True", "locked[front] = False")
    assert cdlc("plan", "-", stdin=solvable).out == "1. push(front)  by enter(front)\n"


def test_what_the_planner_does_not_cover_is_refused_with_its_place() -> None:
    text = UNSOLVABLE.replace("assert not", "bind n: int64\n    assert not")
    code = "not-plannable"
    ran = cdlc("plan", "-", "--engine", "best", stdin=text)
    assert (ran.status, ran.out) == (1, "")
    assert f"error[{code}]: the engine `best` does not cover `bind n`" in ran.err
    assert "-:10:5" in ran.err


def test_a_goal_that_holds_needs_no_steps() -> None:
    ran = cdlc("plan", "-", stdin=PROBLEM + "on_table(A)\n")
    assert (ran.status, ran.out) == (0, "")


def test_an_unknown_engine_is_reported() -> None:
    ran = cdlc("plan", SUSSMAN, "--engine", "fast-upward")
    assert ran.status == 1
    assert "error[engine-missing]" in ran.err


def hard_problem(tmp_path: Path) -> Path:
    """So many blocks that grounding alone takes longer than any limit of these tests."""
    names = [f"b{i}" for i in range(150)]
    facts = "".join(f"  on[{a}, {b}] = True\n" for a, b in itertools.pairwise(names))
    goal = " and ".join(f"on({b}, {a})" for a, b in itertools.pairwise(names))
    file = tmp_path / "hard.cdl"
    file.write_text(
        f'problem "hard"\ndomain "{DOMAIN}"\nobjects:\n  {", ".join(names)}: block\ninit:\n{facts}'
        f"  on_table[b149] = True\n  clear[b0] = True\n  handempty[...] = True\ngoal: {goal}\n"
    )
    return file


@pytest.mark.parametrize("engine", ["auto", "fast-downward"])
def test_a_time_limit_has_status_4(engine: str, tmp_path: Path) -> None:
    ran = cdlc("plan", hard_problem(tmp_path), "--time-limit", "1.5", "--engine", engine)
    assert (ran.status, ran.out) == (4, "")
    assert "time limit" in ran.err
    if engine == "auto":
        assert "searched " in ran.err


def test_a_memory_limit_of_the_runtime_has_status_4(tmp_path: Path) -> None:
    ran = cdlc("plan", hard_problem(tmp_path), "--max-memory", "1")
    assert (ran.status, ran.out) == (4, "")
    assert "memory limit" in ran.err


def interrupted(command: list[str], number: signal.Signals, ready: Callable[..., object]) -> str:
    """What a command says to a signal that it gets when it is ready."""
    process = subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # A shell may have made this process ignore SIGINT; the child must not inherit that.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    try:
        ready(process)
        process.send_signal(number)
        out, err = process.communicate(timeout=20)
    finally:
        process.kill()
    assert (process.returncode, out) == (130, "")
    assert "Traceback" not in err
    return err


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_the_runtime_is_interrupted(number: signal.Signals, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "cdlc", "plan", str(hard_problem(tmp_path))]
    err = interrupted(command, number, wait_for_work)
    assert "searched " in err
    assert "interrupted" in err


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_leaves_nothing_behind(number: signal.Signals, tmp_path: Path) -> None:
    temporary = tmp_path / "tmp"
    temporary.mkdir()
    hard = str(hard_problem(tmp_path))
    command = [sys.executable, "-m", "cdlc", "plan", hard, "--engine", "fast-downward"]
    process = subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "TMPDIR": str(temporary)},
        # A shell may have made this process ignore SIGINT; the child must not inherit that.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    try:
        children = wait_for_children(process)
        process.send_signal(number)
        out, err = process.communicate(timeout=20)
    finally:
        process.kill()
    assert (process.returncode, out) == (130, "")
    assert "Traceback" not in err
    _gone, alive = psutil.wait_procs(children, timeout=5)
    assert not alive
    assert list(temporary.iterdir()) == []


def wait_for_work(process: subprocess.Popen[str]) -> None:
    """Until a run has computed for longer than it takes to start."""
    deadline = time.monotonic() + 60
    while psutil.Process(process.pid).cpu_times().user < 2.5:
        assert time.monotonic() < deadline
        time.sleep(0.05)


def wait_for_children(process: subprocess.Popen[str]) -> list[psutil.Process]:
    """The processes of a run once the planner is among them."""
    deadline = time.monotonic() + 30
    while time.monotonic() < deadline:
        children = psutil.Process(process.pid).children(recursive=True)
        if len(children) >= 3:
            return children
        time.sleep(0.05)
    raise AssertionError(f"no planner was started; temporary files are in {tempfile.gettempdir()}")


# --------------------------------------------------------------------------- simulate, validate


def test_simulate_prints_the_state_after_the_steps() -> None:
    ran = cdlc("simulate", DOMAIN, SUSSMAN, "--step", "r_clear(A)", "--format", "json")
    document = json.loads(ran.out)
    jsonschema.validate(document, schema("simulate"))
    assert ran.status == 0
    assert document["state"] == {
        "on_table(A)": True,
        "on_table(B)": True,
        "clear(A)": True,
        "clear(B)": True,
        "holding(C)": True,
    }


def test_simulate_says_which_precondition_fails() -> None:
    steps = ("--step", "r_clear(A)", "--step", "r_on(A, B)")
    ran = cdlc("simulate", SUSSMAN, *steps, "--format", "json")
    document = json.loads(ran.out)
    jsonschema.validate(document, schema("simulate"))
    assert ran.status == 1
    assert document["failed"]["step"] == "r_on(A, B)"
    assert document["failed"]["condition"] == "holding(x)"
    assert "error[step-failed]" in ran.err


def test_an_open_bind_lists_its_choices() -> None:
    ran = cdlc(
        "simulate", BLOCKS / "towers12.cdl", "--step", "r_nothing(b1)", "--step", "r_clear(b1)"
    )
    assert ran.status == 1
    assert "unknown behavior `r_nothing`" in ran.err


def test_a_plan_is_validated_and_a_tampered_one_is_not(tmp_path: Path) -> None:
    plan, tampered = tmp_path / "plan.txt", tmp_path / "tampered.txt"
    assert cdlc("plan", SUSSMAN, "-o", plan).status == 0
    valid = cdlc("validate", SUSSMAN, plan)
    assert valid.status == 0
    assert "not checked" in valid.out
    tampered.write_text("".join(plan.read_text().splitlines(keepends=True)[1:]))
    ran = cdlc("validate", SUSSMAN, tampered)
    assert ran.status == 1
    assert f"{tampered}:1:" in ran.err
