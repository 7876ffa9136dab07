"""The fixture for expected texts in files."""

from pathlib import Path

import pytest
from conftest import Golden


@pytest.fixture
def file(tmp_path: Path, pytestconfig: pytest.Config) -> Path:
    if pytestconfig.getoption("--update-golden"):
        pytest.skip("files are written now, not compared with")
    return tmp_path / "case.txt"


def test_same_text_passes(file: Path, golden: Golden) -> None:
    file.write_text("a\nb\n")
    golden(file, "a\nb\n")


def test_other_text_fails_with_the_difference(file: Path, golden: Golden) -> None:
    file.write_text("a\nb\n")
    with pytest.raises(pytest.fail.Exception) as failure:
        golden(file, "a\nc")
    assert "--update-golden" in str(failure.value)
    assert "-b\n+c\n(no line end)\n" in str(failure.value)


def test_missing_file_fails(file: Path, golden: Golden) -> None:
    with pytest.raises(pytest.fail.Exception, match=r"case\.txt is missing"):
        golden(file, "")
    assert not file.exists()
