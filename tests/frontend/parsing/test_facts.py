"""The fast ways for plain facts and objects agree with the grammar and with the checker."""

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from typing import Any

import pytest
from checking import check_text
from hypothesis import example, given
from hypothesis import strategies as st

from cdlc.diagnostics import Collector
from cdlc.driver import compilation
from cdlc.frontend import check_statements, facts, grammar, syntax
from cdlc.frontend.parser import parse
from cdlc.source import SourceFile

LINES = [
    "on[a, b] = True",
    "on[a,b]=False",
    "on[ a, b ] = True",
    "clear[a] = True  # a comment",
    "size[a] = 3",
    "size[a] = -3",
    "size[a] = - 3",
    "size[a] = 2.5",
    "size[a] = 1e3",
    "size[a] = " + "9" * 60,
    "size[a] += 1",
    "handempty[...] = True",
    "goal[in] = True",
    "on[a, not] = True",
    "symbol[a] = True",
    "on(a, b) = True",
    "on[a, b] = True;",
    "on[a, b] = True; clear[a] = True",
    "[[pddl]] on[a, b] = True",
    "on[a, on(b, c)] = True",
    "on[a",
    "on[a, b] = (True",
    'name[a] = "x # y ["',
    "foreach x: block:",
    "foreach x: block: clear[x] = True",
    "if clear(a):",
    "else:",
    "",
    "# a comment (",
    "a, b: block",
    "a ,b : block  # two",
    "a, True: block",
    "a: block[]",
    "pass",
]
blocks = st.lists(
    st.tuples(st.sampled_from(["  ", "  ", "  ", "  ", "    ", "", "\t"]), st.sampled_from(LINES)),
    max_size=12,
)
ends = st.sampled_from(["\n", "\n", "\r\n"])


@example("init:", [("    ", LINES[0]), ("  ", "foreach x: block:"), ("    ", LINES[0])], "\n")
@given(st.sampled_from(["init:", "objects:", "init :  # facts", "init"]), blocks, ends)
def test_the_scanner_reads_what_the_grammar_reads(
    header: str, lines: list[tuple[str, str]], end: str
) -> None:
    body = end.join([header, *(indentation + line for indentation, line in lines)])
    for text in (body, f"feature f(x: block){end}{body}{end}goal: f(a){end}"):
        assert _read(text, facts.lex) == _read(text, _lex_plainly)


def _lex_plainly(text: str) -> facts.Tokens:
    return facts.Tokens(list(grammar.parser().lex(text)))


def _read(text: str, lex: Any) -> Any:
    found = Collector()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(facts, "lex", lex)
        module = parse(SourceFile("x", text), found)
    return module, list(_spans(module)), found.sorted()


def _spans(node: object) -> Iterator[Any]:
    """All spans of a tree, which equality leaves out."""
    if isinstance(node, tuple):
        for part in node:
            yield from _spans(part)
    elif is_dataclass(node):
        yield type(node).__name__, getattr(node, "span", None)
        for field in fields(node):
            yield from _spans(getattr(node, field.name))


HEAD = """problem "p"
domain "__empty__"
typedef block
typedef table
typedef red: block
feature on(x: block, y: block)
feature clear(x: block)
feature size(x: block) -> int64
feature handempty()
objects:
  a, b: block
  c: red
  t: table
goal: clear(a)
init:
"""


FACTS = [
    "on[a, b] = True", "on[c, a] = False", "clear[t] = True", "clear[d] = True",
    "clear[a, b] = True", "clear[a] = 1", "size[a] = 3", "size[a] = True", "clear(a) = True",
    "handempty[...] = True", "on[a, on] = True", "a[b] = True",
]  # fmt: skip


@given(st.lists(st.sampled_from(FACTS), min_size=1, max_size=8))
def test_facts_are_checked_as_all_assignments(lines: list[str]) -> None:
    text = HEAD + "".join(f"  {line}\n" for line in lines)
    fast = _checked(text)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(check_statements, "check_fact", lambda node, context: None)
        slow = _checked(text)
    assert fast == slow


def _checked(text: str) -> Any:
    checked = check_text(text)
    if checked.codes:
        return checked.diagnostics
    statement = compilation(["-"], read_standard_input=text.encode).statement
    assert statement is not None
    return [(repr(s), list(_locations(s))) for s in statement.init]


def _locations(node: object) -> Iterator[Any]:
    if isinstance(node, tuple):
        for part in node:
            yield from _locations(part)
    elif is_dataclass(node):
        yield getattr(node, "location", None)
        for field in fields(node):
            if field.name != "location":
                yield from _locations(getattr(node, field.name))


def test_long_sections_are_read_fast() -> None:
    lines = [f"  on[b{i}, b{i + 1}] = True" for i in range(1_000)]
    objects = ", ".join(f"b{i}" for i in range(1_001))
    text = f"objects:\n  {objects}: block\ninit:\n" + "\n".join(lines)
    lexed = facts.lex(text)
    assert sum(map(len, lexed.read.values())) == 1_001
    assert len(lexed.tokens) < 20


def test_words_that_are_no_names_are_those_of_the_grammar() -> None:
    terminals = {t.name: t.pattern for t in grammar.parser().terminals}
    words = {p.value for p in terminals.values() if p.type == "str" and p.value.isidentifier()}
    reserved = set(terminals["RESERVED"].value.partition("(")[2].partition(")")[0].split("|"))
    as_names = {word for word in words if not parse_type(word).found}
    assert (words - as_names) | reserved == facts.NOT_NAMES


def parse_type(word: str) -> Collector:
    found = Collector()
    module = parse(SourceFile("x", f"typedef {word}\n"), found)
    assert found.found or isinstance(module.definitions[0], syntax.TypeDefinition)
    return found
