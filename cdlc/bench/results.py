"""Files of results: a header, then a record a line, appended one by one.

A record is written at once, so that a crash costs no more than the line that it cuts off, which is
dropped when the run goes on.
"""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Self, TextIO

from cdlc.bench.errors import BadResults, OtherSuite, at
from cdlc.bench.suite import Suite
from cdlc.diagnostics import Collector

VERSION: Final = 1


class InUseError(Exception):
    """Somebody else is writing the file."""

    code = "results-in-use"


@dataclass(frozen=True, slots=True)
class Results:
    """What a file of results holds: the header, and the records in the order they were written.

    `size` is where its last whole line ends.
    """

    header: dict[str, Any]
    records: tuple[dict[str, Any], ...]
    size: int


def header_of(suite: Suite) -> dict[str, Any]:
    """The first line of the results of a suite."""
    from importlib.metadata import version

    return {
        "version": VERSION,
        "cdlc": version("cdlc"),
        "suite": suite.digest,
        "runs": len(suite.runs),
    }


def line_of(document: dict[str, Any]) -> str:
    """A document as a line."""
    return json.dumps(document, ensure_ascii=False, separators=(",", ":")) + "\n"


def read_results(file: str, found: Collector) -> Results | None:
    """What a file holds; None, with a diagnostic, if it is no file of results.

    A last line without an end is left out. Raises OSError.
    """
    data = Path(file).read_bytes()
    size = data.rfind(b"\n") + 1
    documents: list[dict[str, Any]] = []
    for number, line in enumerate(data[:size].splitlines(), 1):
        document = _document(line)
        wrong = _wrong(document, is_header=number == 1)
        if document is None or wrong:
            found.add(BadResults(location=at(file, number), reason=wrong))
            return None
        documents.append(document)
    if not documents:
        found.add(BadResults(location=at(file), reason="it has no header"))
        return None
    return Results(documents[0], tuple(documents[1:]), size)


def _document(line: bytes) -> dict[str, Any] | None:
    try:
        document = json.loads(line)
    except ValueError:
        return None
    return document if isinstance(document, dict) else None


def _wrong(document: dict[str, Any] | None, *, is_header: bool) -> str:
    """What is wrong with a line, or nothing."""
    if document is None:
        return "a line is no JSON object"
    if not is_header:
        fits = all(isinstance(document.get(k), str) for k in ("key", "problem", "status"))
        fits = fits and isinstance(document.get("seconds"), int | float)
        return "" if fits and isinstance(document.get("configuration"), dict) else "no record"
    if "suite" not in document or "runs" not in document:
        return "the first line is no header"
    version = document.get("version")
    return "" if version == VERSION else f"it has version {version!r} of the format, not {VERSION}"


class Appender:
    """Appends records to a file, each at once; a context manager.

    `done` are the keys of the records that were there before. Raises OSError.
    """

    def __init__(self, file: TextIO, done: frozenset[str]) -> None:
        self._file = file
        self.done = done

    @classmethod
    def new(cls, path: Path, suite: Suite) -> Self:
        """A file that was not there. Raises FileExistsError."""
        path.parent.mkdir(parents=True, exist_ok=True)
        made = cls(_locked(path.open("x", encoding="utf-8", newline="")), frozenset())
        made.write(header_of(suite))
        return made

    @classmethod
    def resumed(cls, path: Path, suite: Suite, found: Collector) -> Self | None:
        """A file that goes on; None, with a diagnostic, if its results are not of this suite.

        A line that was cut off is dropped; a file that has not got as far as a header begins anew.
        """
        if not path.exists():
            return cls.new(path, suite)
        file = _locked(path.open("r+", encoding="utf-8", newline=""))
        if not path.read_bytes().count(b"\n"):
            file.truncate(0)
            made = cls(file, frozenset())
            made.write(header_of(suite))
            return made
        results = read_results(str(path), found)
        differs = None if results is None else _difference(results.header, suite)
        if differs is not None:
            found.add(OtherSuite(location=at(str(path)), differs=differs))
        if results is None or differs is not None:
            file.close()
            return None
        file.truncate(results.size)
        file.seek(0, 2)
        return cls(file, frozenset(record["key"] for record in results.records))

    def write(self, document: dict[str, Any]) -> None:
        """Append a document."""
        self._file.write(line_of(document))
        self._file.flush()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()


def _difference(header: dict[str, Any], suite: Suite) -> str | None:
    """How the suite of a header is another one."""
    if header["suite"] == suite.digest:
        return None
    if header["runs"] != len(suite.runs):
        return f"it has {header['runs']} runs, not {len(suite.runs)}"
    return "a file, an engine, a seed or a limit is not what it was"


def _locked(file: TextIO) -> TextIO:
    """A file that nobody else writes, where the system has such locks. Raises InUseError."""
    try:
        import fcntl
    except ImportError:
        return file
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        file.close()
        raise InUseError(f"`{file.name}` is being written by another run") from None
    return file
