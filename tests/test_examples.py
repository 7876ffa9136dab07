"""Every example checks, compiles and is planned; the documentation shows what commands print."""

import json
import re
import shutil
from pathlib import Path

import pytest
from support import BLOCKS, EXAMPLES, ROOT, cdlc

import cdlc as library
from cdlc.driver import Compilation, problem_compilation

PROGRAMS = ["blocks", "blocks_as_printed", "blocks_strips"]
PROBLEMS = ["sussman", "reverse5", "towers12"]
WARNINGS = {
    "blocks_as_printed.cdl": ["goal-not-established"],
    # What is for the programs that include it.
    "shared.cdl": ["unused-definition", "unmatched-generator"],
}
MISPRINT = "    holding[y] = True\n    clear[y] = True\n"


def mended(program: str, folder: Path) -> Path:
    """A program of the blocks world, the misprint of the printed one mended."""
    text = (BLOCKS / f"{program}.cdl").read_text()
    if program == "blocks_as_printed":
        assert text.count(MISPRINT) == 1
        text = text.replace(MISPRINT, MISPRINT.replace("holding[y]", "holding[x]"))
    file = folder / f"{program}.cdl"
    file.write_text(text)
    return file


@pytest.mark.parametrize("file", sorted(EXAMPLES.rglob("*.cdl")), ids=lambda f: f.stem)
def test_examples_check(file: Path) -> None:
    codes = [diagnostic.code for diagnostic in library.check(file)]
    assert codes == WARNINGS.get(file.name, [])


def test_the_misprint_is_found_where_it_is() -> None:
    (warning,) = library.check(BLOCKS / "blocks_as_printed.cdl")
    assert "r_holding_from_stack" in warning.message()
    assert warning.location.line == 35
    assert [label.location.line for label in warning.labels()] == [48]


@pytest.mark.parametrize("problem", PROBLEMS)
@pytest.mark.parametrize("program", PROGRAMS)
def test_blocks_problems_are_planned_and_validated(
    program: str, problem: str, tmp_path: Path
) -> None:
    domain, plan = mended(program, tmp_path), tmp_path / "plan.json"
    file = BLOCKS / f"{problem}.cdl"
    ran = cdlc("plan", domain, file, "--engine", "fast-downward", "--format", "json", "-o", plan)
    assert ran.status == 0, ran.err
    document = json.loads(plan.read_text())
    if problem == "sussman":
        assert len(document["steps"]) == 6
    validated = cdlc("validate", domain, file, plan)
    assert validated.status == 0, validated.err


def test_the_tutorial_is_planned() -> None:
    ran = cdlc("plan", EXAMPLES / "tutorial" / "swap.cdl")
    assert (ran.status, len(ran.out.splitlines())) == (0, 6)
    ran = cdlc("plan", EXAMPLES / "tutorial" / "swap.cdl", "--engine", "fast-downward")
    assert (ran.status, len(ran.out.splitlines())) == (0, 7)


def test_the_domain_given_wins_over_the_one_named() -> None:
    chosen = problem_compilation([str(BLOCKS / "blocks_strips.cdl"), str(BLOCKS / "sussman.cdl")])
    assert isinstance(chosen, Compilation)
    assert chosen.program.name == "blocks-strips"


# ----------------------------------------------------------------------------------- documentation


def code_blocks(text: str) -> list[tuple[str, str]]:
    """The fenced blocks of a page: language and content."""
    return re.findall(r"^```(\w*)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def documented_commands() -> list[str]:
    pages = [ROOT / "README.md", ROOT / "docs" / "tutorial.md"]
    lines = [
        line
        for page in pages
        for language, block in code_blocks(page.read_text())
        if language == "sh"
        for line in block.splitlines()
    ]
    return [line for line in lines if line.startswith("cdlc ")]


def test_documented_commands_work_as_they_stand(tmp_path: Path) -> None:
    shutil.copytree(EXAMPLES, tmp_path / "examples")
    commands = documented_commands()
    assert len(commands) >= 8
    for command in commands:
        words = [word.strip('"') for word in re.findall(r'"[^"]*"|\S+', command)]
        ran = cdlc(*words[1:], cwd=tmp_path)
        assert ran.status == 0, (command, ran.err)


def test_the_readme_opens_with_the_two_commands() -> None:
    shell = [
        block
        for language, block in code_blocks((ROOT / "README.md").read_text())
        if language == "sh"
    ]
    first, second = shell[0].strip(), shell[1].strip()
    assert first.startswith(
        ". ./setup.sh && cdlc compile examples/blocks/blocks.cdl --emit pddl && "
    )
    assert first.endswith(
        "cdlc plan examples/blocks/blocks.cdl examples/blocks/sussman.cdl --engine fast-downward"
    )
    assert second == "python3 tools/test.py"


def test_the_readme_shows_what_commands_print() -> None:
    shown = {
        block for language, block in code_blocks((ROOT / "README.md").read_text()) if not language
    }
    warning = cdlc("check", "examples/blocks/blocks_as_printed.cdl").err
    plan = cdlc("plan", "examples/blocks/sussman.cdl").out
    assert warning.rpartition("\n\n")[0] + "\n" in shown
    assert plan in shown


def test_the_readme_s_python_runs(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    shutil.copytree(EXAMPLES, tmp_path / "examples")
    monkeypatch.chdir(tmp_path)
    blocks = code_blocks((ROOT / "README.md").read_text())
    script = "\n".join(block for language, block in blocks if language == "python")
    exec(compile(script, "README.md", "exec"), {})
    printed = capsys.readouterr().out
    assert "(define (domain blocks)" in printed
    assert "\n4 steps\n" in printed
    assert "given up: a call failed too often: unstack(C, A)" in printed
    assert re.search(r"^exec_traj \(\(2, 5\), \(", printed, re.MULTILINE)
    assert (tmp_path / "namo.png").read_bytes().startswith(b"\x89PNG")


def test_the_tutorial_s_domain_is_the_example() -> None:
    blocks = [
        b
        for language, b in code_blocks((ROOT / "docs" / "tutorial.md").read_text())
        if not language
    ]
    domain = (EXAMPLES / "tutorial" / "rooms.cdl").read_text()
    problem = (EXAMPLES / "tutorial" / "swap.cdl").read_text()
    for block in blocks:
        assert block in (problem if block.startswith("problem") else domain)


def test_the_readme_s_domain_is_the_example() -> None:
    blocks = {b for _, b in code_blocks((ROOT / "README.md").read_text())}
    for file in (EXAMPLES / "kitchen").glob("*.cdl"):
        assert file.read_text() in blocks


def test_the_kitchen_is_planned() -> None:
    ran = cdlc("plan", EXAMPLES / "kitchen" / "tidy.cdl")
    assert ran.status == 0
    assert {"put(red, cupboard)", "put(blue, cupboard)"} <= set(
        re.findall(r"\w+\([^)]*\)", ran.out)
    )
