"""The set-up tools, with pip and the making of environments replaced: no network."""

import ast
import importlib.util
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
PYPROJECT = "[project.optional-dependencies]\nplanners = []\ndev = []\nview = []\n"


def load_tool(name: str) -> Any:
    spec = importlib.util.spec_from_file_location(name, ROOT / "tools" / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def write_program(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)


class Project:
    """A project whose environment tool notes what it would do; `environment` is that tool."""

    def __init__(self, root: Path) -> None:
        self.environment = load_tool("environment")
        self.environment.create = self.create
        self.environment.install = self.install
        self.root = root
        self.venv = root / ".venv"
        self.done: list[str] = []
        root.mkdir()
        (root / "pyproject.toml").write_text("[project]\n" + PYPROJECT)
        (root / "constraints.txt").write_text("lark==1.3.1\n")

    def create(self, venv: Path) -> None:
        self.done.append("create")
        write_program(venv / "bin" / "python", f"echo {self.environment.python_version()}")
        (venv / "bin" / "activate").write_text(f"VIRTUAL_ENV='{venv}'\n")

    def install(self, _python: Path, _root: Path, extras: list[str]) -> None:
        assert not self.environment.stamp_path(self.venv).exists()
        self.done.append("install " + " ".join(extras))

    def run(self, *extras: str) -> list[str]:
        self.done.clear()
        assert self.environment.run(self.root, extras) == 0
        return list(self.done)


@pytest.fixture
def project(tmp_path: Path) -> Project:
    return Project(tmp_path / "a project")


# When something is done


def test_first_run_makes_the_environment(project: Project) -> None:
    assert project.run("planners") == ["create", "install planners"]


@pytest.mark.parametrize("extras", [["planners", "dev"], ["dev"], []])
def test_same_or_fewer_extras_do_nothing(project: Project, extras: list[str]) -> None:
    project.run("planners", "dev")
    assert project.run(*extras) == []


def test_more_extras_install_the_union(project: Project) -> None:
    project.run("planners", "dev")
    assert project.run("view", "dev") == ["install dev planners view"]
    assert project.run("planners", "view") == []


@pytest.mark.parametrize("name", ["pyproject.toml", "constraints.txt"])
def test_changed_file_installs_all_extras_again(project: Project, name: str) -> None:
    project.run("planners", "dev")
    with (project.root / name).open("a") as file:
        file.write("# changed\n")
    assert project.run("planners") == ["install dev planners"]
    assert project.run("planners") == []


def test_extra_that_is_no_more_is_forgotten(project: Project) -> None:
    project.run("planners", "view")
    (project.root / "pyproject.toml").write_text(
        "[project]\n" + PYPROJECT.replace("view = []\n", "")
    )
    assert project.run("planners") == ["install planners"]


def test_other_python_makes_it_anew(project: Project) -> None:
    project.run("planners", "dev")
    project.environment.python_version = lambda: "3.99"
    assert project.run("planners") == ["create", "install dev planners"]


def test_moved_project_makes_it_anew(project: Project) -> None:
    project.run("planners")
    project.root = project.root.rename(project.root.with_name("moved"))
    project.venv = project.root / ".venv"
    assert project.run("planners") == ["create", "install planners"]


def test_environment_without_python_is_made_anew(project: Project) -> None:
    project.run("planners")
    (project.venv / "bin" / "python").unlink()
    assert project.run("planners") == ["create", "install planners"]


def test_dangling_python_is_made_anew(project: Project) -> None:
    project.run("planners")
    python = project.venv / "bin" / "python"
    python.unlink()
    python.symlink_to(project.root / "no such python")
    assert project.run("planners") == ["create", "install planners"]


@pytest.mark.parametrize("text", ["", "{", "[]", '{"extras": []}', '{"other": 1, "extras": []}'])
def test_unreadable_stamp_is_no_stamp(project: Project, text: str) -> None:
    project.run("planners")
    project.environment.stamp_path(project.venv).write_text(text)
    assert project.run("planners") == ["install planners"]


def test_clear_deletes_all_but_the_lock(project: Project, tmp_path: Path) -> None:
    project.run("planners")
    kept = tmp_path / "kept"
    kept.mkdir()
    (project.venv / "link").symlink_to(kept)
    project.environment.clear(project.venv)
    assert [path.name for path in project.venv.iterdir()] == ["setup.lock"]
    assert kept.exists()


# When it goes wrong


def test_interrupted_install_leaves_no_stamp(
    project: Project, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    project.run("planners")
    project.environment.install = interrupt
    assert project.environment.run(project.root, ["dev"]) == 130
    assert "interrupted" in capsys.readouterr().err
    project.environment.install = project.install
    assert project.run("planners") == ["install planners"]


def test_failing_program_is_shown_with_its_output(
    project: Project, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_program(tmp_path / "pip", "echo no such package; exit 3")
    project.environment.install = lambda *_: project.environment.quietly([tmp_path / "pip"])
    assert project.environment.run(project.root, []) == 1
    message = capsys.readouterr().err
    assert "exited with status 3\nno such package\n" in message
    assert not project.environment.stamp_path(project.venv).exists()


def test_unknown_extra(project: Project, capsys: pytest.CaptureFixture[str]) -> None:
    assert project.environment.run(project.root, ["planner"]) == 1
    assert (
        capsys.readouterr().err
        == "error: there is no extra `planner`; there are: dev, planners, view\n"
    )


def test_missing_venv_module_names_the_cure(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    root = Project(tmp_path / "project").root
    environment = load_tool("environment")
    monkeypatch.setattr(importlib.util, "find_spec", lambda _name: None)
    assert environment.run(root, []) == 1
    assert re.search(r"error: .*apt install python3-venv", capsys.readouterr().err)


@pytest.mark.parametrize("tool", ["environment", "test", "lock"])
def test_old_python_gets_one_line(tool: str) -> None:
    path = ROOT / "tools" / f"{tool}.py"
    program = (
        "import runpy, sys; sys.version_info = (3, 10, 4, 'final', 0);"
        f"sys.path.insert(0, {str(path.parent)!r}); runpy.run_path({str(path)!r}, None, '__main__')"
    )
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert result.returncode == 1
    assert re.fullmatch(
        r"error: cdlc needs Python 3\.11 .* this is Python 3\.10.*\n", result.stderr
    )


def test_old_python_can_parse_the_tool() -> None:
    ast.parse((ROOT / "tools" / "environment.py").read_text(), feature_version=(3, 7))


def test_one_run_at_a_time(project: Project) -> None:
    program = """if True:
        import sys, time
        from pathlib import Path
        sys.path.insert(0, sys.argv[1])
        import environment
        def install(*_):
            print("begin", flush=True); time.sleep(0.3); print("end", flush=True)
        environment.create = lambda venv: None
        environment.is_current = lambda venv, wanted: False
        environment.install = install
        sys.exit(environment.run(Path(sys.argv[2]), ["dev"]))
    """
    log = project.root / "log"
    command = [sys.executable, "-c", program, str(ROOT / "tools"), str(project.root)]
    with log.open("w") as output:
        runs = [subprocess.Popen(command, stdout=output, stderr=output) for _ in range(2)]
        assert [run.wait(timeout=30) for run in runs] == [0, 0]
    steps = [line for line in log.read_text().splitlines() if line in {"begin", "end"}]
    assert steps == ["begin", "end", "begin", "end"]


# The pins


def test_pins_are_sorted_and_nothing_but_pins() -> None:
    sys.path.insert(0, str(ROOT / "tools"))
    try:
        lock = load_tool("lock")
    finally:
        sys.path.remove(str(ROOT / "tools"))
    assert lock.pins_of("ruff==1.0\nLark==2.0\n") == "Lark==2.0\nruff==1.0\n"
    with pytest.raises(lock.environment.SetupError, match="cannot pin"):
        lock.pins_of("lark @ file:///somewhere\n")


# setup.sh

SHELLS = [
    pytest.param(path, id=name)
    for name in ("sh", "bash", "dash", "zsh")
    if (path := shutil.which(name))
]
FOUND = 'case $1 in -c) echo "$0" ;; *) {} ;; esac'


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """Give a copy of what setup.sh needs, with only Pythons that are too old."""
    root = tmp_path / "the checkout"
    (root / "tools").mkdir(parents=True)
    shutil.copy(ROOT / "setup.sh", root)
    (root / "tools" / "environment.py").touch()
    for name in ("python3", "python3.13", "python3.12", "python3.11", "python"):
        write_program(tmp_path / "fake" / name, "exit 1")
    return root


def in_shell(shell: str, checkout: Path, script: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [shell, "-c", script],
        cwd=checkout,
        env={"PATH": f"{checkout.parent / 'fake'}:/usr/bin:/bin", "CDLC_EXTRAS": "planners dev"},
        capture_output=True,
        text=True,
    )


@pytest.mark.parametrize("shell", SHELLS)
def test_shell_survives_without_a_python(shell: str, checkout: Path) -> None:
    result = in_shell(shell, checkout, ". ./setup.sh; echo alive $?")
    assert result.stdout == "alive 1\n"
    assert "needs Python 3.11" in result.stderr


@pytest.mark.parametrize("shell", SHELLS)
def test_shell_survives_outside_the_root(shell: str, checkout: Path) -> None:
    result = in_shell(shell, checkout, "cd tools; . ../setup.sh; echo alive $?")
    assert result.stdout == "alive 1\n"
    assert "in the root" in result.stderr


@pytest.mark.parametrize("shell", SHELLS)
def test_shell_survives_a_failing_set_up(shell: str, checkout: Path) -> None:
    write_program(checkout.parent / "fake" / "python3.12", FOUND.format("exit 7"))
    result = in_shell(shell, checkout, ". ./setup.sh && echo wrong; echo alive; . ./setup.sh")
    assert result.stdout == "alive\n"
    assert result.returncode == 7


@pytest.mark.parametrize("shell", SHELLS)
@pytest.mark.parametrize("options", ["", "set -e; ", "set -u; "])
def test_sourcing_activates(shell: str, options: str, checkout: Path) -> None:
    set_up(checkout)
    result = in_shell(shell, checkout, f'{options}. ./setup.sh && echo "$ACTIVE"')
    assert (result.stdout, result.stderr) == ("./tools/environment.py planners dev\nyes\n", "")


@pytest.mark.parametrize("shell", SHELLS)
def test_running_it_says_to_source_it(shell: str, checkout: Path) -> None:
    set_up(checkout)
    result = in_shell(shell, checkout, f"{shell} setup.sh")
    assert result.returncode == 0
    assert "to put cdlc on the PATH: . ./setup.sh" in result.stderr


@pytest.mark.parametrize("shell", SHELLS)
@pytest.mark.parametrize("works", [True, False])
def test_nothing_is_left_in_the_shell(shell: str, works: bool, checkout: Path) -> None:
    if works:
        set_up(checkout)
    script = "set > before; set -o > o1; . ./setup.sh; set > after; set -o > o2; alias"
    in_shell(shell, checkout, script)
    assert names(checkout / "after") - names(checkout / "before") <= {"ACTIVE", "PIPESTATUS", "_"}
    assert (checkout / "o1").read_text() == (checkout / "o2").read_text()


def set_up(checkout: Path) -> None:
    """Let the last Python tried be new enough, and make the environment it would make."""
    write_program(checkout.parent / "fake" / "python", FOUND.format('echo "$@"'))
    activate = checkout / ".venv" / "bin" / "activate"
    activate.parent.mkdir(parents=True)
    activate.write_text("ACTIVE=yes\n")


def names(listing: Path) -> set[str]:
    """Return the variables and functions in what `set` prints."""
    return set(re.findall(r"^(\w+)(?:=| ?\(\))", listing.read_text(errors="replace"), re.MULTILINE))
