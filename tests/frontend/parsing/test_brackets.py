"""Which words at the start of a line show that a bracket was left open, and which do not."""

import pytest

from cdlc.diagnostics import Collector
from cdlc.frontend.parser import parse
from cdlc.source import SourceFile


def codes(text: str) -> list[str]:
    found = Collector()
    parse(SourceFile("brackets.cdl", text), found)
    return [diagnostic.code for diagnostic in found]


@pytest.mark.parametrize(
    "line",
    [
        "generator[x, y]",
        "feature[[1, 2]]",
        "action[x] == y",
        "behavior",
        "typedef(x)",
        "in",
        "goal[x]",
    ],
)
def test_names_that_are_keywords_elsewhere_stand_in_brackets(line: str) -> None:
    assert codes(f"goal: (\n  {line}\n)\n") == []
    assert codes(f"goal: f(\n  {line},\n  {line}\n)\n") == []


@pytest.mark.parametrize(
    "line", ["feature f(x: T)", "feature [[min=0]] f(x: T)", "feature [[a]] [[b]] f(x: T)"]
)
def test_definitions_show_that_a_bracket_was_left_open(line: str) -> None:
    assert codes(f"goal: (\n{line}\n") == ["unclosed-bracket"]


def test_a_parameter_called_as_a_section_is_no_header() -> None:
    assert codes("feature f(a,\n  goal:\n  a)\n") == []
    assert codes("feature f(\n  body:\n  a\n)\n") == []
    assert codes("behavior b(x: a):\n  goal: f(x\n  body:\n    pass\n") == ["unclosed-bracket"]
