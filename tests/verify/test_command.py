"""`cdlc verify` as users and scripts see it."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import jsonschema
import psutil
import pytest
from conftest import Golden
from support import BLOCKS, EXAMPLES, ROOT, cdlc

SCHEMA = json.loads((ROOT / "cdlc" / "schemas" / "verify.json").read_text())
# Beyond z3: a case of Fermat's last theorem.
FERMAT = """
feature a() -> int64
def fermat(x: int64, y: int64, z: int64) -> bool:
  return x * x * x + y * y * y != z * z * z
behavior act(x: int64, y: int64, z: int64):
  goal: fermat(x, y, z)
  body:
    assert x > 0 and y > 0 and z > 0
  eff:
    a[...] = x
"""
VALUES = """
typedef T
typedef Pose: vector[float64, 2]
typedef Plan: pyobject
feature at(x: T) -> Pose
feature named(x: T) -> string
feature planned(x: T) -> Plan
feature heavy(x: T)
def good(p: Plan, q: Pose) -> bool
def ready(x: T, p: Plan) -> bool:
  return good(planned(x), at(x)) and planned(x) == p and named(x) == "b" and heavy(x)
behavior act(x: T, p: Plan, q: Pose, n: int64):
  goal: ready(x, p)
  body:
    assert good(p, q)
    assert n > 3
    assert named(x) != "b"
  eff:
    at[x] = q + [1.0, 0.5]
    planned[x] = p
    if n == 7: heavy[x] = True
"""


def document(*arguments: str | Path, stdin: str = "", status: int = 0) -> dict[str, object]:
    ran = cdlc("verify", *arguments, "--format", "json", stdin=stdin)
    assert (ran.status, ran.err) == (status, ""), ran.err
    found = json.loads(ran.out)
    jsonschema.validate(found, SCHEMA)
    return found


STATUSES = {"proved": 0, "refuted": 1, "unknown": 4}
OTHERS = {
    "blocks_as_printed": "refuted",
    # Calls under `if`, which have no formula.
    "stacking": "unknown",
    "stacking_sussman": "unknown",
    # Trajectories that Python computes, which have no formula.
    "direct": "unknown",
    "waypoint": "unknown",
    "interleaved": "unknown",
    "easy": "unknown",
    "medium": "unknown",
    "hard": "unknown",
}


# `shared.cdl` is verified with the programs that include it.
PROGRAMS = sorted(f for f in EXAMPLES.rglob("*.cdl") if f.name != "shared.cdl")


@pytest.mark.parametrize("file", PROGRAMS, ids=lambda f: f.stem)
def test_examples_are_proved_save_for_the_misprint(file: Path) -> None:
    verdict = OTHERS.get(file.stem, "proved")
    found = document(file, status=STATUSES[verdict])
    assert found["files"][0]["verdict"] == verdict  # type: ignore[index]


def test_the_misprint_is_shown_where_it_can_be_seen(golden: Golden) -> None:
    ran = cdlc("verify", "examples/blocks/blocks_as_printed.cdl")
    assert ran.status == 1
    assert ran.err == "7 behaviors: 6 proved, 1 refuted\n"
    golden(Path(__file__).parent / "blocks_as_printed.txt", ran.out)


def test_the_how_to_shows_what_is_printed() -> None:
    page = (ROOT / "docs" / "how-to" / "verify.md").read_text()
    printed = (Path(__file__).parent / "blocks_as_printed.txt").read_text()
    shown, _, table = printed.partition("\n\nexamples/blocks/blocks_as_printed.cdl\n")
    assert f"blocks_as_printed.cdl\n{shown}\n```\n" in page
    assert "\n".join(table.splitlines()[:2]) in page


def test_objects_of_a_problem_can_be_spoken_of() -> None:
    text = """problem "p"
domain "__empty__"
typedef T
feature p(x: T)
feature q(x: T)
behavior act(x: T):
  goal: p(x)
  body:
    assert q(x)
  eff:
    p[special] = True
objects:
  special, other: T
