"""docs/how-to/functions.md: its programs are planned, simulated and carried out as it says."""

import re
import sys
import types
from pathlib import Path
from typing import Any

import pytest
from support import ROOT, cdlc

import cdlc as library
import crow
from crow.functions import collected
from crow.registration import registered

PAGE = (ROOT / "docs" / "how-to" / "functions.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```\w*\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
FILES = {m[1]: b for b in BLOCKS if (m := re.match(r"# (\w+\.\w+)\n", b))}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    return tmp_path


def block(start: str) -> str:
    (found,) = [b for b in BLOCKS if b.startswith(start)]
    return found


def test_its_problem_is_planned_as_it_says(folder: Path) -> None:
    command = block("cdlc plan").split()[1:]
    ran = cdlc(*command, cwd=folder)
    assert (ran.status, ran.out) == (0, block("1. place(red")), ran.err


def test_its_python_is_planned(folder: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    exec(FILES["plan.py"], {})
    assert capsys.readouterr().out == "[('place', ('red', (0.75, 0.0))), ('pick', ('blue',))]\n"


def test_its_simulator_is_planned_with(folder: Path) -> None:
    effect = "  eff:\n    held[b] = False\n    at[b] = beside(at(b))\n"
    (folder / "shelves.cdl").write_text(FILES["shelves.cdl"].replace(effect, ""))
    assert effect in FILES["shelves.cdl"]
    (folder / "both.py").write_text("from shelves import *\nfrom simulated import *\n")
    try:
        problem = library.load_problem(folder / "get.cdl", folder / "both.py")
    finally:
        for name in ("shelves", "simulated"):
            sys.modules.pop(name, None)
    plan = crow.plan(problem)
    assert isinstance(plan, crow.Plan)
    assert [step.controller for step in plan.steps] == ["place", "pick"]
    effects = problem.world.externals.effects["place"]
    blocked = {("at", ("blue",)): (0.75, 0.0), ("held", ("red",)): True}
    assert effects.changes(blocked, ("red", (0.75, 0.0))) == {
        ("held", ("red",)): False,
        ("at", ("red",)): (0.75, 0.5),
    }


def test_its_robot_carries_the_plan_out(folder: Path) -> None:
    class Arm:
        held = "red"
        done: list[Any] = []  # noqa: RUF012

        def close_at(self, box: str) -> None:
            self.held = box
            self.done.append(box)

        def open_at(self, box: str, spot: Any) -> bool:
            self.done.append((box, spot))
            self.held = "" if len(self.done) > 1 else box  # it fails once
            return not self.held

    arm = Arm()
    try:
        given = collected(folder / "robot.py")
        for one in given.given:
            if hasattr(one.call, "__globals__"):
                one.call.__globals__["arm"] = arm
        problem = library.load_problem(folder / "get.cdl", given)
    finally:
        sys.modules.pop("shelves", None)
    seen = dict(problem.initial.cells)

    def observe() -> Any:
        spots = {("at", ("red",)): (0.75, 0.0)} if len(arm.done) > 1 else {}
        held = {("held", (box,)): box == arm.held for box in ("red", "blue")}
        return {**seen, **spots, **held}

    record = crow.execute(problem, crow.Robot(problem, observe=observe))
    assert record.status == "done", record.text()
    assert arm.done == [("red", (0.75, 0.0))] * 2 + ["blue"]


def test_its_generator_and_its_many_at_a_time_are_taken(folder: Path) -> None:
    import numpy as np

    text = FILES["shelves.cdl"] + block("def near(")
    (folder / "shelves.cdl").write_text(text)
    made = types.ModuleType("made")
    vars(made).update(np=np, crow=crow)
    for start in ("@crow.function(vectorized", "@crow.generator"):
        exec(block(start), vars(made))
    domain = library.load(folder / "shelves.cdl", functions=made)
    problem = crow.Problem(domain, {"red": "Box"}, {"at(red)": (3, 4)})
    external = problem.world.externals
    rows = [((1.0, 1.0),), ((3.0, 0.0),)]
    assert external.functions["reachable"].values({}, rows) == [True, False]
    around = external.generators["around"]
    ((x, y),) = next(around.draw(problem.initial, ((1.0, 1.0),), np.random.default_rng(0)))
    assert np.isclose((x - 1) ** 2 + (y - 1) ** 2, 1)
    assert around.limit == 100


def test_what_it_says_of_the_state_is_so(folder: Path) -> None:
    from crow.views import StateView

    world = library.load_problem(folder / "get.cdl", folder / "shelves.py").world
    state = library.load_problem(folder / "get.cdl", folder / "shelves.py").initial
    view = StateView(world, state.cells, {"at", "held"}, "f")
    lines = [line.partition("#")[0].strip() for line in block("state.at(").splitlines()]
    found = [eval(line, {"state": view}) for line in lines]
    assert found == [
        (0.5, 0.0),
        ("red", "blue"),
        {("red",): (0.5, 0.0), ("blue",): (1.0, 1.0)},
        {("red",): True},
    ]


def test_functions_of_the_page_do_not_fit_another_program() -> None:
    domain = library.load(ROOT / "examples" / "blocks" / "blocks.cdl")
    with pytest.raises(crow.FunctionsError, match="no external function `reachable`"):
        registered(domain.program, {"reachable": len})
