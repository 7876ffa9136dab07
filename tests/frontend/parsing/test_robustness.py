"""Input that is no program: it ends in a diagnostic, soon, whatever it is."""

import os
import socket
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import pytest
from checking import Checked, check_file, check_text

from cdlc.driver import CompileError, compilation
from cdlc.frontend import facts, loader
from cdlc.frontend.parser import MANY_MISTAKES

HEAD = "typedef T\nfeature f(x: T)\nfeature g(x: T) -> int64\ndef h(x: T) -> T\n"


def behavior(body: str) -> str:
    return f"{HEAD}behavior r(x: T):\n  goal: f(x)\n  body:\n    {body}\n  eff:\n    f[x] = True\n"


def blocks(count: int, header: str = "if f(x):") -> str:
    """A statement under `count` headers, which stands in count + 2 blocks."""
    lines = [f"{'  ' * level}{header.format(level)}" for level in range(count)]
    lines.append("  " * count + "achieve f(x)")
    return behavior("\n    ".join(lines))


# A hundred times what is needed: it tells a slow machine from an endless computation.
ENDLESS = 60


def soon(check: Callable[[], Checked]) -> Checked:
    start = time.process_time()
    checked = check()
    assert time.process_time() - start < ENDLESS
    return checked


# ------------------------------------------------------------------------------------------ nesting


def test_ten_thousand_parentheses_are_refused_at_once() -> None:
    for closing in ("", ")" * 10_000):
        text = behavior("assert " + "(" * 10_000 + "f(x)" + closing)
        assert soon(lambda text=text: check_text(text)).codes == ["nesting-too-deep"]


@pytest.mark.parametrize(("count", "codes"), [(999, []), (1_000, ["nesting-too-deep"])])
def test_parentheses_may_nest_a_thousand_deep(count: int, codes: list[str]) -> None:
    """With those of `f(x)` inside."""
    text = behavior("assert " + "(" * count + "f(x)" + ")" * count)
    assert check_text(text).codes == codes


DEEP = {
    "calls": "assert f(" + "h(" * 900 + "x" + ")" * 901,
    "not": "assert " + "not " * 10_000 + "f(x)",
    "minus": "assert " + "- " * 10_000 + "g(x) == 1",
    "sum": "assert " + "+".join(["g(x)"] * 5_000) + " == 1",
    "power": "assert " + "**".join(["g(x)"] * 5_000) + " == 1",
    "xor": "assert " + " ^ ".join(["f(x)"] * 5_000),
    "conditional": "assert " + "f(x) if f(x) else " * 3_000 + "f(x)",
    "quantifier": "assert " + "".join(f"forall v{i}: T: " for i in range(3_000)) + "f(x)",
    "vector": "let v = " + "[" * 500 + "1" + "]" * 500,
    "range": "for i in range(" + "+".join(["1"] * 5_000) + "): pass",
    "product": "for i in range(" + "*".join(["9999"] * 5_000) + "): pass",
    "elif": "if f(x):\n      pass\n    " + "elif f(x):\n      pass\n    " * 3_000 + "pass",
    "bound type": "bind v: float32" + "[]" * 5_000,
}


@pytest.mark.parametrize("name", DEEP)
def test_deep_expressions_are_diagnosed(name: str) -> None:
    assert check_text(behavior(DEEP[name])).codes == ["nesting-too-deep"]


ALLOWED = {
    "calls": "assert f(" + "h(" * 60 + "x" + ")" * 61,
    "not": "assert " + "not " * 130 + "f(x)",
    "sum": "assert " + "+".join(["g(x)"] * 130) + " == 1",
    "and": "assert " + " and ".join(["f(x)"] * 5_000),
    "or": "assert " + " or ".join(["f(x)"] * 5_000),
    "comparison": "assert " + " <= ".join(["g(x)"] * 5_000),
    "elif": "if f(x):\n      pass\n    " + "elif f(x):\n      pass\n    " * 100 + "pass",
    "variables": "assert forall " + ", ".join(f"v{i}: T" for i in range(1_000)) + ": f(v1)",
    "statements": "assert f(x);" * 5_000,
}


