"""The pages of diagnostics, and the reference made from the code."""

import importlib.util
import sys

import pytest
from support import ROOT

from cdlc.explain import codes, explain, similar


@pytest.mark.parametrize("code", codes())
def test_every_code_has_a_page_with_an_example(code: str) -> None:
    page = explain(code)
    assert page is not None
    head, what, *rest = page.split("\n\n")
    assert head in (f"error[{code}]", f"warning[{code}]")
    assert what.endswith((".", "?"))
    needs_example = code not in ("not-text", "line-too-long", "tab-in-indentation")
    assert any(part.startswith("    ") for part in rest) or not needs_example
    assert not rest[-1].startswith("    "), "the cure comes after the example"


def test_codes_that_are_none() -> None:
    assert explain("unknown") is None
    assert similar("unkown-feature") == "unknown-feature"
    assert similar("UnknownFeature") == "unknown-feature"
    assert similar("unknown_feature") == "unknown-feature"
    assert similar("something else") is None


def test_the_reference_is_current() -> None:
    path = ROOT / "tools" / "reference.py"
    spec = importlib.util.spec_from_file_location("reference", path)
    assert spec is not None
    assert spec.loader is not None
    reference = importlib.util.module_from_spec(spec)
    sys.modules["reference"] = reference
    spec.loader.exec_module(reference)
    for name, text in reference.pages().items():
        file = reference.FOLDER / name
        assert file.read_text(encoding="utf-8") == text, "run `python tools/reference.py`"
