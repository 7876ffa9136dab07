"""The grammar: free of conflicts, one language by definition and by file, contextual names."""

from pathlib import Path

import pytest
from checking import check_text

from cdlc.diagnostics import Collector
from cdlc.frontend import grammar, syntax
from cdlc.frontend.layout import flatten, read_lines
from cdlc.frontend.parser import parse
from cdlc.source import SourceFile

ROOT = Path(__file__).parents[3]
FILES = sorted([*ROOT.glob("examples/**/*.cdl"), *ROOT.glob("tests/errors/*/good*.cdl")])

SOFT = [
    "domain",
    "problem",
    "include",
    "typedef",
    "object_constant",
    "feature",
    "def",
    "controller",
    "behavior",
    "action",
    "generator",
    "goal",
    "body",
    "eff",
    "in",
    "out",
    "objects",
    "init",
    "minimize",
    "sequential",
    "unordered",
    "alternative",
    "promotable",
    "each",
    "where",
]
HARD = [
    "and",
    "or",
    "not",
    "if",
    "elif",
    "else",
    "for",
    "foreach",
    "forall",
    "exists",
    "let",
    "assert",
    "achieve",
    "achieve_once",
    "do",
    "bind",
    "commit",
    "return",
    "pass",
    "break",
    "continue",
    "True",
    "False",
]
RESERVED = [
    "symbol",
    "assert_hold",
    "assert_once",
    "achieve_hold",
    "pachieve",
    "untrack",
    "preamble",
    "critical",
    "mem_query",
    "findall",
    "findone",
    "batched",
    "heuristic",
    "undirected_generator",
    "import",
]


def test_grammar_has_no_conflicts() -> None:
    """lark's strict mode also compares the terminals with each other."""
    built = grammar.build(grammar.grammar_text(), strict=True)
    assert {"file", *grammar.STARTS} <= set(built.options.start)


@pytest.mark.parametrize("file", FILES, ids=lambda file: f"{file.parent.name}/{file.name}")
def test_definition_by_definition_reads_what_the_file_rule_reads(file: Path) -> None:
    text = file.read_text(encoding="utf-8")
    source, found = SourceFile("x", text), Collector()
    module = parse(source, found)
    assert not found.found
    assert module.definitions == by_file_rule(source)


def by_file_rule(source: SourceFile) -> tuple[syntax.Definition, ...]:
    parser = grammar.parser().parse_interactive(start="file")
    for line in read_lines(source, grammar.parser().lex(source.text), Collector()):
        for token, _line in flatten(line):
            parser.feed_token(token)
    definitions: tuple[syntax.Definition, ...] = parser.feed_eof()
    return definitions


def test_the_keywords_are_those_of_the_reference() -> None:
    spelled = {t.pattern.value for t in grammar.parser().terminals if t.pattern.type == "str"}
    assert {word for word in spelled if word.isidentifier()} == {*SOFT, *HARD}


AS_NAMES = """
typedef {0}
typedef {0}_sub: {0}
object_constant {0}_1: {0}
feature {0}(x: {0}) -> bool
feature f(x: {0}) -> bool
feature g(p: {0}_sub)
def h(y: {0}) -> bool:
  let z = {0}(y)
  return z and forall v: {0}: {0}(v)
controller c(y: {0})
behavior r(y: {0}, {0}_2: {0}):
  goal: {0}(y)
  body:
    bind z: {0} where: {0}(z) and not {0}[y]
    promotable:
      achieve {0}(z)
    foreach w: {0}:
      achieve {0}(w)
    c(z)
  eff:
    {0}[y] = True
    foreach w: {0}:
      f[w] = {0}(w)
"""


@pytest.mark.parametrize("word", SOFT)
def test_contextual_keywords_are_names(word: str) -> None:
    assert check_text(AS_NAMES.format(word)).codes == []


AS_FUNCTION = """
typedef T
feature f(x: T)
def {0}(x: T) -> bool
behavior r(x: T):
  goal: f(x)
  body:
    assert {0}(x)
  eff:
    f[x] = {0}(x)
"""
AS_CONTROLLER = """
typedef T
feature f(x: T)
controller {0}(x: T)
behavior r(x: T):
  goal: f(x)
  body:
    do {0}(x)
    {0}(x)
  eff:
    f[x] = True
"""
AS_LOCAL = """
typedef T
feature f(x: T)
behavior r({0}: T):
  goal: f({0})
  body:
    let q = f({0})
    assert q
  eff:
    f[{0}] = True
behavior s(x: T):
  body:
    let {0} = f(x)
    assert {0}
    if {0}:
      achieve f(x)
"""


@pytest.mark.parametrize("text", [AS_FUNCTION, AS_CONTROLLER, AS_LOCAL])
@pytest.mark.parametrize("word", SOFT)
def test_contextual_keywords_name_functions_controllers_and_locals(word: str, text: str) -> None:
    assert check_text(text.format(word)).codes == []


@pytest.mark.parametrize("word", [w for w in SOFT if w != "in"])
def test_contextual_keywords_are_variables(word: str) -> None:
    text = "typedef T\nfeature f(x: T)\nbehavior r(x: T):\n  body:\n"
    text += f"    foreach {word}: T:\n      achieve f({word})\n"
    text += f"    for {word} in range(2):\n      achieve f(x)\n"
    text += f"    assert exists {word}: T: f({word})\n"
    assert check_text(text).codes == []


DECLARING = ["typedef {}", "feature {}(x: object)", "def {}(x: object)", "feature f({}: object)"]


@pytest.mark.parametrize("declaration", DECLARING)
@pytest.mark.parametrize("word", HARD)
def test_reserved_words_are_no_names(word: str, declaration: str) -> None:
    checked = check_text(declaration.format(word) + "\nfeature ok()\n")
    assert checked.codes == ["syntax-error"]
    (diagnostic,) = checked.diagnostics
    assert diagnostic.message() == f"unexpected `{word}`"
    assert [h.text for h in diagnostic.help()] == [
        f"`{word}` is a reserved word; choose another name"
    ]


@pytest.mark.parametrize("declaration", DECLARING)
@pytest.mark.parametrize("word", RESERVED)
def test_words_of_other_versions_are_no_names(word: str, declaration: str) -> None:
    checked = check_text(declaration.format(word) + "\nfeature ok()\n")
    assert checked.codes == ["reserved-word"]
    assert f"`{word}`" in checked.text


@pytest.mark.parametrize("word", RESERVED)
def test_words_of_other_versions_get_advice_where_they_stand(word: str) -> None:
    text = f"feature f(x: object)\nbehavior r(x: object):\n  body:\n    {word} f(x)\n    f(y)\n"
    checked = check_text(text)
    assert checked.places[0] == (4, "reserved-word")
    assert checked.diagnostics[0].help()


@pytest.mark.parametrize("word", [*HARD, *RESERVED])
def test_longer_names_are_no_keywords(word: str) -> None:
    assert check_text(f"feature {word}s(x: object)\nfeature _{word}(x: object)\n").codes == []


def test_spans_are_those_of_the_text() -> None:
    text = "typedef T\nfeature f(x: T) -> bool\n"
    first, second = parse(SourceFile("x", text), Collector()).definitions
    assert text[slice(*first.span)] == "typedef T"
    assert isinstance(second, syntax.Feature)
    assert text[slice(*second.name.span)] == "f"
    assert text[slice(*second.span)] == "feature f(x: T) -> bool"