goal: p(other)
"""
    ran = cdlc("verify", "-", stdin=text)
    assert ran.status == 1, ran.err
    assert "special" in ran.out


def test_values_of_every_type_are_shown(golden: Golden) -> None:
    ran = cdlc("verify", "-", stdin=VALUES)
    assert ran.status == 1
    golden(Path(__file__).parent / "values.txt", ran.out)
    document("-", stdin=VALUES, status=1)


def test_a_counterexample_is_a_problem_that_runs(tmp_path: Path) -> None:
    """What is printed is CDL: as a problem it leads where the report says."""
    domain = BLOCKS / "blocks_as_printed.cdl"
    (file,) = document(domain, status=1)["files"]  # type: ignore[misc]
    (example,) = [
        check["counterexample"]
        for behavior in file["behaviors"]
        for check in behavior["checks"]
        if "counterexample" in check
    ]
    objects = "".join(f"  {name}: {type_}\n" for name, type_ in example["objects"].items())
    init = "".join(f"  {line}\n" for line in example["init"])
    problem = tmp_path / "problem.cdl"
    problem.write_text(
        f'problem "p"\ndomain "{domain}"\nobjects:\n{objects}init:\n{init}goal: handempty()\n'
    )
    binds = [f"{name}={value}" for name, value in example["bindings"].items()]
    call = f"{example['behavior']}({', '.join([*example['arguments'], *binds])})"
    ran = cdlc("simulate", problem, "--step", call, "--format", "json")
    assert ran.status == 0, ran.err
    state = json.loads(ran.out)["state"]
    for change in example["changes"]:
        cell = change["cell"].replace("[...]", "()").replace("[", "(").replace("]", ")")
        assert str(state.get(cell, False)) == change["after"]
    assert all(part["condition"] not in state for part in example["false"])


def test_what_is_not_decided_is_neither_proved_nor_refuted() -> None:
    ran = cdlc("verify", "-", "--time-limit", "0.5", stdin=FERMAT)
    assert ran.status == 4
    assert "unknown  act" in ran.out
    assert "goal: not decided within the time limit" in ran.out
    assert ran.err == "1 behavior: 1 unknown\n"


def test_refuted_wins_over_unknown(tmp_path: Path) -> None:
    file = tmp_path / "fermat.cdl"
    file.write_text(FERMAT)
    found = document(file, BLOCKS / "blocks_as_printed.cdl", "--time-limit", "3", status=1)
    assert [f["verdict"] for f in found["files"]] == ["unknown", "refuted"]  # type: ignore[union-attr]


def test_mistakes_come_first() -> None:
    ran = cdlc("verify", "-", stdin="feature f(x: T)\n")
    assert (ran.status, ran.out) == (1, "")
    assert "error[unknown-type]" in ran.err


def test_a_domain_without_effects_is_verified_trivially() -> None:
    ran = cdlc("verify", "-", stdin="typedef T\nfeature f(x: T)\n")
    assert ran.status == 0
    assert "no behavior has an effect to verify" in ran.out


def test_without_z3_the_cure_is_named() -> None:
    script = (
        "import sys; sys.modules['z3'] = None; from cdlc.cli import main;"
        "sys.exit(main(['verify', *sys.argv[1:]]))"
    )
    command = [sys.executable, "-c", script, str(BLOCKS / "blocks.cdl")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr == 'error[solver-missing]: z3 is not installed: pip install "cdlc[verify]"\n'


def test_vectors_are_of_real_numbers_too() -> None:
    text = """typedef T
feature at(x: T) -> vector[float64, 2]
def wanted(x: T) -> bool:
  return at(x) == at(x) * 1.0
behavior act(x: T):
  goal: wanted(x)
  eff:
    at[x] = at(x) + [0.1, 0.1]
"""
    found = document("-", stdin=text)
    (check,) = [c for c in found["files"][0]["behaviors"][0]["checks"] if c["check"] == "goal"]  # type: ignore[index]
    assert check["notes"] == ["floats are taken as real numbers: rounding is left out"]


def test_wrong_usage_has_status_2() -> None:
    for arguments in ((), ("-", "--time-limit", "0"), ("-", "--format", "xml")):
        assert cdlc("verify", *arguments).status == 2


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_ends_it_while_z3_thinks(number: signal.Signals, tmp_path: Path) -> None:
    file = tmp_path / "fermat.cdl"
    file.write_text(FERMAT)
    process = subprocess.Popen(
        [sys.executable, "-m", "cdlc", "verify", str(file), "--time-limit", "900"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "NO_COLOR": "1"},
        # A shell may have made this process ignore SIGINT; the child must not inherit that.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    try:
        wait_until_z3_thinks(process)
        process.send_signal(number)
        out, err = process.communicate(timeout=30)
    finally:
        process.kill()
    assert (process.returncode, out, err) == (130, "", "interrupted\n")


def wait_until_z3_thinks(process: "subprocess.Popen[str]") -> None:
    """Until a second thread has had a second of the processor; z3 runs in one."""
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        threads = psutil.Process(process.pid).threads()
        if any(t.user_time > 1 for t in threads if t.id != process.pid):
            return
        time.sleep(0.05)
    raise AssertionError("z3 was not asked for long")
