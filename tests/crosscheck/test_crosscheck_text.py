"""The table, and the bar on a terminal."""

import io

import pytest

from cdlc.crosscheck.progress import Progress
from cdlc.crosscheck.results import Comparison, Excluded, Outcome, Side
from cdlc.crosscheck.text import remarks, summary, table
from crow.plan import Result, Step


def step(controller: str | None) -> Step:
    return Step("act", ("a",), {}, controller, ("a",))


PLAN = Result("plan", "kairos", (step("go"),), cost=7.5, statistics={"seconds": 1.234})
NONE = Result("unsolvable", "auto", statistics={"seconds": 0.0}, explanation="`p(a)`")


def test_columns_are_as_wide_as_they_need_to_be() -> None:
    rows = [
        Comparison("p.cdl", Outcome.AGREE_PLAN, "", Side(PLAN), Side(PLAN)),
        Comparison("long_name.cdl", Outcome.NOT_COMPARABLE, "why"),
    ]
    heading, *lines = table(rows).splitlines()
    places = [heading.index(word) for word in ("outcome", "planner", "its", "time", "program's")]
    for line, words in zip(
        lines,
        (
            ("agree: plan", "kairos", "1 step, cost 7.5", "1.23 s", "1 step, cost 7.5"),
            ("not comparable", "-", "-", "-", "-"),
        ),
        strict=True,
    ):
        for place, word in zip(places, words, strict=True):
            assert line[place - 2 :].startswith(f"  {word}")
        assert line == line.rstrip()
    assert remarks(rows) == "\nlong_name.cdl: not comparable: why\n"
    assert summary(rows) == "2 problems: 1 agree: plan, 1 not comparable"


def test_steps_that_are_all_wanted_are_said_to_be() -> None:
    steps = (Excluded(step("go")), Excluded(step(None)))
    row = Comparison("p", Outcome.OUTSIDE, "why", Side(PLAN), Side(NONE), steps)
    assert remarks([row]).splitlines() == [
        "", "p: outside: why", "  1. go(a)  by act(a)", "  2. -      by act(a)",
        "  each step is wanted somewhere, but not in this order or with these objects",
        "  the program came as far as `p(a)`",
    ]  # fmt: skip


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_the_bar_is_for_terminals_only(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("NO_COLOR", raising=False)
    terminal = Terminal()
    bar = Progress(terminal, 2, is_wanted=True)
    bar.show("p.cdl", "compiling")
    bar.advance()
    bar.show("q.cdl", "x" * 500)
    bar.clear()
    first, second = terminal.getvalue().split("\r\033[K")[1:3]
    assert first == "[....................] 0/2 p.cdl: compiling"
    assert second.startswith("[##########..........] 1/2 q.cdl: xxx")
    assert len(second) < 100
    for stream, wanted in ((io.StringIO(), True), (Terminal(), False)):
        silent = Progress(stream, 2, is_wanted=wanted)
        silent.show("p.cdl", "compiling")
        silent.clear()
        assert stream.getvalue() == ""
