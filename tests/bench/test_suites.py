"""Suites: what they stand for, what is wrong with them, and when they are the same."""

import shutil
from pathlib import Path

import pytest
from support import BLOCKS, EXAMPLES, cdlc

from cdlc.bench.suite import Options, Run, Suite, suite_of
from cdlc.diagnostics import Collector
from crow.many.tasks import Configuration


def suite(*given: str | Path, options: Options | None = None) -> Suite:
    found = Collector()
    made = suite_of(map(str, given), options or Options(), found)
    assert not found.has_errors, [d.message() for d in found]
    return made


def codes(*given: str | Path) -> set[str]:
    """The codes of what is wrong with suites."""
    found = Collector()
    assert suite_of(map(str, given), Options(), found).digest == ""
    return {diagnostic.code for diagnostic in found}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The blocks, a folder deeper, with a suite beside them."""
    shutil.copytree(BLOCKS, tmp_path / "blocks")
    (tmp_path / "suite.toml").write_text(
        'problems = ["blocks/s*.cdl", "blocks/reverse5.cdl"]\nengines = ["auto", "best"]\n'
        "seeds = 2\ntime-limit = 5.0\n"
    )
    return tmp_path


def test_a_folder_stands_for_its_problems_at_any_depth() -> None:
    files = [Path(run.file) for run in suite(EXAMPLES).runs]
    assert files == sorted(files)
    expected = {p for p in EXAMPLES.rglob("*.cdl") if '\nproblem "' in f"\n{p.read_text('utf-8')}"}
    assert set(files) == expected
    assert len(expected) > 8


def test_a_glob_and_files_stand_for_themselves_once() -> None:
    sussman = BLOCKS / "sussman.cdl"
    files = [Path(run.file).name for run in suite(BLOCKS / "s*.cdl", sussman, sussman).runs]
    assert files == ["stacking_sussman.cdl", "sussman.cdl"]


def test_a_toml_file_has_each_problem_each_way(folder: Path) -> None:
    runs = suite(folder / "suite.toml").runs
    names = ["stacking_sussman.cdl", "sussman.cdl", "reverse5.cdl"]
    assert [(Path(r.file).name, r.configuration.engine, r.configuration.seed) for r in runs] == [
        (name, engine, seed) for name in names for engine in ("auto", "best") for seed in (0, 1)
    ]
    assert {run.configuration.time_limit for run in runs} == {5.0}
    assert len({run.key for run in runs}) == len(runs)


def test_configurations_may_be_tables(folder: Path) -> None:
    (folder / "ways.toml").write_text(
        'problems = ["blocks/sussman.cdl"]\nseeds = [4, 4, 7]\nnode-limit = 10\n'
        'domain = "blocks/blocks_strips.cdl"\nfunctions = "python.py"\n'
        '[[configurations]]\nname = "mine"\nengine = "best"\nh = "add"\nmax-memory = 200\n'
        '[[configurations]]\nengine = "iddfs"\nnode-limit = 20\ndepth-limit = 5\noptimal = true\n'
    )
    domain, python = (str(folder / f) for f in ("blocks/blocks_strips.cdl", "python.py"))
    first, second = (
        Configuration(engine="best", h="add", node_limit=10, memory_limit_mb=200, name="mine"),
        Configuration(engine="iddfs", node_limit=20, depth_limit=5, optimal=True),
    )
    runs = suite(folder / "ways.toml").runs
    assert {(r.domain, r.functions) for r in runs} == {(domain, python)}
    assert [r.configuration for r in runs] == [
        Configuration(**{**one.options(), "name": one.name, "seed": seed})
        for one in (first, second)
        for seed in (4, 7)
    ]


def test_the_command_line_goes_before_what_a_suite_says(folder: Path) -> None:
    options = Options(("iw",), (0, 1, 2), {"node_limit": 9}, "other.py")
    runs = suite(folder / "suite.toml", options=options).runs
    assert runs[0] == Run(
        str(folder / "blocks/stacking_sussman.cdl"), None, "other.py",
        Configuration(engine="iw", time_limit=5.0, node_limit=9),
    )  # fmt: skip
    assert len(runs) == 9


def test_a_suite_is_the_same_as_long_as_nothing_it_comes_from_changes(folder: Path) -> None:
    before = suite(folder / "suite.toml").digest
    assert suite(folder / "suite.toml").digest == before
    changes = [
        ("suite.toml", "5.0", "6.0"),
        ("suite.toml", '"best"', '"iw"'),
        ("suite.toml", "seeds = 2", "seeds = [0, 2]"),
        ("blocks/sussman.cdl", "on(A, B)", "on(B, A)"),
        ("blocks/blocks.cdl", "clear", "is_clear"),
    ]
    for file, old, new in changes:
        text = (folder / file).read_text()
        assert old in text
        (folder / file).write_text(text.replace(old, new))
        assert suite(folder / "suite.toml").digest != before, (file, old)
        (folder / file).write_text(text)
    (folder / "blocks/of_no_concern.cdl").write_text("# a comment\n")
    assert suite(folder / "suite.toml").digest == before


def test_what_a_domain_includes_belongs_to_its_suite(tmp_path: Path) -> None:
    (tmp_path / "types.cdl").write_text("typedef t\n")
    (tmp_path / "domain.cdl").write_text('include "types.cdl"\nfeature f(x: t)\n')
    (tmp_path / "p.cdl").write_text(
        'problem "p"\ndomain "domain.cdl"\nobjects:\n  a: t\ngoal: f(a)\n'
    )
    before = suite(tmp_path).digest
    (tmp_path / "types.cdl").write_text("typedef t\ntypedef u\n")
    assert suite(tmp_path).digest != before


MISTAKES = {
    "missing": ("seeds = 2\n", 1, "`problems` is missing", 'add `problems = ["*.cdl"]`'),
    "spelt": ('problems = ["a"]\n  time_limit = 3\n', 2, "no key `time_limit`", "`time-limit`"),
    "engine": ('problems = ["a"]\nengines = ["lama"]\n', 2, "some of auto, best", ""),
    "seeds": ('problems = ["a"]\nseeds = 0\n', 2, "a number of seeds, or a list", ""),
    "limit": ('problems = ["a"]\nnode-limit = 2.5\n', 2, "a positive whole number", ""),
    "infinite": ('problems = ["a"]\ntime-limit = inf\n', 2, "a positive number of seconds", ""),
    "both": (
        'problems = ["a"]\nengines = ["iw"]\n[[configurations]]\nengine = "iw"\n', 2,
        "both say which there are", "no `engines`",
    ),
    "inside": (
        'problems = ["a"]\n[[configurations]]\nname = "x"\n[[configurations]]\nh = 1\n', 5,
        "one of ff, add", "",
    ),
    "unknown inside": (
        'problems = ["a"]\n[[configurations]]\nseeds = 3\n', 3, "no key `seeds`", "there are name",
    ),
    "twice": (
        'problems = ["a"]\n[[configurations]]\nh = "add"\n[[configurations]]\nh = "add"\n', 4,
        "two configurations are called `auto h=add`", "give each a `name`",
    ),
    "table": ('problems = ["a"]\nconfigurations = 3\n', 2, "write `[[configurations]]`", ""),
    "no toml": ('problems = ["a"]\nseeds 3\n', 2, "no TOML: ", ""),
    "cut off": ('problems = ["a"\n', 1, "no TOML: ", ""),
}  # fmt: skip


@pytest.mark.parametrize("case", MISTAKES)
def test_mistakes_of_a_suite_have_a_place_and_a_cure(case: str, tmp_path: Path) -> None:
    text, line, told, cure = MISTAKES[case]
    (tmp_path / "s.toml").write_text(text)
    assert codes(tmp_path / "s.toml") == {"bad-suite"}
    ran = cdlc("bench", "s.toml", cwd=tmp_path)
    assert (ran.status, ran.out) == (1, "")
    first, place, *_ = ran.err.splitlines()
    assert first.startswith("error[bad-suite]: ")
    assert told in first
    assert place.startswith(f" --> s.toml:{line}:")
    assert cure in ran.err
    assert "runs" not in ran.err


def test_a_suite_without_problems_is_told(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "s.toml").write_text('problems = ["empty", "gone.cdl",\n  "*.none"]\n')
    domain = BLOCKS / "blocks.cdl"
    assert codes(domain, tmp_path / "empty") == {"no-problems"}
    ran = cdlc("bench", "s.toml", "nowhere", "no.toml", domain, cwd=tmp_path)
    assert ran.status == 1
    for told in (
        "error[no-problems]: `empty` has no problems in it",
        "error[no-problems]: `*.none` matches no problem",
        "error[unreadable-file]: cannot read `gone.cdl`: no such file or directory",
        "error[unreadable-file]: cannot read `nowhere`: no such file or directory",
        "error[unreadable-file]: cannot read `no.toml`: no such file or directory",
        f'error[no-problems]: `{domain}` is no problem: it has no line `problem "…"`',
    ):
        assert told in ran.err, told
