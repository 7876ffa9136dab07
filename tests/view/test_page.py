"""The page of a search: what is in it, and how it behaves in a real browser."""

import json
import re
from html.parser import HTMLParser
from pathlib import Path

import pytest
from browser import Browser, browser
from programs import problem_of
from support import BLOCKS, EXAMPLES, cdlc

from cdlc.driver import problem_compilation
from cdlc.view.page import Search, page
from cdlc.view.states import states_of
from crow.planning import Planning
from crow.replay import replay_to_goal
from crow.results import Plan

IMPOSSIBLE = """problem "round"
domain "{domain}"
objects:
  A, B, C: block
init:
  on_table[A] = True
  on_table[B] = True
  on[C, A] = True
  clear[C] = True
  clear[B] = True
  handempty[...] = True
goal: on(A, B) and on(B, C) and on(C, A)
"""


def traced(tmp_path: Path, *arguments: str | Path) -> Path:
    target = tmp_path / "trace.html"
    cdlc("plan", *arguments, "--trace", target)
    return target


@pytest.fixture
def impossible(tmp_path: Path) -> Path:
    file = tmp_path / "round.cdl"
    file.write_text(IMPOSSIBLE.format(domain=BLOCKS / "blocks.cdl"))
    return file


class Ids(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.ids: list[str] = []
        self.urls: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name == "id" and value:
                self.ids.append(value)
            if name in ("src", "href", "action") and value:
                self.urls.append(value)


def test_a_page_needs_nothing_else(tmp_path: Path) -> None:
    text = traced(tmp_path, BLOCKS / "sussman.cdl").read_text("utf-8")
    found = Ids()
    found.feed(text)
    assert found.urls == ["data:,"]
    assert len(found.ids) == len(set(found.ids))
    assert not re.search(r"https?://|@import|url\(", text)


HOSTILE = """
typedef T
feature p(x: T)
controller c(x: T)
behavior b(x: T):
  goal: p(x)
  body:
    do c(x)
  eff:
    p[x] = True
"""


def test_names_are_no_markup() -> None:
    text = 'problem "</script><b>&"\nobjects:\n  a: T\ninit:\n  pass\ngoal: p(a)\n'
    problem = problem_of(HOSTILE, text)
    planning = Planning(problem)
    shown = page(Search(problem, planning.first(), planning.refinement(), {}))
    assert "</script><b>" not in shown
    assert "&lt;/script&gt;&lt;b&gt;&amp;" in shown


@pytest.mark.parametrize("name", ["blocks/sussman", "jugs/four", "logistics/parcel"])
def test_states_are_those_of_the_replayer(name: str) -> None:
    problem = problem_compilation([str(EXAMPLES / f"{name}.cdl")]).plannable
    plan = Planning(problem).first()
    assert isinstance(plan, Plan)
    states = states_of(problem, plan.trace)
    replayed = replay_to_goal(problem, plan.trace).states
    values = dict(states.initial)
    for item, changes in enumerate(states.changes):
        for cell, before, after in changes:
            assert values.get(cell, before) == before
            values[cell] = after
        expected = {
            f"{feature}({', '.join(arguments)})": str(value)
            for (feature, arguments), value in replayed[item + 1].cells.items()
        }
        unset = ("False", "unset", "0")
        assert {states.cells[c]: v for c, v in values.items() if v not in unset} == expected


def test_what_never_changes_is_left_out_of_a_large_page(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cdlc.view.states.MOST_CELLS", 11)
    problem = problem_compilation([str(BLOCKS / "towers12.cdl")]).plannable
    states = states_of(problem, ())
    assert (len(states.cells), len(states.initial)) == (11, 11)
    assert states.left_out == len(problem.initial.cells) - 11


def test_a_page_that_cannot_be_written_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    ran = cdlc("plan", BLOCKS / "sussman.cdl", "--trace", tmp_path / "file" / "x.html")
    assert ran.status == 1
    assert "error[cannot-write]" in ran.err
    assert "1. unstack(C, A)" in ran.out  # the plan is there all the same


def test_searches_of_others_have_no_page(tmp_path: Path) -> None:
    target = tmp_path / "x.html"
    ran = cdlc(
        "plan", BLOCKS / "sussman.cdl", "--engine", "fast-downward", "--trace", target
    )  # fmt: skip
    assert ran.status == 2
    assert "--trace shows searches of auto, best, iddfs, iw, reference" in ran.err
    assert not target.exists()


@pytest.mark.parametrize("engine", ["auto", "best", "iddfs", "reference"])
def test_without_a_plan_there_is_a_page_too(engine: str, impossible: Path, tmp_path: Path) -> None:
    target = traced(tmp_path, impossible, "--engine", engine, "--time-limit", "0.7")
    text = target.read_text("utf-8")
    assert "no plan" in text
    assert ("it no longer holds here" in text) == (engine != "reference")


# ------------------------------------------------------------------------------- in a real browser


def text_of(page: Browser, selector: str) -> str:
    found = page.value(f"document.querySelector({json.dumps(selector)}).innerText")
    return str(found)


def test_a_plan_in_a_browser(tmp_path: Path) -> None:
    target = traced(tmp_path, BLOCKS / "sussman.cdl")
    with browser(tmp_path / "profile") as shown:
        shown.open(target)
        assert "achieve on(A, B) by r_on(A, B)" in text_of(shown, "#tree")
        assert "clear(C) already true" in text_of(shown, "#tree")
        assert text_of(shown, "#cells").split() == [
            "clear(B)", "clear(C)", "handempty()", "on(C,", "A)", "on_table(A)", "on_table(B)",
        ]  # fmt: skip

        shown.click("#steps li:nth-child(1)")
        assert text_of(shown, "#where") == "After step 1, unstack(C, A)"
        assert "holding(C): False → True" in text_of(shown, "#changed")
        assert "on(C, A): True → False" in text_of(shown, "#changed")
        assert "unstack(y, x)" in text_of(shown, "#place")
        assert shown.value("document.querySelectorAll('#cells .changed').length") == 5

        shown.press("ArrowDown")
        assert text_of(shown, "#where") == "After step 2, place_table(C)"
        assert "on_table(C): False → True" in text_of(shown, "#changed")

        shown.click("#n1")
        assert shown.value("document.activeElement.id") == "n1"
        before = shown.value("[...document.querySelectorAll('#tree li')].filter(x => !x.hidden)"
                             ".length")  # fmt: skip
        shown.press("ArrowLeft")
        assert shown.value("document.activeElement.getAttribute('aria-expanded')") == "false"
        after = shown.value("[...document.querySelectorAll('#tree li')].filter(x => !x.hidden)"
                            ".length")  # fmt: skip
        assert after < before
        shown.press("ArrowDown")
        assert "achieve on(A, B)" in str(shown.value("document.activeElement.innerText"))
        # What a step chooses is never hidden.
        shown.click("#steps li:nth-child(4)")
        assert shown.value("document.querySelector('#tree [aria-selected=true]').hidden") is False

        assert shown.value("document.querySelector('li.held').offsetParent") is None
        shown.click("#held")
        assert shown.value("document.querySelector('li.held').offsetParent !== null") is True
        assert shown.complaints == []
        assert {url.split(":")[0] for url in shown.requests} <= {"file", "data"}


def test_no_plan_in_a_browser_in_the_dark(impossible: Path, tmp_path: Path) -> None:
    target = traced(tmp_path, impossible, "--time-limit", "0.7")
    with browser(tmp_path / "profile") as shown:
        shown.open(target, dark=True)
        assert text_of(shown, "h1").endswith("no plan")
        assert "it no longer holds here" in text_of(shown, "#failures")
        assert "nodes" in text_of(shown, "#figures")
        assert text_of(shown, "#where").startswith("Where it failed: ")
        assert "failed" in shown.value(
            "document.querySelector('#tree [aria-selected=true]').className"
        )
        dark = shown.value("getComputedStyle(document.body).backgroundColor")
        shown.open(target, dark=False)
        assert shown.value("getComputedStyle(document.body).backgroundColor") != dark
        assert shown.value("window.scrollY") == 0
        assert shown.complaints == []
