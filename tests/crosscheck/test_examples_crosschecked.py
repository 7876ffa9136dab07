"""Every problem in `examples/` crosschecked, with its own domain and with others of blocks."""

import re
from pathlib import Path

import pytest
from crossing import compared
from support import BLOCKS, EXAMPLES

from cdlc.backends.engines import installed
from cdlc.crosscheck import Outcome, Settings

if not {"fast-downward", "kairos"} <= set(installed()):
    pytest.skip("needs the extra `planners`", allow_module_level=True)

# They choose poses and paths, with functions in Python: no PDDL says that.
OF_VALUES = {"namo", "pickplace", "tabletop"}
PROBLEMS = sorted(
    f
    for f in EXAMPLES.rglob("*.cdl")
    if f.parent.name not in OF_VALUES
    if re.search('^problem "', f.read_text("utf-8"), re.MULTILINE)
)
OTHERS = [
    (BLOCKS / f"{domain}.cdl", BLOCKS / f"{problem}.cdl")
    for domain in ("blocks_as_printed", "blocks_strips")
    for problem in ("sussman", "reverse5")
]
# Some minutes of a busy machine: what is compared is the answers, not the times.
PATIENT = Settings(time_limit=120)


def name_of(files: tuple[Path, ...]) -> str:
    first = files[0].relative_to(EXAMPLES).with_suffix("").as_posix()
    return " ".join([first, *(file.stem for file in files[1:])])


CASES = {name_of(files): files for files in [*((f,) for f in PROBLEMS), *OTHERS]}


# Like others, but larger.
LARGE = {"blocks/towers12", "blocks/blocks_as_printed reverse5", "blocks/blocks_strips reverse5"}
# Its methods achieve after they have acted, which no PDDL says.
WITHOUT_PDDL = {"blocks/stacking_sussman"}


@pytest.mark.parametrize(
    "case", [pytest.param(n, marks=pytest.mark.slow) if n in LARGE else n for n in CASES]
)
def test_examples_agree(case: str) -> None:
    (found,) = compared(*CASES[case], settings=PATIENT)
    without = case in WITHOUT_PDDL
    expected = Outcome.NOT_COMPARABLE if without else Outcome.AGREE_PLAN
    assert found.outcome is expected, found.reason


def test_every_example_has_a_problem() -> None:
    assert len(CASES) >= 14
    folders = {path.parent.name for path in EXAMPLES.glob("*/*.cdl")}
    assert {path.parent.name for path in PROBLEMS} == folders - OF_VALUES
