"""Problem files (language.md §1)."""

from pathlib import Path

import pytest
from cases import PRELUDE

import cdlc
from cdlc.diagnostics import Diagnostic

BOUNDED = """
feature [[min=0, max=20]] fuel() -> int32
feature [[min=-5]] heat(x: block) -> int64
"""
HEAD = 'problem "p"\ndomain "d.cdl"\n'
OBJECTS = "objects:\n  A, B: block\n  C: box\n"
GOAL = "goal: clear(A)\n"


def found_in(problem: str, tmp_path: Path) -> tuple[Diagnostic, ...]:
    (tmp_path / "d.cdl").write_text(f"{PRELUDE}{BOUNDED}")
    (tmp_path / "p.cdl").write_text(problem)
    return cdlc.check(tmp_path / "p.cdl")


PARTS = [
    ("init:\n  clear[A] = True\n  on[A, B] = True\n  at[A] = table\n", []),
    ("init:\n  position[A] = [1, 2]\n  count = 3\n  size[A] = 1\n", []),
    ("init:\n  foreach x: block: clear[x] = True\n  clear[A] = False\n", []),
    ("init:\n  if clear(A):\n    count = 1\n  let n = 2\n  count = n\n", []),
    ("init:\n  for i in range(3):\n    count += 1\n", []),
    ("init:\n  fuel = 20\n  heat[A] = -5\n", []),
    ("minimize: count\n", []),
    ("minimize: size(A) + count * 2\n", []),
    ("object_constant D: block\ninit: clear[D] = True\n", []),
    ("feature mine(x: block)\ninit: mine[A] = True\n", []),
    ("def both() -> bool:\n  return clear(A) and clear(C)\n", []),
    ("behavior own():\n  goal: clear(A)\n  body: pick(A)\n", []),
    ("init:\n  fuel = 21\n", ["out-of-bounds"]),
    ("init:\n  fuel = -1\n", ["out-of-bounds"]),
    ("init:\n  heat[A] = -6\n", ["out-of-bounds"]),
    ("init:\n  foreach x: block:\n    heat[x] = -6\n", ["out-of-bounds"]),
    ("init:\n  level[A] = 3000000000\n", ["number-too-large"]),
    ("init:\n  clear(A) = True\n", ["call-for-index"]),
    ("init:\n  clear[A] = 1\n", ["wrong-type"]),
    ("init:\n  clear[D] = True\n", ["unknown-name"]),
    ("init:\n  clear[table] = True\n", ["wrong-argument-type"]),
    ("init:\n  nothing[A] = True\n", ["unknown-feature"]),
    ("init:\n  achieve clear(A)\n", ["misplaced-statement"]),
    ("init:\n  foreach x: block: count += 1\n", ["write-conflict"]),
    ("minimize: clear(A)\n", ["wrong-type"]),
    ("minimize: unknown\n", ["unknown-name"]),
    ("minimize: count\nminimize: count\n", ["duplicate-section"]),
    ("goal: clear(B)\n", ["duplicate-section"]),
    ("objects:\n  A: block\n", ["duplicate-definition"]),
    ("objects:\n  clear: block\n", ["duplicate-definition"]),
    ("objects:\n  table: place\n", ["duplicate-definition"]),
    ("objects:\n  D: Pose\n", ["not-an-object-type"]),
    ("objects:\n  D: nowhere\ninit: clear[D] = True\n", ["unknown-type"]),
    ("feature clear(x: block)\n", ["duplicate-definition"]),
    ('include "missing.cdl"\n', ["unreadable-file"]),
]


@pytest.mark.parametrize(("part", "expected"), PARTS)
def test_parts(part: str, expected: list[str], tmp_path: Path) -> None:
    found = found_in(f"{HEAD}{OBJECTS}{part}{GOAL}", tmp_path)
    assert [d.code for d in found] == expected


WHOLE = [
    (f"{HEAD}{OBJECTS}goal: clear(A) = True\n", ["equals-in-goal"]),
    (f"{HEAD}{OBJECTS}goal: count\n", ["wrong-type"]),
    (f"{HEAD}{OBJECTS}goal: forall x: block: clear(x)\n", []),
    (f"{HEAD}{OBJECTS}", ["missing-part"]),
    (f'problem "p"\n{OBJECTS}{GOAL}', ["missing-part"]),
    (f'problem "p"\ndomain "nowhere.cdl"\n{OBJECTS}{GOAL}', ["unreadable-file"]),
    (f'problem "p"\ndomain "p.cdl"\n{OBJECTS}{GOAL}', ["wrong-file-kind"]),
    ('problem "p"\ndomain "__empty__"\ngoal: True\n', []),
]


@pytest.mark.parametrize(("text", "expected"), WHOLE)
def test_problem_files(text: str, expected: list[str], tmp_path: Path) -> None:
    assert [d.code for d in found_in(text, tmp_path)] == expected


def test_definitions_may_be_included(tmp_path: Path) -> None:
    (tmp_path / "more.cdl").write_text("feature mine(x: block)\n")
    problem = f'{HEAD}include "more.cdl"\n{OBJECTS}init: mine[A] = True\n{GOAL}'
    assert found_in(problem, tmp_path) == ()


def test_objects_do_not_disturb_the_domain(tmp_path: Path) -> None:
    domain = "typedef T\nfeature f(x: T)\nbehavior r(x: T):\n  goal: f(x)\n  eff: f[x] = True\n"
    (tmp_path / "d.cdl").write_text(domain)
    (tmp_path / "p.cdl").write_text(f"{HEAD}objects: x: T\ngoal: f(x)\n")
    assert cdlc.check(tmp_path / "p.cdl") == ()


def test_an_object_of_another_file_shows_where(tmp_path: Path) -> None:
    (clash,) = found_in(f"{HEAD}objects: clear: block\ngoal: True\n", tmp_path)
    assert Path(clash.location.file).name == "p.cdl"
    assert Path(clash.labels()[0].location.file).name == "d.cdl"


def test_out_of_bounds_shows_the_bounds(tmp_path: Path) -> None:
    (wrong,) = found_in(f"{HEAD}{OBJECTS}init: fuel = 21\n{GOAL}", tmp_path)
    assert wrong.label() == "0 to 20"
    assert wrong.labels()[0].location.line == PRELUDE.count("\n") + 2