@pytest.mark.parametrize("name", ALLOWED)
def test_wide_expressions_are_accepted(name: str) -> None:
    assert check_text(behavior(ALLOWED[name])).codes == []


@pytest.mark.parametrize("header", ["if f(x):", "foreach v{}: T:", "sequential:"])
@pytest.mark.parametrize(("count", "codes"), [(97, []), (98, []), (99, ["nesting-too-deep"])])
def test_blocks_may_nest_a_hundred_deep(header: str, count: int, codes: list[str]) -> None:
    """The innermost statement stands in two blocks more."""
    assert check_text(blocks(count, header)).codes == codes


def test_what_follows_too_deep_blocks_is_still_read() -> None:
    text = blocks(120) + "feature q(x: U)\n"
    assert check_text(text).codes == ["nesting-too-deep", "unknown-type"]


@pytest.mark.parametrize("order", [1, -1])
@pytest.mark.parametrize("end", ["", ": float32"])
def test_long_chains_of_types_are_diagnosed(order: int, end: str) -> None:
    chain = [*(f"typedef t{i}: t{i + 1}" for i in range(3_000)), f"typedef t3000{end}"]
    text = "\n".join([*chain[::order], "feature f(x: object) -> t0"])
    assert set(soon(lambda: check_text(text)).codes) == {"nesting-too-deep"}


def test_long_chains_of_functions_are_fine() -> None:
    chain = [f"def f{i}(x: object) -> bool:\n  return f{i + 1}(x)\n" for i in range(1_000)]
    text = "".join([*chain, "def f1000(x: object) -> bool\n"])
    assert soon(lambda: check_text(text)).codes == []
    closed = text.replace("f1000(x: object) -> bool", "f1000(x: object) -> bool:\n  return f0(x)")
    assert soon(lambda: check_text(closed)).codes == ["recursive-call"]


def test_a_nearly_full_stack_is_no_crash() -> None:
    text = behavior("assert " + "not " * 130 + "f(x)")

    def call(depth: int) -> Checked:
        return call(depth - 1) if depth else check_text(text)

    assert call(sys.getrecursionlimit() - 400).codes in ([], ["nesting-too-deep"])


# ---------------------------------------------------------------------------------- sizes and texts


def test_a_line_of_ten_megabytes_is_refused_before_it_is_lexed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(facts, "lex", None)
    for text in ("#" + "a" * 10_000_000, "feature f()\n" + "f(" * 5_000_000 + "\n"):
        checked = soon(lambda text=text: check_text(text))
        assert checked.codes == ["line-too-long"]
        assert len(checked.text) < 1_000


def test_numbers_of_any_length() -> None:
    digits = "1" * 100_000
    for number in (digits, f"{digits}.5", f"-{digits}", f"1e{digits}"):
        text = behavior(f"assert g(x) == {number}")
        checked = soon(lambda text=text: check_text(text))
        assert checked.codes == ["number-too-large"]
        assert len(checked.text) < 1_000
    for text in (f"typedef v: vector[float32, {digits}]\n", f"feature [[min=-{digits}]] f()\n"):
        soon(lambda text=text: check_text(text))


def test_a_huge_string() -> None:
    for text in ("a" * 900_000, "\\" * 900_000, "\\x" * 100_000):
        checked = soon(lambda text=text: check_text(behavior(f'assert g(x) == "{text}"')))
        assert checked.codes == ["not-comparable"]
        assert len(checked.text) < 1_000


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_line_ends(end: str) -> None:
    text = behavior("assert q(x)  # comment").replace("\n", end)
    checked = check_text(text)
    assert checked.places == [(8, "unknown-feature")]
    assert "8 |     assert q(x)  # comment\n" in checked.text


def test_byte_order_mark_and_missing_line_end() -> None:
    assert check_text(b"\xef\xbb\xbffeature f()").codes == []
    assert check_text(b"feature f() # end").codes == []


def test_form_feed_in_and_before_lines() -> None:
    assert check_text("\ffeature f()\n\f\nfeature\fg()\n\f  \nfeature h()\n").codes == []


