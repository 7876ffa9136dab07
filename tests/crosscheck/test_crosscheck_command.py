"""`cdlc crosscheck` as users and scripts see it."""

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import jsonschema
import psutil
import pytest
from crossing import ACHIEVES, ASSERTS, SILENT, WITH_KEY, WITHOUT_KEY, written
from support import BLOCKS, EXAMPLES, ROOT, cdlc

from cdlc.backends.engines import installed

if "fast-downward" not in installed():
    pytest.skip("needs the extra `planners`", allow_module_level=True)

SCHEMA = json.loads((ROOT / "cdlc" / "schemas" / "crosscheck.json").read_text())


def several(folder: Path) -> tuple[str, ...]:
    """A domain and problems for it: agreeing, without a plan, outside, with an error."""
    written(folder, ASSERTS, WITH_KEY)
    (folder / "open.cdl").write_text(WITH_KEY.replace("locked[front] = True", "pass"))
    (folder / "none.cdl").write_text(WITHOUT_KEY)
    (folder / "wrong.cdl").write_text(WITH_KEY.replace("open(front)", "opened(front)"))
    return ("door.cdl", "open.cdl", "none.cdl", "front.cdl", "wrong.cdl")


def test_the_table_has_a_row_a_problem_and_says_more_where_needed(tmp_path: Path) -> None:
    ran = cdlc("crosscheck", *several(tmp_path), cwd=tmp_path)
    assert ran.status == 1
    heading, *rows = ran.out.splitlines()
    assert heading.split()[:4] == ["problem", "outcome", "planner", "its"]
    assert [" ".join(row.split()[:3]) for row in rows[:4]] == [
        "open.cdl agree: plan", "none.cdl agree: none", "front.cdl outside fast-downward",
        "wrong.cdl error -",
    ]  # fmt: skip
    assert "1 step" in rows[0]
    assert rows[4] == ""
    assert rows[5].startswith("front.cdl: outside: the planner finds a plan outside the program's")
    assert "  1. unlock(front)  by use_key(front)  nothing on the way to the goal asks" in ran.out
    assert "error[unknown-feature]" in ran.err
    assert ran.err.endswith("4 problems: 1 agree: plan, 1 agree: none, 1 outside, 1 error\n")
    assert "\r" not in ran.err


def test_the_page_shows_what_is_printed(tmp_path: Path) -> None:
    """The briefcase without the line that the page says was forgotten."""
    blocks = (ROOT / "docs" / "how-to" / "crosscheck.md").read_text().split("```")[1::2]
    shown = next(block.strip("\n") for block in blocks if "outside" in block)
    rule = next(block.strip() for block in blocks if "behavior r_at" in block)
    text = (EXAMPLES / "briefcase" / "briefcase.cdl").read_text()
    line = "    achieve not inside(x)\n"
    assert text.count(line) == 1
    text = text.replace(line, "")
    assert rule in text
    (tmp_path / "briefcase.cdl").write_text(text)
    (tmp_path / "payday.cdl").write_bytes((EXAMPLES / "briefcase" / "payday.cdl").read_bytes())
    ran = cdlc("crosscheck", "payday.cdl", cwd=tmp_path)
    assert ran.status == 3
    assert shown in ran.out


def test_json_follows_its_schema(tmp_path: Path) -> None:
    ran = cdlc("crosscheck", *several(tmp_path), "--format", "json", cwd=tmp_path)
    document = json.loads(ran.out)
    jsonschema.validate(document, SCHEMA)
    problems = {p["problem"]: p for p in document["problems"]}
    outcomes = [p["outcome"] for p in document["problems"]]
    assert outcomes == ["agree-plan", "agree-none", "outside", "error"]
    assert document["complete"] is True
    assert problems["open.cdl"]["planner"]["pddl"] == ["(push front)"]
    assert problems["open.cdl"]["program"]["pddl"] == ["(push front)"]
    assert [r["step"] for r in problems["front.cdl"]["remarks"]] == [1]
    assert problems["wrong.cdl"]["diagnostics"][0]["code"] == "unknown-feature"


@pytest.mark.parametrize(
    ("domain", "problem", "options", "status"),
    [
        (ACHIEVES, WITH_KEY, (), 0),
        (ACHIEVES, WITHOUT_KEY, (), 0),
        (ASSERTS, WITH_KEY, (), 3),
        (ACHIEVES, WITH_KEY, ("--node-limit", "1"), 4),
        (SILENT, WITH_KEY, (), 4),
        (ACHIEVES, "problem", (), 1),
    ],
)
def test_the_status_says_what_weighs_most(
    domain: str, problem: str, options: tuple[str, ...], status: int, tmp_path: Path
) -> None:
    ran = cdlc("crosscheck", written(tmp_path, domain, problem), *options)
    assert ran.status == status
    assert "Traceback" not in ran.err


def test_a_domain_with_errors_gives_its_diagnostics_alone(tmp_path: Path) -> None:
    problem = written(tmp_path, ACHIEVES.replace("key(d)\n", "kye(d)\n"), WITH_KEY)
    ran = cdlc("crosscheck", tmp_path / "door.cdl", problem, problem)
    assert (ran.status, ran.out) == (1, "")
    assert ran.err.count("error[unknown-feature]") == 1


