"""What all tests share: expected texts kept in files, and how long random tests run."""

import difflib
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import settings

ROOT = Path(__file__).parent.parent

# Every run is quick; `--hypothesis-profile=thorough` searches for as long as a night takes.
settings.register_profile("quick", deadline=None, max_examples=100)
settings.register_profile("thorough", deadline=None, max_examples=3_000)
settings.load_profile("quick")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--update-golden",
        action="store_true",
        help="write the files that golden tests compare with",
    )
    parser.addoption("--run-slow", action="store_true", help="run the tests marked slow, too")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out what takes minutes, unless asked for."""
    if config.getoption("--run-slow"):
        return
    for item in items:
        if item.get_closest_marker("slow") is not None:
            item.add_marker(pytest.mark.skip(reason="slow; --run-slow runs it"))


Golden = Callable[[Path, str], None]


@pytest.fixture
def golden(pytestconfig: pytest.Config) -> Golden:
    """`golden(path, text)` fails with a diff unless the file holds the text.

    With `--update-golden` it writes the file instead: read what `git diff` says then.
    """
    update: bool = pytestconfig.getoption("--update-golden")

    def compare(path: Path, text: str) -> None:
        __tracebackhide__ = True
        if update:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8", newline="")
            return
        if not path.exists():
            pytest.fail(f"{_shown(path)} is missing; run pytest --update-golden", pytrace=False)
        expected = path.read_bytes().decode()
        if expected != text:
            pytest.fail(_difference(path, expected, text), pytrace=False)

    return compare


def _difference(path: Path, expected: str, text: str) -> str:
    lines = difflib.unified_diff(
        expected.splitlines(keepends=True), text.splitlines(keepends=True), "expected", "found"
    )
    ended = "".join(line if line.endswith("\n") else f"{line}\n(no line end)\n" for line in lines)
    return f"{_shown(path)} differs; pytest --update-golden accepts this:\n{ended}"


def _shown(path: Path) -> str:
    return str(path.relative_to(ROOT)) if path.is_relative_to(ROOT) else str(path)
