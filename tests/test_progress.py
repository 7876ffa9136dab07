"""The live line of a search, on a real terminal, and what is left of it."""

import re
from pathlib import Path

import pytest
from hard_problems import towers
from support import BLOCKS
from terminal import is_unbroken, on_terminal

from cdlc.progress import line_text


def test_a_line() -> None:
    told = {"nodes": 12345, "depth": 4, "turn": 2}
    assert line_text(told, 2.13) == "searching: 12,345 nodes, depth 4, turn 2, 2.1 s"
    assert line_text({"nodes": 1}, 0.5) == "searching: 1 nodes, 0.5 s"


def test_a_search_shows_how_far_it_is(tmp_path: Path) -> None:
    hard = towers(tmp_path, 150)
    ran = on_terminal("plan", hard, "--time-limit", "1.5", folder=tmp_path)
    assert (ran.status, ran.out) == (4, "")
    assert len(re.findall(r"searching: [\d,]+ nodes, depth \d+, turn \d+, \d\.\d s", ran.shown)) > 2
    assert is_unbroken(ran.shown)
    # The line is taken away before the figures stand in its place.
    last = ran.shown.split("\x1b[2K")[-1]
    assert last.startswith("searched ")
    assert "searching" not in last


@pytest.mark.parametrize("engine", ["auto", "best", "iddfs", "reference"])
def test_ctrl_c_leaves_the_terminal_as_it_was(engine: str, tmp_path: Path) -> None:
    hard = towers(tmp_path, 150)
    ran = on_terminal(
        "plan", hard, "--engine", engine, folder=tmp_path, interrupt_at="searching"
    )  # fmt: skip
    assert ran.status == 130
    assert ran.seconds_to_end < 1.0
    assert is_unbroken(ran.shown)
    assert re.search(r"searched [\d,]+ nodes in \d\.\d s", ran.shown)
    assert ran.shown.rstrip().endswith("interrupted")
    assert "Traceback" not in ran.shown


def test_a_limit_and_an_error_leave_it_as_it_was(tmp_path: Path) -> None:
    hard = towers(tmp_path, 150)
    ran = on_terminal("plan", hard, "--max-memory", "45", folder=tmp_path)
    assert ran.status == 4
    assert is_unbroken(ran.shown)
    (tmp_path / "file").write_text("")
    target = tmp_path / "file" / "plan"
    ran = on_terminal("plan", BLOCKS / "towers12.cdl", "-o", target, folder=tmp_path)
    assert ran.status == 1
    assert "error[cannot-write]" in ran.shown
    assert is_unbroken(ran.shown)


@pytest.mark.parametrize(
    ("options", "environment"),
    [((), {"NO_COLOR": "1"}), ((), {"TERM": "dumb"}), (("--format", "json"), {})],
)
def test_no_line_where_none_is_wanted(
    options: tuple[str, ...], environment: dict[str, str], tmp_path: Path
) -> None:
    hard = towers(tmp_path, 150)
    ran = on_terminal(
        "plan", hard, "--time-limit", "0.8", *options, folder=tmp_path, environment=environment
    )
    assert ran.status == 4
    assert "searching" not in ran.shown
    assert "\x1b" not in ran.shown
