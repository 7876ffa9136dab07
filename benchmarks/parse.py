"""How fast texts are read and checked, beside lark's bare LALR parse of the same tokens."""

import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from benchmarks.plot import Plot
from benchmarks.table import Table

_DOMAIN_HEAD = """domain "generated"
typedef block
feature on(x: block, y: block)
feature clear(x: block)
feature size(x: block) -> int64
controller stack(x: block, y: block)
"""
_BEHAVIOR = """
# Behavior number {0}.
behavior r_{0}(x: block, y: block):
  goal: on(x, y)
  body:
    bind z: block where: on(x, z) and (clear(z) or size(z) + 1 < size(x) * 2)
    promotable sequential:
      assert clear(y)
      achieve on(y, x)
    if exists w: block: on(w, x):
      achieve on(z, y)
    else:
      assert size(x) == {0}
    do stack(x, y)
  eff:
    on[x, z] = False
    on[x, y] = True
    size[x] = size[x] + 1
    foreach b: block:
      clear[b] = not on(x, b)
"""
_ROOT = Path(__file__).resolve().parent.parent
_SIZES = (100, 1_000, 10_000, 100_000)
_COLUMNS = ("file", "lines", "check CPU s", "lines/s", "bare lark CPU s", "ratio", "peak MB")
_NOTE = (
    "targets: linear; check at most 4 times the bare parse; 100,000 facts in at most 5 CPU s."
    " Start-up is taken off."
)


def domain(lines: int) -> str:
    """A domain of about so many lines."""
    count = max(1, (lines - 7) // _BEHAVIOR.count("\n"))
    return _DOMAIN_HEAD + "".join(_BEHAVIOR.format(number) for number in range(count))


def problem(lines: int) -> str:
    """A problem of so many facts about a tenth as many objects, ten of them a line."""
    count = max(10, lines // 10)
    names = [f"b{number}" for number in range(count)]
    objects = [f"  {', '.join(names[i : i + 10])}: block" for i in range(0, count, 10)]
    facts = [f"  on[b{i % count}, b{(i * 7 + 1) % count}] = True" for i in range(lines)]
    head = ['problem "generated"', 'domain "domain.cdl"', "objects:", *objects, "init:"]
    return "\n".join([*head, *facts, "goal:", "  on(b1, b2)", ""])


def run(quick: bool) -> Table:
    """CPU and memory of `cdlc check` for domains and problems of growing size."""
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "domain.cdl").write_text(domain(100))
        for kind, write in (("domain", domain), ("problem", problem)):
            for lines in _SIZES[: 2 if quick else None]:
                file = folder / f"{kind}{lines}.cdl"
                rows.append((kind, *_measure(file, write, lines)))
    plots = (
        Plot("lines", ("check CPU s", "bare lark CPU s"), "CPU seconds", by="file"),
        Plot("lines", ("peak MB",), "peak MB", by="file", name="-memory"),
    )
    return Table("parse", _COLUMNS, tuple(rows), _NOTE, plots)


def _measure(
    file: Path, write: Callable[[int], str], lines: int
) -> tuple[int, float, float, float, float, float]:
    file.write_text(write(lines))
    least = file.with_name("least.cdl")
    least.write_text("feature f()\n")
    count = file.read_text().count("\n")
    seconds, peak = _check(file)
    seconds = max(seconds - _check(least)[0], 0.001)
    command = [sys.executable, "-m", "benchmarks.parse", str(file)]
    bare = float(subprocess.run(command, check=True, capture_output=True, cwd=_ROOT).stdout)
    return count, seconds, count / seconds, bare, seconds / bare, peak


def _check(file: Path) -> tuple[float, float]:
    """CPU seconds and peak megabytes of `cdlc check`."""
    command = [sys.executable, "-c", _WATCHED, sys.executable, "-m", "cdlc", "check", str(file)]
    done = subprocess.run(command, check=True, capture_output=True, text=True, cwd=_ROOT)
    seconds, kilobytes = done.stdout.split()
    return float(seconds), int(kilobytes) / 1_000


# A process of its own watches each run, since peaks of memory are those of all children so far.
_WATCHED = """
import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(used.ru_utime + used.ru_stime, used.ru_maxrss)
"""


def bare_parse(text: str) -> float:
    """CPU seconds of lark alone: lexing, and its LALR parser building its trees."""
    import lark

    from cdlc.diagnostics import Collector
    from cdlc.frontend import grammar
    from cdlc.frontend.layout import flatten, read_lines
    from cdlc.source import SourceFile

    parser = lark.Lark(
        grammar.grammar_text(),
        parser="lalr",
        lexer="basic",
        start=["file"],
        maybe_placeholders=True,
        postlex=grammar.KeepTokens(),
    )
    start = time.process_time()
    lines = read_lines(SourceFile("", text), parser.lex(text), Collector())
    running = parser.parse_interactive(start="file")
    for line in lines:
        for token, _line in flatten(line):
            running.feed_token(token)
    running.feed_eof()
    return time.process_time() - start


if __name__ == "__main__":
    print(bare_parse(Path(sys.argv[1]).read_text()))
