"""Mistakes in the syntax: each is reported once, at its place, and hides no other."""

import pytest
from checking import check_text

HEAD = """typedef block
feature f(x: block)
feature g(x: block) -> int64
controller c(x: block)
"""


def behavior(body: str = "assert f(x)", eff: str = "f[x] = True") -> str:
    """A behavior whose body starts in line 8 of the file; `body` and `eff` hold several lines."""
    lines = ["behavior r(x: block):", "  goal: f(x)", "  body:", *_indented(body)]
    return HEAD + "\n".join([*lines, "  eff:", *_indented(eff)]) + "\n"


def _indented(text: str) -> list[str]:
    return [f"    {line}" for line in text.split("\n")]


# Each text with the lines and codes of all that is to be said about it.
CASES: dict[str, tuple[str, list[tuple[int, str]]]] = {
    "colon after behavior": (behavior().replace("block):", "block)"), [(5, "missing-colon")]),
    "colon after section": (behavior().replace("body:", "body"), [(7, "missing-colon")]),
    "colon after if and else": (
        behavior("if f(x)\n  achieve f(x)\nelse\n  assert f(x)"),
        [(8, "missing-colon"), (10, "missing-colon")],
    ),
    "colon after foreach": (
        behavior("foreach y: block\n  achieve f(y)"),
        [(8, "missing-colon")],
    ),
    "colon after def": (HEAD + "def h(x: block) -> bool\n  return f(x)\n", [(5, "missing-colon")]),
    "colon after controller": (
        HEAD + "controller d(x: block)\n  eff:\n    f[x] = True\n",
        [(5, "missing-colon")],
    ),
    "bracket in a body": (
        behavior("assert (f(x)\nachieve f(x"),
        [(8, "unclosed-bracket"), (9, "unclosed-bracket")],
    ),
    "bracket that would swallow definitions": (
        HEAD + "feature h(x: block\nfeature k(x: blok)\ncontroller d(x: block)\nfoo\n",
        [(5, "unclosed-bracket"), (6, "unknown-type"), (8, "syntax-error")],
    ),
    "bracket that would swallow sections": (
        behavior("assert f(x", "f[x = True\nq[x] = True"),
        [(8, "unclosed-bracket"), (10, "unclosed-bracket"), (11, "unknown-feature")],
    ),
    "bracket in a feature that others use": (
        "typedef block\nfeature f(x: block\nbehavior r(x: block):\n  goal: f(x)\n",
        [(2, "unclosed-bracket")],
    ),
    "stray closing bracket": (behavior("assert f(x))"), [(8, "unmatched-bracket")]),
    "brackets of two kinds": (behavior("assert f(x]"), [(8, "unmatched-bracket")]),
    "closing bracket alone": (behavior(")\nassert f(x)"), [(8, "unmatched-bracket")]),
    "too much indentation": (
        behavior("assert f(x)\n  achieve f(x)\n  achieve q(x)"),
        [(9, "unexpected-indentation"), (10, "unknown-feature")],
    ),
    "indentation of no block": (
        behavior("if f(x):\n    achieve f(x)\n  achieve f(x)"),
        [(10, "inconsistent-indentation")],
    ),
    "indented definition": (
        "typedef block\n  feature f(x: block)\nfeature g(x: blok)\n",
        [(2, "unexpected-indentation"), (3, "unknown-type")],
    ),
    "indented first line": (
        "    typedef block\nfeature f(x: block)\n",
        [(1, "unexpected-indentation")],
    ),
    "statement under a feature": (
        "typedef block\nfeature f(x: block)\n  achieve f(x)\nfeature g(x: block)\n",
        [(3, "unexpected-indentation")],
    ),
    "tabs": (
        HEAD + "behavior r(x: block):\n\tbody:\n\t\tassert f(x)\n",
        [(6, "tab-in-indentation"), (7, "tab-in-indentation")],
    ),
    "body without block": (
        behavior().replace("    assert f(x)\n", ""),
        [(7, "expected-block")],
    ),
    "body without indentation": (
        behavior().replace("    assert f(x)", "  assert f(x)\n  achieve q(x)"),
        [(7, "expected-block"), (9, "unknown-feature")],
    ),
    "behavior without sections": (
        HEAD + "behavior r(x: block):\nfeature h(x: blok)\n",
        [(5, "expected-block"), (6, "unknown-type")],
    ),
    "behavior without indentation": (
        HEAD + "behavior r(x: block):\ngoal: f(x)\neff:\n  f[x] = True\n",
        [(5, "expected-block")],
    ),
    "behavior without indentation, sections with": (
        HEAD + "behavior r(x: block):\ngoal: f(x)\n  body:\n    achieve q(x)\n",
        [(5, "expected-block"), (8, "unknown-feature")],
    ),
    "def with sections": (
        behavior("achieve q(x)").replace("behavior", "def"),
        [(6, "syntax-error"), (8, "unknown-feature")],
    ),
    "precondition before body": (
        behavior().replace("  body:", "  precondition: f(x)\n  body:"),
        [(7, "syntax-error")],
    ),
    "where without colon": (
        behavior("bind y: block where q(y)\nachieve f(y)"),
        [(8, "syntax-error"), (8, "unknown-feature")],
    ),
    "sequential promotable": (
        behavior("sequential promotable:\n  achieve q(x)"),
        [(8, "syntax-error"), (9, "unknown-feature")],
    ),
    "a tab in a line among spaces": (
        behavior().replace("    assert f(x)", "\tassert f(x)\n    assert q(x)"),
        [(8, "tab-in-indentation"), (9, "unknown-feature")],
    ),
    "behavior at the end": (HEAD + "behavior r(x: block):", [(5, "expected-block")]),
    "if without block": (behavior("if f(x):\nassert f(x)"), [(8, "expected-block")]),
    "stray text": (
        HEAD + "hello world\nfeature h(x: blok)\n",
        [(5, "syntax-error"), (6, "unknown-type")],
    ),
    "stray text in a behavior": (
        behavior().replace("  body:\n    assert", "  blah blah\n  body:\n    assert"),
        [(7, "syntax-error")],
    ),
    "effect:": (behavior(eff="q[x] = True").replace("eff:", "effect:"),
                [(9, "syntax-error"), (10, "unknown-feature")]),
    "precondition:": (behavior().replace("body:", "precondition:"), [(7, "syntax-error")]),
    "foo:": (behavior().replace("body:", "foo:"), [(7, "syntax-error")]),
    "behaviour, function, predicate": (
        behavior().replace("behavior", "behaviour")
        + "function h(x: block) -> bool\npredicate p(x: block)\n"
        + "behavior s(x: block):\n  goal: p(x)\n  body:\n    assert h(x)\n    achieve q(x)\n",
        [(5, "syntax-error"), (11, "syntax-error"), (12, "syntax-error"), (17, "unknown-feature")],
    ),
    "= for ==": (
        behavior("assert g(x) = 1\nif g(x) = q(x):\n  pass"),
        [(8, "syntax-error"), (9, "syntax-error"), (9, "unknown-feature")],
    ),
    "&& and || and !": (
        behavior("assert f(x) && f(x)\nassert f(x) || !q(x)"),
        [(8, "syntax-error"), (9, "syntax-error"), (9, "syntax-error"), (9, "unknown-feature")],
    ),
    "single quotes": (
        "domain 'blo(cks'\n" + HEAD.replace("x: block)", "x: blok)", 1),
        [(1, "syntax-error"), (3, "unknown-type")],
    ),
    "while": (
        behavior("while f(x):\n  do c(x)\n  achieve = 1\nachieve q(x)"),
        [(8, "while-loop"), (10, "syntax-error"), (11, "unknown-feature")],
    ),
    "do without call": (behavior("do\ndo c"), [(8, "syntax-error"), (9, "syntax-error")]),
    "statements under behavior": (
        HEAD + "behavior r(x: block):\n  achieve f(x)\n  do c(x)\n  f[x] = True\n",
        [(6, "syntax-error")],
    ),
    "quantifier in the middle": (
        behavior("assert f(x) == exists y: block: f(y)\nassert (exists y: block: f(y)) and f(x)"),
        [(8, "syntax-error")],
    ),
    "assignment to a call": (behavior(eff="f(x) = True\nq[x] = True"),
                             [(10, "call-for-index"), (11, "unknown-feature")]),
    "unterminated string": (
        'domain "blo(cks\n' + HEAD.replace("x: block)", "x: blok)", 1),
        [(1, "syntax-error"), (3, "unknown-type")],
    ),
    "elif without if": (
        behavior("elif f(x):\n  achieve q(x)\nassert f(x)"),
        [(8, "syntax-error")],
    ),
    "else alone": (behavior("else:\n  pass\nassert f(x)"), [(8, "syntax-error")]),
    "two elses": (
        behavior("if f(x):\n  pass\nelse:\n  pass\nelse:\n  pass\nachieve q(x)"),
        [(12, "syntax-error"), (14, "unknown-feature")],
    ),
    "else if": (
        behavior("if f(x):\n  pass\nelse if q(x):\n  pass\nelse:\n  pass"),
        [(10, "syntax-error"), (10, "unknown-feature")],
    ),
    "None and true": (
        behavior("assert g(x) == None", "f[x] = true"),
        [(8, "unknown-name"), (10, "unknown-name")],
    ),
    "x.y": (behavior("assert x.f\nachieve q(x)"), [(8, "syntax-error"), (9, "unknown-feature")]),
    "and without operand": (
        behavior("assert and f(x)\nassert f(x) and\nassert f(x) or or f(x)"),
        [(8, "syntax-error"), (9, "syntax-error"), (10, "syntax-error")],
    ),
    "<>": (behavior("assert g(x) <> 1"), [(8, "syntax-error")]),
    "!= is fine": (behavior("assert g(x) != 1"), []),
    "lambda": (behavior("let h = lambda y: f(y)\nassert h"), [(8, "syntax-error")]),
    "import": (
        "import blocks\nfrom blocks import x\n" + HEAD,
        [(1, "reserved-word"), (2, "syntax-error")],
    ),
    "for over objects": (
        behavior("for y: block:\n  achieve f(y)\nforeach z in block:\n  achieve f(z)"),
        [(8, "syntax-error"), (10, "syntax-error")],
    ),
    "for in objects": (behavior("for y in block:\n  achieve f(y)"), [(8, "syntax-error")]),
    "type before name": (
        HEAD + "behavior r(block x):\n  goal: f(x)\n  body:\n    achieve ,\n",
        [(5, "syntax-error"), (8, "syntax-error")],
    ),
    "a bind that cannot be read": (
        behavior("bind y block where: f(y)\nachieve f(y)"),
        [(8, "syntax-error")],
    ),
    "two conditions": (
        HEAD + "behavior r(x: block):\n  goal:\n    f(x)\n    g(x)\n  eff:\n    q[x] = True\n",
        [(8, "syntax-error"), (10, "unknown-feature")],
    ),
    "braces": (
        HEAD + "behavior r(x: block) {\n  goal: f(x)\n}\n",
        [(5, "syntax-error"), (7, "syntax-error")],
    ),
    "five in five definitions": (
        ("typdef block\nfeature f(x block)\ncontroller c(x: block\nbehavior r(x: block)\n"
         "  goal: f(x) == = 1\nfeature q(x: blok)\n"),
        [(1, "syntax-error"), (2, "syntax-error"), (3, "unclosed-bracket"), (4, "missing-colon"),
         (5, "syntax-error"), (6, "unknown-type")],
    ),
    "three in one body": (
        behavior("assert f(x) f(x)\nachieve f(x)\ndo c x\nif f(x\n  pass\nbind y where: ="),
        [(8, "syntax-error"), (10, "syntax-error"), (11, "unclosed-bracket"), (13, "syntax-error")],
    ),
    "three facts": (
        ('problem "p"\ndomain "__empty__"\nobjects:\n  a, b object\n  c: object\ninit:\n'
         "  f[a = True\n  on(\n  g[a] == True\ngoal:\n  c == c\n"),
        [(4, "syntax-error"), (7, "unclosed-bracket"), (8, "unclosed-bracket"),
         (9, "unknown-feature"), (9, "syntax-error")],
    ),
    "title without quotes": (
        "problem sussman\ndomain blocks\nobjects:\n  a: block\ninit:\n  f[a] = True\ngoal: f(a)\n",
        [(1, "syntax-error"), (2, "syntax-error")],
    ),
    "missing include": (
        'include "gone.cdl"\nbehavior r(x: block):\n  goal: f(x)\n  body:\n    do c(x)\n',
        [(1, "unreadable-file")],
    ),
    "generator whose goal cannot be read": (
        "typedef T\nfeature f(x: T)\ngenerator g(x: T):\n  goal: f(x\n  in: x\n",
        [(4, "unclosed-bracket")],
    ),
    "function whose return cannot be read": (
        ("typedef T\nfeature f(x: T)\ndef h(x: T) -> bool:\n  if f(x):\n    return = 1\n"
         "  else:\n    return f(x)\n"),
        [(5, "syntax-error")],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_every_mistake_is_reported_once_and_in_order(name: str) -> None:
    text, expected = CASES[name]
    checked = check_text(text)
    assert checked.places == expected, checked.text


HINTS = {
    behavior().replace("eff:", "effect:"): "did you mean `eff`?",
    behavior().replace("body:", "precondition:"): "a precondition is an `assert` in the `body:`",
    behavior("not f(x)"): "to make it false: `f[x] = False`; to require it: `assert not f(x)`",
    behavior("bind y: block where f(y)\nachieve f(y)"): "a colon follows `where`",
    behavior("sequential promotable:\n  achieve f(x)"): "write `promotable sequential:`",
    behavior().replace("behavior", "def"): "sections belong to a `behavior`, not to a `def`",
    behavior("block y = x"): "a cell is written `f[x] = e`, a new variable `let v = e`",
    "// comment\nfeature f()\n": "comments start with `#`",
    "controller c(x: object) -> bool\n": "only features and functions have a value",
    behavior().replace("behavior", "behaviour"): "did you mean `behavior`?",
    "function f(x: object)\n": "did you mean `def`?",
    "predicate f(x: object)\n": "did you mean `feature`?",
    "feature f(x: object): bool\n": "the type of its value follows `->`",
    behavior("assert g(x) = 1"): "compare with `==`",
    behavior("assert f(x) && f(x)"): "the operator is `and`",
    behavior("assert !f(x)"): "the operator is `not`",
    "domain 'x'\nfeature f()\n": "strings are written with double quotes",
    'domain "x\nfeature f()\n': "the string is not closed on its line",
    behavior("do"): "`do` runs a controller: `do c(x)`",
    HEAD + "behavior r(x: block):\n  f[x] = True\n": (
        "statements stand under `body:`, assignments to features under `eff:`"
    ),
    behavior("assert f(x) == exists y: block: f(y)"): (
        "a quantifier in the middle of an expression needs parentheses around it"
    ),
    behavior(eff="f(x) = True"): "write `f[x]`",
    behavior("else:\n  pass"): "there is no `if` right before this `else`",
    behavior("assert g(x) == None"): "there is no such value: every feature has one of its type",
    behavior(eff="f[x] = true"): "write `True`",
    behavior("assert x.f"): "features are read as `f(x)` or `f[x]`, not as `x.f`",
    behavior("assert g(x) <> 1"): "not equal is `!=`",
    behavior("let h = lambda y: f(y)"): (
        "name the function with `def f(x: T) -> T:` at the top level"
    ),
    behavior("for y: block:\n  pass"): "over the objects of a type: `foreach x: T:`",
    behavior("foreach y in block:\n  pass"): "write `foreach y: T`",
    behavior(eff="g[x]++"): "to count, write `f[x] += 1`",
    behavior("assert f(x) -> f(x)"): "`a -> b` is `not a or b`",
    behavior("assert f(x), f(x)"): "join conditions with `and`",
    behavior("assert g(x) ≤ 1"): "write `<=`",
    "(define (domain blocks))\n": "this looks like PDDL; `cdlc import` translates it",
    behavior("for y in blocks:\n  pass"): (
        "over the objects of a type: `foreach x: T:`; over numbers: `range(n)`"
    ),
    behavior("y = bind block"): "`bind` introduces the variable itself: `bind x: T where: c`",
    behavior("bind y: block such that f(y)"): (
        "the condition of a `bind` follows a colon: `bind x: T where: c`"
    ),
    behavior("bind y: block where"): "the condition follows a colon: `bind x: T where: c`",
    "typedef a, b\n": "each type has a line of its own",
    "typedef a = object\n": "a more special type is written `typedef T: object`",
    "feature handempty\n": "without parameters it is `feature handempty()`",
    "feature clear(?x - block)\n": (
        "variables are plain names; a parameter is written `name: type`"
    ),
    behavior(eff="f[x] == True"): "assign with `=`",
    behavior(eff="f[x] := True"): "assign with `=`",
    behavior(eff="f[x][x] = True"): "all arguments stand in one pair of brackets: `f[x, y]`",
    behavior(eff="f[x] = f(x) ? True : False"): (
        "a choice between two values is written `a if c else b`"
    ),
    behavior("assert x in block"): (
        "a type is no set: a variable over it is `exists x: T: c` or `forall x: T: c`"
    ),
    behavior("assert any(f(y) for y in block)"): (
        "`any(… for x in T)` is `exists x: T: …`, and `all(…)` is `forall x: T: …`"
    ),
    behavior('assert f(x), "no f"'): "`assert` has no message; a comment can say it: `# …`",
    behavior("y: block = x"): "a cell is written `f[x] = e`, a new variable `let v = e`",
    behavior(eff="y = x"): "a new variable is introduced by `let`: `let y = …`",
    behavior(
        'bind y: block where: f(y)\ndo c("x")'
    ): "objects are written as names, without quotes",
    "feature größe()\n": "names are made of the letters a-z and A-Z, digits and `_`",
}


@pytest.mark.parametrize("text", HINTS, ids=HINTS.values())
def test_mistakes_of_users_of_other_languages_get_advice(text: str) -> None:
    first = check_text(text).diagnostics[0]
    assert [help_.text for help_ in first.help()] == [HINTS[text]]


def test_a_replacement_mends_the_text() -> None:
    text = behavior("assert g(x) = 1\nassert !f(x) && f(x)").replace("eff:", "effect:")
    for diagnostic in reversed(check_text(text).diagnostics):
        replacement = diagnostic.help()[0].replacement
        assert replacement is not None
        place, lines = replacement.location, text.split("\n")
        line = lines[place.line - 1]
        start, end = place.column - 1, place.end_column - 1
        lines[place.line - 1] = line[:start] + replacement.text + line[end:]
        text = "\n".join(lines)
    assert check_text(text.replace("not", "not ")).codes == []


@pytest.mark.parametrize("end", ["!", '"x', "f(x) &&"])
def test_places_are_in_the_text_after_a_correction_at_its_end(end: str) -> None:
    text = behavior(eff=f"f[x] = {end}").rstrip()
    for diagnostic in check_text(text).diagnostics:
        line = text.split("\n")[diagnostic.location.end_line - 1]
        assert diagnostic.location.end_column <= len(line) + 1