@pytest.mark.parametrize(
    ("files", "status", "said"),
    [
        (("blocks/blocks.cdl",), 2, "usage error: crosscheck takes [DOMAIN] PROBLEM..."),
        (("nowhere.cdl",), 1, "error[unreadable-file]"),
        (("nowhere.cdl", "blocks/sussman.cdl"), 1, "error[unreadable-file]"),
        (("blocks/blocks.cdl", "nowhere.cdl"), 1, "error[unreadable-file]"),
        (("blocks/blocks.cdl", "blocks"), 1, "error[unreadable-file]"),
        (("blocks/blocks.cdl", "gripper/four.cdl"), 1, "error[unknown-type]"),
        (("blocks/sussman.cdl", "blocks/blocks.cdl"), 1, "error[wrong-file-kind]"),
        (("blocks/sussman.cdl", "--engine", "none"), 1, "error[engine-missing]"),
        (("blocks/sussman.cdl", "--functions", "none.py"), 1, "error[cannot-run-functions]"),
        (("blocks/sussman.cdl", "--node-limit", "0"), 2, "0 is not positive"),
    ],
)
def test_wrong_input_is_said(files: tuple[str, ...], status: int, said: str) -> None:
    ran = cdlc("crosscheck", *files, cwd=EXAMPLES)
    assert ran.status == status
    assert said in ran.err
    assert "Traceback" not in ran.err


def test_a_file_given_twice_is_compared_once_and_standard_input_is_a_problem() -> None:
    sussman = str(BLOCKS / "sussman.cdl")
    ran = cdlc("crosscheck", sussman, sussman)
    assert (ran.status, len(ran.out.splitlines())) == (0, 2)
    ran = cdlc("crosscheck", BLOCKS / "blocks.cdl", "-", "-", stdin=Path(sussman).read_bytes())
    assert (ran.status, len(ran.out.splitlines())) == (0, 2)


def test_warnings_of_a_domain_are_said_once(tmp_path: Path) -> None:
    ran = cdlc("crosscheck", *several(tmp_path)[:3], cwd=tmp_path)
    assert ran.err == "2 problems: 1 agree: plan, 1 agree: none\n"
    (tmp_path / "door.cdl").write_text(ASSERTS.replace("do push(d)", "let e = d\n    do push(d)"))
    ran = cdlc("crosscheck", "door.cdl", "open.cdl", "none.cdl", cwd=tmp_path)
    assert ran.err.count("warning[unused-variable]") == 1


def test_without_planners_the_cure_is_said() -> None:
    script = (
        "import sys; sys.modules['unified_planning'] = None; from cdlc.cli import main;"
        "sys.exit(main(sys.argv[1:]))"
    )
    command = [sys.executable, "-c", script, "crosscheck", str(BLOCKS / "sussman.cdl")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stdout) == (1, "")
    assert "error[engine-missing]" in done.stderr
    assert 'pip install "cdlc[planners]"' in done.stderr


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_shows_the_table_so_far_and_leaves_nothing(
    number: signal.Signals, tmp_path: Path
) -> None:
    """The first problem is quick; the second one is too much for the time there is."""
    written(tmp_path, ACHIEVES, WITH_KEY)
    temporary = tmp_path / "tmp"
    temporary.mkdir()
    doors = ", ".join(f"d{i}" for i in range(3_000))
    large = WITH_KEY.replace("front: door", f"front, {doors}: door")
    (tmp_path / "large.cdl").write_text(
        large.replace("goal: ", "goal: (forall d: door: open(d)) and ")
    )
    process = subprocess.Popen(
        [sys.executable, "-m", "cdlc", "crosscheck", "front.cdl", "large.cdl"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=tmp_path,
        env={**os.environ, "TMPDIR": str(temporary)},
        # A shell may have made this process ignore SIGINT; the child must not inherit that.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    try:
        children = second_run_of_planners(process)
        process.send_signal(number)
        out, err = process.communicate(timeout=20)
    finally:
        process.kill()
    assert process.returncode == 130
    assert [line.split()[0] for line in out.splitlines()] == ["problem", "front.cdl"]
    assert err == "1 problem: 1 agree: plan\ninterrupted\n"
    _gone, alive = psutil.wait_procs(children, timeout=5)
    assert not alive
    assert list(temporary.iterdir()) == []
    assert sorted(p.name for p in tmp_path.iterdir()) == [
        "door.cdl",
        "front.cdl",
        "large.cdl",
        "tmp",
    ]


def second_run_of_planners(process: subprocess.Popen[str]) -> list[psutil.Process]:
    """The processes of the third worker: of two on the first problem, the second validates."""
    deadline = time.monotonic() + 60
    workers: set[int] = set()
    while time.monotonic() < deadline:
        children = psutil.Process(process.pid).children(recursive=True)
        for child in children:
            with suppress(psutil.NoSuchProcess):  # it has ended since
                workers |= {child.pid} if child.ppid() == process.pid else set()
        if len(workers) >= 3 and len(children) >= 2:
            return children
        time.sleep(0.02)
    raise AssertionError("no planner was started")