NOT_TEXT = {
    b"feature f()\n\0": (2, 1, "it contains a NUL character"),
    b"feature f()\n# \xc3\xa4\xff": (2, 4, "it is not UTF-8"),
    "feature f()\n".encode("utf-16"): (1, 1, "it is UTF-16"),
    b"\x89PNG\r\n\x1a\n": (1, 1, "it is not UTF-8"),
    b"\xed\xa0\x80": (1, 1, "it is not UTF-8"),
}


@pytest.mark.parametrize("data", NOT_TEXT)
def test_bytes_that_are_no_text(data: bytes) -> None:
    line, column, reason = NOT_TEXT[data]
    checked = check_text(data)
    assert checked.codes == ["not-text"]
    (diagnostic,) = checked.diagnostics
    assert (diagnostic.location.line, diagnostic.location.column) == (line, column)
    assert reason in diagnostic.message()


@pytest.mark.parametrize("text", ["", "\n\n", "# only a comment", "  \t\n", "\ufeff"])
def test_files_without_definitions(text: str) -> None:
    assert check_text(text).codes == ["empty-file"]


@pytest.mark.parametrize("text", ["größe", "変数", "x\u0301", "\u202e", "\x1b31m", "😀"])
def test_other_characters_are_diagnosed_where_they_stand(text: str) -> None:
    checked = check_text(f"feature f()\nfeature {text}()\n")
    assert checked.places == [(2, "syntax-error")]
    assert all(c.isprintable() or c == "\n" for c in checked.text)


# -------------------------------------------------------------------------------------------- files


def only(checked: Checked, code: str, reason: str) -> None:
    assert checked.codes == [code]
    assert reason in checked.text


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    only(check_file(tmp_path), "unreadable-file", "is a directory")
    only(check_file(tmp_path / "gone.cdl"), "unreadable-file", "no such file")
    only(check_file("a\0b.cdl"), "unreadable-file", "not a file name")
    only(check_file("\ud800.cdl"), "unreadable-file", "not a file name")
    only(check_file("a" * 260), "unreadable-file", "too long")
    only(check_file(""), "unreadable-file", "no such file")
    link = tmp_path / "link.cdl"
    link.symlink_to(tmp_path / "gone.cdl")
    only(check_file(link), "unreadable-file", "no such file")
    loop = tmp_path / "loop.cdl"
    loop.symlink_to(loop)
    only(check_file(loop), "unreadable-file", "symbolic links")


@pytest.mark.skipif(sys.platform == "win32", reason="devices and pipes are files elsewhere only")
def test_files_that_never_end_are_not_read(tmp_path: Path) -> None:
    only(soon(lambda: check_file("/dev/zero")), "unreadable-file", "not a regular file")
    pipe = tmp_path / "pipe.cdl"
    os.mkfifo(pipe)
    done: list[Checked] = []
    thread = threading.Thread(target=lambda: done.append(check_file(pipe)), daemon=True)
    thread.start()
    thread.join(5)
    only(done[0], "unreadable-file", "not a regular file")
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(str(tmp_path / "socket"))
        assert check_file(tmp_path / "socket").codes == ["unreadable-file"]


