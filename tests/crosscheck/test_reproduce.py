"""The folder that a mismatch leaves: what is in it, and that it repeats."""

import json
import shlex
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from crossing import ACHIEVES, WITH_KEY, written

from cdlc import cli
from cdlc.backends.engines import EngineResult, installed
from cdlc.crosscheck import sides
from cdlc.output import write_folder

if "fast-downward" not in installed():
    pytest.skip("needs the extra `planners`", allow_module_level=True)


@pytest.fixture
def faulty(monkeypatch: pytest.MonkeyPatch) -> None:
    """An engine that forgets the last step of its plans."""
    solve = sides.solve

    def wrong(*arguments: str, **named: Any) -> EngineResult:
        solved = solve(*arguments, **named)
        return replace(solved, steps=solved.steps[:-1])

    monkeypatch.setattr(sides, "solve", wrong)


@pytest.mark.usefixtures("faulty")
def test_a_mismatch_leaves_what_repeats_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    source = tmp_path / "source"
    (source / "parts").mkdir(parents=True)
    problem = written(source, 'domain "door"\ninclude "parts/all.cdl"\n', WITH_KEY)
    (source / "parts" / "all.cdl").write_text(ACHIEVES.replace('domain "door"\n', ""))
    monkeypatch.chdir(tmp_path)
    assert cli.main(["crosscheck", str(problem), "--node-limit", "1000"]) == 1
    printed = capsys.readouterr().out
    folder = tmp_path / "crosscheck-front"
    assert "to repeat it: crosscheck-front\n" in printed
    names = {p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.is_file()}
    assert names == {
        "README.md", "cdl/door.cdl", "cdl/front.cdl", "cdl/parts/all.cdl", "comparison.json",
        "domain.pddl", "problem.pddl", "planner-plan.pddl",
        "program-plan.pddl", "program-plan.txt", "program-plan.json",
    }  # fmt: skip
    assert (folder / "planner-plan.pddl").read_text() == "(unlock front)\n"
    assert (folder / "program-plan.pddl").read_text() == "(unlock front)\n(push front)\n"
    assert "(:action unlock" in (folder / "domain.pddl").read_text()
    comparison = json.loads((folder / "comparison.json").read_text())
    assert comparison["outcome"] == "mismatch"
    readme = (folder / "README.md").read_text()
    assert "does not replay" in readme
    assert "\ncdlc 0." in readme
    assert "unified_planning 1." in readme

    monkeypatch.chdir(folder)
    repeat, planner_s, program_s, *_ = [
        shlex.split(line) for line in readme.splitlines() if line.startswith("cdlc ")
    ]
    assert repeat[:4] == ["cdlc", "crosscheck", "cdl/front.cdl", "--engine"]
    assert repeat[-2:] == ["--node-limit", "1000"]
    assert cli.main(repeat[1:]) == 1
    assert "does not replay" in capsys.readouterr().out
    assert cli.main(planner_s[1:]) == 1
    assert cli.main(program_s[1:]) == 0


@pytest.mark.usefixtures("faulty")
def test_nothing_is_written_over_and_no_half_folder_is_left(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    problem = written(tmp_path, ACHIEVES, WITH_KEY)
    out = tmp_path / "out"
    command = ["crosscheck", str(tmp_path / "door.cdl"), str(problem), "--out", str(out)]
    assert [cli.main(command), cli.main(command)] == [1, 1]
    assert sorted(p.name for p in out.iterdir()) == ["crosscheck-front", "crosscheck-front-2"]
    capsys.readouterr()
    blocked = tmp_path / "file"
    blocked.write_text("kept")
    assert cli.main([*command[:-1], str(blocked)]) == 1
    printed = capsys.readouterr()
    assert "error[cannot-write]" in printed.err
    assert "mismatch" in printed.out
    assert "to repeat it" not in printed.out
    assert blocked.read_text() == "kept"


def test_a_folder_is_written_whole_or_not_at_all(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import cdlc.output

    write = cdlc.output.write_whole

    def interrupted(path: Path, text: str) -> None:
        if path.name == "b":
            raise KeyboardInterrupt
        write(path, text)

    monkeypatch.setattr(cdlc.output, "write_whole", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_folder(tmp_path / "new", {"a": "1", "b": "2"})
    assert list(tmp_path.iterdir()) == []
    monkeypatch.undo()
    (tmp_path / "new").write_text("a file of that name")
    assert write_folder(tmp_path / "new", {"a": "1", "in/b": "2"}) == tmp_path / "new-2"
    assert (tmp_path / "new-2" / "in" / "b").read_text() == "2"
