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

PROBLEMS = sorted(
    f for f in EXAMPLES.rglob("*.cdl") if re.search('^problem "', f.read_text(), re.MULTILINE)
)
OTHERS = [
    (BLOCKS / f"{domain}.cdl", BLOCKS / f"{problem}.cdl")
    for domain in ("blocks_as_printed", "blocks_strips")
    for problem in ("sussman", "reverse5")
]
# What the program itself does not plan in a few seconds yet: to be emptied. A planner's plan is
# still found and replayed there.
OPEN = {
    "jugs/four",
    "logistics/parcel",
    "blocks/towers12",
    "blocks/blocks_as_printed reverse5",
}
PATIENT, HASTY = Settings(time_limit=60), Settings(time_limit=8)


def name_of(files: tuple[Path, ...]) -> str:
    first = files[0].relative_to(EXAMPLES).with_suffix("").as_posix()
    return " ".join([first, *(file.stem for file in files[1:])])


CASES = {name_of(files): files for files in [*((f,) for f in PROBLEMS), *OTHERS]}


@pytest.mark.parametrize("case", CASES)
def test_examples_agree(case: str) -> None:
    (found,) = compared(*CASES[case], settings=HASTY if case in OPEN else PATIENT)
    expected = {Outcome.AGREE_PLAN}
    if case in OPEN:
        expected.add(Outcome.INCONCLUSIVE)
        assert found.planner is not None
        assert found.planner.status == "plan"
    assert found.outcome in expected, found.reason


def test_what_is_open_is_an_example() -> None:
    assert set(CASES) >= OPEN
    assert len(CASES) >= 14
