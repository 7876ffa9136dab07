"""Every diagnostic: the shortest file that raises it, nearly the same one that does not, its text.

`bad.cdl` marks the lines at fault by `# error: [code]` or `# warning: [code]`; `error below` is a
mark of the next line, where a comment would not do.
"""

import re
from pathlib import Path

import pytest
from checking import Checked
from conftest import Golden

import cdlc.backends.errors
import cdlc.bench.errors
import cdlc.ir.errors
import cdlc.plans.errors
import cdlc.verify.errors  # noqa: F401 - for its kinds
from cdlc.diagnostics import Diagnostic, Lint
from cdlc.driver import Compilation, CompileError, compilation
from cdlc.frontend import errors
from cdlc.verify.results import Verdict
from cdlc.verify.run import verify

errors.load()

HERE = Path(__file__).parent
FOLDERS = sorted(path.parent for path in HERE.glob("*/bad.cdl"))
MARK = re.compile(r"# (error|warning)( below)?: \[([a-z-]+)\]")

# What only later stages find, with the stage.
STAGES = {
    "dead-write": "verify",
    "goal-refuted": "verify",
    "never-applicable": "verify",
    "writes-collide": "verify",
    "formula-too-large": "hoare_text",
    "no-hoare-model": "triples",
    "no-initial-value": "problem",
    "not-in-format": "hddl",
    "not-in-pddl": "pddl",
    "needs-problem": "up_text",
    "missing-function": "plannable",
    "not-discrete": "pddl",
    "split-behavior": "pddl",
    "unset-in-pddl": "pddl",
}
# What needs more than a file to happen, with the test of it.
ELSEWHERE = {
    "unreadable-file": "frontend/parsing/test_robustness.py",
    "not-text": "frontend/parsing/test_robustness.py",
    "line-too-long": "frontend/parsing/test_robustness.py",
    "wrong-file-kind": "frontend/parsing/test_robustness.py",
    "not-plannable": "test_cli.py",
    "function-failed": "backends/test_functions.py",
    "wrong-function": "backends/test_functions.py",
    "bad-suite": "bench/test_suites.py",
    "no-problems": "bench/test_suites.py",
    "bad-results": "bench/test_report.py",
    "other-suite": "bench/test_bench_command.py",
    "pddl-syntax": "frontend/pddl/test_import.py",
    "pddl-name": "frontend/pddl/test_import.py",
    "pddl-unsupported": "frontend/pddl/test_import.py",
    "bad-step": "errors/test_steps.py",
    "step-failed": "errors/test_steps.py",
    "open-choice": "errors/test_steps.py",
    "bad-plan": "errors/test_steps.py",
    "other-calls": "errors/test_steps.py",
    "goal-not-reached": "errors/test_steps.py",
}


def run(name: str, stage: str) -> Checked:
    """Everything that is found up to a stage."""
    done = compilation([name])
    if stage == "verify":
        return verified(name, done)
    try:
        getattr(done, stage)
    except CompileError as error:
        return Checked(error.diagnostics, error.sources)
    return Checked(done.found.sorted(), done.sources)


def verified(name: str, done: Compilation) -> Checked:
    """What is refuted."""
    report = verify(name, done.program, time_limit=20)
    checks = [check for behavior in report.behaviors for check in behavior.checks]
    assert not [check for check in checks if check.verdict is Verdict.UNKNOWN]
    return Checked(tuple(c.problem for c in checks if c.problem is not None), done.sources)


def marks(text: str) -> list[tuple[int, str, str]]:
    """Line, severity and code of every mark."""
    found = []
    for number, line in enumerate(text.split("\n"), 1):
        for severity, below, code in MARK.findall(line):
            found.append((number + bool(below), severity, code))
    return found


@pytest.fixture
def folder(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Path:
    path: Path = request.param
    monkeypatch.chdir(path)
    return path


by_code = pytest.mark.parametrize("folder", FOLDERS, indirect=True, ids=lambda path: path.name)


@by_code
def test_the_bad_file_raises_it(folder: Path, golden: Golden) -> None:
    text = (folder / "bad.cdl").read_text(encoding="utf-8")
    checked = run("bad.cdl", STAGES.get(folder.name, "checked"))
    expected = marks(text)
    assert {code for _, _, code in expected} == {folder.name}
    found = [(d.location.line, str(d.severity), d.code) for d in checked.diagnostics]
    assert found == expected, checked.text
    golden(folder / "bad.txt", checked.text)


@by_code
def test_the_good_file_raises_nothing(folder: Path) -> None:
    checked = run("good.cdl", STAGES.get(folder.name, "checked"))
    assert folder.name not in checked.codes, checked.text
    assert all(isinstance(d, Lint) for d in checked.diagnostics), checked.text


def test_every_code_has_a_case() -> None:
    assert {*(folder.name for folder in FOLDERS), *ELSEWHERE} == set(Diagnostic.kinds)


@pytest.mark.parametrize("code", ELSEWHERE)
def test_the_other_codes_are_tested_elsewhere(code: str) -> None:
    assert f'"{code}"' in (HERE.parent / ELSEWHERE[code]).read_text(encoding="utf-8")
