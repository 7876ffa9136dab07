"""However a search is ended, it ends soon, says what it did, and leaves no half of a file."""

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from hard_problems import BODIES, pairs, towers
from support import cdlc

ENGINES = ("auto", "best", "iddfs", "reference")
SOON = 1.0
"""Seconds."""


def problem(folder: Path, kind: str) -> Path:
    return towers(folder, 150) if kind == "towers" else pairs(folder, kind)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("kind", ["towers", *BODIES])
def test_a_time_limit_ends_every_engine_soon(kind: str, engine: str, tmp_path: Path) -> None:
    ran = cdlc(
        "plan", problem(tmp_path, kind), "--engine", engine, "--time-limit", "0.5",
        "--format", "json",
    )  # fmt: skip
    assert ran.status == 4, ran
    document = json.loads(ran.out)
    assert document["status"] == "timeout"
    assert 0.5 <= document["statistics"]["seconds"] < 0.5 + SOON
    assert document["statistics"]["nodes"] >= 0


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("kind", ["foreach", "effect"])
def test_a_memory_limit_ends_every_engine(kind: str, engine: str, tmp_path: Path) -> None:
    ran = cdlc("plan", problem(tmp_path, kind), "--engine", engine, "--max-memory", "90")
    assert ran.status == 4, ran
    assert "searched " in ran.err
    assert "no plan found within the memory limit" in ran.err
    assert "Traceback" not in ran.err


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("kind", ["towers", "foreach", "exists"])
def test_ctrl_c_ends_every_engine_soon(kind: str, engine: str, tmp_path: Path) -> None:
    left = tmp_path / "left"
    left.mkdir()
    process = subprocess.Popen(
        [sys.executable, "-m", "cdlc", "plan", str(problem(tmp_path, kind)), "--engine", engine,
         "-o", str(left / "plan"), "--trace", str(left / "trace.html")],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        # A shell may have made this process ignore SIGINT; the child must not inherit that.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )  # fmt: skip
    try:
        time.sleep(1.5)
        start = time.monotonic()
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=20)
    finally:
        process.kill()
    assert time.monotonic() - start < SOON
    assert (process.returncode, out) == (130, "")
    assert "searched " in err
    assert err.rstrip().endswith("interrupted")
    assert "Traceback" not in err
    assert list(left.iterdir()) == []


def test_no_memory_for_the_input_is_a_memory_limit_too(tmp_path: Path) -> None:
    ran = cdlc("plan", towers(tmp_path, 150), "--max-memory", "1", "--format", "json")
    assert ran.status == 4
    assert json.loads(ran.out)["status"] == "memory"


@pytest.mark.parametrize("engine", ["auto", "best", "iddfs"])
def test_a_limit_says_what_failed(engine: str, tmp_path: Path) -> None:
    ran = cdlc("plan", towers(tmp_path, 150), "--engine", engine, "--time-limit", "1")
    assert ran.status == 4
    first, second, *rest = ran.err.splitlines()
    assert first.startswith("searched ")
    assert " nodes in 1." in first
    assert second.startswith("left out: ")
    assert any(line.startswith("no plan found within the time limit") for line in rest)