def test_a_file_without_permission(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "secret.cdl"
    file.write_text("feature f()\n")
    file.chmod(0)
    if os.access(file, os.R_OK):  # an administrator reads everything

        def refuse(*arguments: object) -> int:
            raise PermissionError(13, "Permission denied")

        monkeypatch.setattr(os, "open", refuse)
    only(check_file(file), "unreadable-file", "permission denied")


def test_files_over_the_limit_are_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(loader, "MAX_BYTES", 1_000_000)
    file = tmp_path / "large.cdl"
    file.write_bytes(b"#" * 2_000_000)
    only(check_file(file), "unreadable-file", "over 1 MB")
    only(check_text(b"#" * 2_000_000), "unreadable-file", "over 1 MB")


def test_standard_input() -> None:
    command = [sys.executable, "-m", "cdlc", "check", "-"]
    done = subprocess.run(command, input=b"feature f(x: blok)", capture_output=True, check=False)
    assert done.returncode == 1
    assert b"--> -:1:14" in done.stderr


# ----------------------------------------------------------------------------------------- includes


def test_includes(tmp_path: Path) -> None:
    for folder in ("x", "y"):
        (tmp_path / folder).mkdir()

    def check(**texts: str) -> Checked:
        for name, text in texts.items():
            (tmp_path / f"{name}.cdl").write_text(text)
        return check_file(tmp_path / f"{next(iter(texts))}.cdl")

    assert check(a='include "b.cdl"\n', b="typedef T\nfeature f(x: T)\n").codes == []
    assert check(a='include "a.cdl"\nfeature f()\n').codes == ["include-cycle"]
    cycle = check(a='include "b.cdl"\n', b='include "a.cdl"\nfeature f()\n')
    assert cycle.codes == ["include-cycle"]
    assert cycle.diagnostics[0].location.file.endswith("b.cdl")
    missing = check(a='include "gone.cdl"\nfeature f(x: T)\n')
    assert missing.codes == ["unreadable-file"]
    assert "named here" in missing.text
    twice = check(a='include "b.cdl"\ninclude "b.cdl"\n', b="feature f()\n")
    assert twice.codes == []
    other = check(a='include "x/../b.cdl"\n', b='include "y/../a.cdl"\n')
    assert other.codes == ["include-cycle"]
    inside = check(a='include "b.cdl"\n', b="feature f(x: blok)\n")
    assert inside.codes == ["unknown-type"]
    assert inside.diagnostics[0].location.file.endswith("b.cdl")


def test_problems_and_their_domains(tmp_path: Path) -> None:
    domain = "typedef T\nfeature f(x: T)\n"
    problem = 'problem "p"\ndomain "{}"\nobjects:\n  a: T\ngoal: f(a)\n'
    (tmp_path / "d.cdl").write_text(domain)
    file = tmp_path / "p.cdl"
    file.write_text(problem.format("d.cdl"))
    assert check_file(file).codes == []
    file.write_text(problem.format("gone.cdl"))
    assert check_file(file).codes == ["unreadable-file"]
    file.write_text(problem.format("p.cdl"))
    assert check_file(file).codes == ["wrong-file-kind"]
    file.write_text(problem.format("d.cdl").replace('domain "d.cdl"\n', ""))
    assert check_file(file).codes == ["missing-part"]
    (tmp_path / "q.cdl").write_text('include "p.cdl"\nfeature q()\n')
    assert "misplaced-part" in check_file(tmp_path / "q.cdl").codes


def test_long_chains_of_includes(tmp_path: Path) -> None:
    for i in range(200):
        (tmp_path / f"{i}.cdl").write_text(f'include "{i + 1}.cdl"\n')
    (tmp_path / "200.cdl").write_text("feature f()\n")
    assert check_file(tmp_path / "0.cdl").codes == ["nesting-too-deep"]
    assert check_file(tmp_path / "150.cdl").codes == []


def test_includes_that_double(tmp_path: Path) -> None:
    for i in range(40):
        line = f'include "{i + 1}.cdl"\n'
        (tmp_path / f"{i}.cdl").write_text(line * 2)
    (tmp_path / "40.cdl").write_text("feature f()\n")
    assert soon(lambda: check_file(tmp_path / "0.cdl")).codes == []


def test_the_driver_raises_nothing_else(tmp_path: Path) -> None:
    for data in (b"\0", b"\xff", b"((", b'problem "x"\n', b'problem "x"\ndomain "-"\ngoal: x\n'):
        done = compilation(["-"], read_standard_input=lambda data=data: data)
        with pytest.raises(CompileError):
            _ = done.checked


def test_a_text_of_mistakes_has_some_for_each_definition() -> None:
    """After many of them no more repairs are tried, and what is right is read all the same."""
    wrong = "behavior b(x: T)\n  goal f(x)\n  body\n    pass\n"
    text = f"typedef T\n{wrong * MANY_MISTAKES}feature f(x: T)\nfeature other(x: U)\n"
    places = check_text(text).places
    found = Counter((line - 2) // 4 for line, code in places if code == "missing-colon")
    assert (found[0], found[MANY_MISTAKES - 1]) == (2, 1)
    assert [found[number] for number in range(MANY_MISTAKES)].count(0) == 0
    assert places[-1] == (4 * MANY_MISTAKES + 3, "unknown-type")
