"""Every answer without a plan says what failed, with its place, on every example domain."""

import json
import re
from pathlib import Path

import pytest
from support import EXAMPLES, cdlc

import crow
from cdlc.driver import problem_compilation
from crow.planning import ENGINES

# Problem: what replaces its goal, and what has to stand in the line that is pointed at.
IMPOSSIBLE = {
    "contradicts itself": {
        "tutorial/swap": "free() and carrying(red)",
        "kitchen/tidy": "inside(red, drawer) and inside(red, cupboard)",
        "gripper/four": "at(b1, here) and at(b1, there)",
        "logistics/parcel": "in(parcel) == forum and in(parcel) == louvre",
        "briefcase/payday": "at(paycheck) == home and at(paycheck) == office",
        "jugs/four": "level(large) == 4 and level(large) == 5",
        "cupboard/dishes": "opened(kitchen) and not opened(kitchen)",
        "blocks/sussman": "on(A, B) and on(B, A)",
    },
    "is achieved by nothing": {
        "tutorial/swap": "not robot_in(right) and not robot_in(left)",
        "kitchen/tidy": "not holding(red) and not is_open(drawer) and not handempty()",
        "gripper/four": "not free(left)",
        "logistics/parcel": "city_of(forum) == paris",
        "briefcase/payday": "at(paycheck) != at(paycheck)",
        "jugs/four": "capacity(small) == 4",
        "cupboard/dishes": "blocked(table)",
        "blocks/sussman": "not on_table(A)",
    },
    "wants an object that is not there": {
        "tutorial/swap": "exists r: room: r != left and r != right and robot_in(r)",
        "kitchen/tidy": "exists p: place: inside(red, p) and inside(blue, p) and holding(red)",
        "gripper/four": "exists r: room: r != here and r != there and robot_at() == r",
        "logistics/parcel": "exists l: airport: l == cdg and city_of(l) == rome",
        "briefcase/payday": "exists p: place: p != home and p != office and at(paycheck) == p",
        "jugs/four": "exists j: jug: capacity(j) == 8 and level(j) == 8",
        "cupboard/dishes": "exists p: place: loc(pot) == p and inside(p, kitchen) and p == table",
        "blocks/sussman": "exists x: block: x != A and x != B and x != C and on(x, A)",
    },
}
CASES = [(name, why, goal) for why, goals in IMPOSSIBLE.items() for name, goal in goals.items()]
PLACE = re.compile(r"^`(.+?)` at (\S+?):(\d+):(\d+)( with .+?)?: (.+)$")
REASONS = (
    "it is false here",
    "it no longer holds here",
    "no behavior achieves it",
    "no object is like this",
    "nothing can make it true",
    "nothing left makes it true",
    "it has not become true so far",
)


def with_goal(name: str, goal: str, folder: Path) -> Path:
    """A copy of an example with another goal, beside a copy of its domain."""
    source = EXAMPLES / f"{name}.cdl"
    for file in source.parent.glob("*.cdl"):
        (folder / file.name).write_text(file.read_text())
    text = source.read_text()
    changed = folder / "changed.cdl"
    changed.write_text(text[: text.index("goal:")] + f"goal: {goal}\n")
    return changed


def words(text: str) -> list[str]:
    return re.findall(r"[A-Za-z_]\w*", text)


def check_explanation(told: str | None, folder: Path) -> None:
    """It names a condition, and the span at which a line of one of the files says it."""
    assert told is not None
    found = PLACE.match(told)
    assert found is not None, told
    condition, file, line, column, _, reason = found.groups()
    assert reason.startswith(REASONS), told
    path = Path(file)
    assert path.parent == folder, told
    said = path.read_text().splitlines()[int(line) - 1][int(column) - 1 :]
    assert said.strip(), told
    # What stands there is the statement or condition that failed.
    assert set(words(said)[:3]) & {*words(condition), "achieve", "assert", "bind", "exists"}, told
    reads = re.search(r"[a-z_]+\([^()]*\)", condition)
    if reads is not None and "==" not in condition and " in " not in condition:
        assert "there, " in reason or reason in REASONS, told


@pytest.mark.parametrize(("name", "why", "goal"), CASES)
def test_what_failed_is_told_with_its_place(name: str, why: str, goal: str, tmp_path: Path) -> None:
    problem = problem_compilation([str(with_goal(name, goal, tmp_path))]).problem
    for engine in ENGINES:
        limit = 1_000 if engine == "reference" else 400
        result = crow.plan(problem, engine, node_limit=limit)
        assert isinstance(result, crow.Unsolvable | crow.LimitReached), (engine, result)
        check_explanation(result.explanation, tmp_path)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(
    ("name", "goal", "told"),
    [
        ("logistics/parcel", "city_of(forum) == paris", "city_of(forum) is rome"),
        ("cupboard/dishes", "blocked(table)", "blocked(table) is False"),
        ("gripper/four", "not free(left)", "free(left) is True"),
        ("jugs/four", "level(small) < 0", None),
    ],
)
def test_a_goal_that_nothing_achieves_is_pointed_at(
    engine: str, name: str, goal: str, told: str | None, tmp_path: Path
) -> None:
    file = with_goal(name, goal, tmp_path)
    problem = problem_compilation([str(file)]).problem
    explanation = crow.plan(problem, engine, node_limit=200).explanation
    assert explanation is not None
    if told is None:  # behaviors write what it reads, so they are tried
        assert f"{tmp_path}/" in explanation
        return
    line = len(file.read_text().splitlines())
    column = 11 if goal.startswith("not ") and engine != "reference" else 7
    place = f"{file}:{line}:{column}"
    assert explanation == f"`{goal}` at {place}: no behavior achieves it; there, {told}"


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("limits", [{"node_limit": 1}, {"time_limit": 1e-9}, {"depth_limit": 0}])
def test_also_of_a_search_that_hardly_began(
    engine: str, limits: dict[str, float], tmp_path: Path
) -> None:
    name, goal = "gripper/four", "at(b1, here) and at(b1, there) and at(b2, there)"
    problem = problem_compilation([str(with_goal(name, goal, tmp_path))]).problem
    result = crow.plan(problem, engine, **limits)  # type: ignore[arg-type]
    assert not isinstance(result, crow.Plan)
    check_explanation(result.explanation, tmp_path)


@pytest.mark.parametrize("name", sorted({name for name, _, _ in CASES}))
def test_the_command_prints_it(name: str, tmp_path: Path) -> None:
    goals = IMPOSSIBLE["is achieved by nothing"]
    file = with_goal(name, goals[name], tmp_path)
    ran = cdlc("plan", file, "--time-limit", "1")
    assert ran.status in (3, 4), ran
    (note,) = [line for line in ran.err.splitlines() if line.startswith("note: ")]
    check_explanation(note.removeprefix("note: the search came as far as "), tmp_path)
    ran = cdlc("plan", file, "--time-limit", "1", "--format", "json")
    check_explanation(json.loads(ran.out)["explanation"], tmp_path)
