"""However a source is laid out, formatting keeps its tree and comments, and settles at once."""

import re

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from layout_mutations import mutated, read
from strategies import modules
from support import EXAMPLES, ROOT

from cdlc.diagnostics import Collector
from cdlc.frontend.formatter import format_module, format_source
from cdlc.frontend.trivia import SourceTrivia
from cdlc.source import SourceFile

CORPUS = sorted([*EXAMPLES.rglob("*.cdl"), *(ROOT / "tests/golden/fmt").glob("*.cdl")])

# A few definitions at a time: whole files would take the time of many examples.
PIECES = [
    piece
    for path in CORPUS
    for piece in re.split(r"\n\n(?=[a-z])", path.read_text("utf-8-sig").strip() + "\n")
    if len(piece) < 1500
]
corpus = st.lists(st.sampled_from(PIECES), min_size=1, max_size=2).map("\n\n".join)
random_texts = modules.map(format_module)
quick = settings(
    max_examples=settings().max_examples // 2,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)


def formatted(text: str) -> str:
    found = Collector()
    result = format_source(SourceFile("mutated.cdl", text), found)
    assert result is not None, [diagnostic.message() for diagnostic in found]
    return result


def comments(text: str) -> list[str]:
    return [comment.text for comment in SourceTrivia(SourceFile("mutated.cdl", text)).comments]


def check(before: str, changed: str) -> None:
    tree = read(before)
    assert read(changed) == tree, "the mutation is no good"
    result = formatted(changed)
    assert read(result) == tree
    assert comments(result) == comments(changed)
    assert formatted(result) == result
    assert "\r" not in result
    assert not result or (result.endswith("\n") and not result.endswith("\n\n"))
    assert not any(line != line.rstrip() for line in result.split("\n"))


@quick
@given(mutated(corpus))
def test_mutated_corpus(texts: tuple[str, str]) -> None:
    check(*texts)


@quick
@given(mutated(random_texts))
def test_mutated_random_trees(texts: tuple[str, str]) -> None:
    check(*texts)
