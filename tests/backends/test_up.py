"""`--emit up`: the problem that unified-planning makes of the emitted PDDL, as its text."""

import subprocess
import sys
from pathlib import Path

import pytest
from support import BLOCKS, EXAMPLES, cdlc

pytest.importorskip("unified_planning")
SUSSMAN = BLOCKS / "sussman.cdl"


def test_the_problem_is_printed_or_written(tmp_path: Path) -> None:
    printed = cdlc("compile", SUSSMAN, "--emit", "up")
    assert (printed.status, printed.err) == (0, "")
    assert printed.out.startswith("problem name = sussman\n")
    for part in ("action stack(block x, block y) {", "on(c, a) := true", "(on(a, b) and on(b, c))"):
        assert part in printed.out
    cdlc("compile", SUSSMAN, "--emit", "up", "-o", tmp_path)
    assert (tmp_path / "problem.txt").read_text() == printed.out


def test_numbers_are_part_of_it() -> None:
    ran = cdlc("compile", EXAMPLES / "jugs" / "four.cdl", "--emit", "up")
    assert "level(j) := capacity(j)" in ran.out


def test_a_domain_alone_is_refused_with_what_to_do() -> None:
    ran = cdlc("compile", BLOCKS / "blocks.cdl", "--emit", "up")
    assert (ran.status, ran.out) == (1, "")
    assert "error[needs-problem]" in ran.err
    assert "cdlc compile DOMAIN PROBLEM --emit up" in ran.err


# Unfolded, the last of these functions is too large for a text.
DEEP = """
typedef block
feature on()
feature red(x: block)
controller tip(x: block)
def d0():
  return on()
""" + "".join(
    f"def d{n}():\n  return d{n - 1}() ^ (exists x: block: d{n - 1}() ^ red(x))\n"
    for n in range(1, 16)
)
RULE = """
behavior act(x: block):
  goal: red(x)
  body:
    assert d15()
    do tip(x)
  eff:
    red[x] = True
"""


@pytest.mark.parametrize(
    ("emitted", "said"), [("up", "has no form in unified-planning"), ("hddl", "has no HDDL")]
)
def test_derived_predicates_are_refused_with_a_function(
    emitted: str, said: str, tmp_path: Path
) -> None:
    (tmp_path / "domain.cdl").write_text(DEEP + RULE)
    problem = tmp_path / "problem.cdl"
    stated = 'problem "p"\ndomain "domain.cdl"\nobjects:\n  a: block\ngoal: red(a)\n'
    problem.write_text(stated)
    ran = cdlc("compile", problem, "--emit", emitted)
    assert (ran.status, ran.out) == (1, "")
    assert "error[not-in-format]: `d0`, a derived predicate that is too large unfolded," in ran.err
    assert said in ran.err


def test_the_cure_is_named_where_unified_planning_is_missing() -> None:
    script = (
        "import sys; sys.modules['unified_planning'] = None\n"
        "from cdlc import cli; sys.exit(cli.main(sys.argv[1:]))"
    )
    command = [sys.executable, "-c", script, "compile", str(SUSSMAN), "--emit", "up"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stdout) == (1, "")
    cure = 'unified-planning is not installed: pip install "cdlc[planners]"'
    assert done.stderr == f"error[engine-missing]: {cure}\n"
