"""A suite in TOML: read, with every mistake in it told at its place."""

import re
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from difflib import get_close_matches
from pathlib import Path
from typing import Any, Final

from cdlc.bench.errors import BadSuite, at
from cdlc.diagnostics import Collector
from cdlc.frontend.errors import UnreadableFile
from crow.many.tasks import Configuration
from crow.planning import ENGINES, HEURISTICS
from crow.program import Location

_PLACE: Final = re.compile(r"\(at line (\d+), column (\d+)\)$")


@dataclass(frozen=True, slots=True)
class Stated:
    """What a suite states: globs or files of problems, and how they are to be solved.

    `places` says where each of `problems` is named.
    """

    problems: tuple[str, ...]
    places: tuple[Location, ...] = ()
    domain: str | None = None
    functions: str | None = None
    seeds: tuple[int, ...] = (0,)
    configurations: tuple[Configuration, ...] = (Configuration(),)


def _is_positive(value: object) -> bool:
    return type(value) in (int, float) and 0 < value < float("inf")  # type: ignore[operator]


def _is_count(value: object) -> bool:
    return type(value) is int and value > 0


def _is_names(value: object) -> bool:
    return isinstance(value, list) and bool(value) and all(type(v) is str for v in value)


def _is_seeds(value: object) -> bool:
    is_list = isinstance(value, list) and bool(value) and all(type(v) is int for v in value)
    return _is_count(value) or is_list


def _is_engines(value: object) -> bool:
    return _is_names(value) and isinstance(value, list) and set(value) <= set(ENGINES)


_Check = tuple[Callable[[object], bool], str]
_TEXT: Final[_Check] = (lambda value: type(value) is str and bool(value), "a string")
_HOW: Final[Mapping[str, tuple[str, _Check]]] = {
    "engine": ("engine", (lambda v: v in ENGINES, f"one of {', '.join(ENGINES)}")),
    "h": ("h", (lambda v: v in HEURISTICS, f"one of {', '.join(HEURISTICS)}")),
    "time-limit": ("time_limit", (_is_positive, "a positive number of seconds")),
    "node-limit": ("node_limit", (_is_count, "a positive whole number")),
    "depth-limit": ("depth_limit", (_is_count, "a positive whole number")),
    "draw-limit": ("draw_limit", (_is_count, "a positive whole number")),
    "max-memory": ("memory_limit_mb", (_is_count, "a positive whole number of MiB")),
    "optimal": ("optimal", (lambda value: type(value) is bool, "true or false")),
}
"""Keys that say how to plan: the field of a Configuration, and what its value has to be."""

_TOP: Final[Mapping[str, _Check]] = {
    "problems": (_is_names, "a list of files, folders or globs, relative to the suite"),
    "domain": _TEXT,
    "functions": _TEXT,
    "engines": (_is_engines, f"a list of some of {', '.join(ENGINES)}"),
    "seeds": (_is_seeds, "a number of seeds, or a list of them"),
    "configurations": (
        lambda value: (
            isinstance(value, list) and bool(value) and all(type(v) is dict for v in value)
        ),
        "tables: write `[[configurations]]`",
    ),
    **{key: check for key, (_, check) in _HOW.items() if key != "engine"},
}
_ONE: Final[Mapping[str, _Check]] = {"name": _TEXT} | {k: check for k, (_, check) in _HOW.items()}


def read_toml(file: str, found: Collector) -> Stated | None:
    """The suite that a file states; None, with diagnostics, if it has mistakes."""
    reader = _Reader(file, found)
    document = reader.document()
    if document is None:
        return None
    before = len(found.found)
    reader.check(document, _TOP, 1)
    if "problems" not in document:
        reader.mistake("`problems` is missing", 1, "", 'add `problems = ["*.cdl"]`')
    if "engines" in document and "configurations" in document:
        told = "`engines` and `[[configurations]]` both say which there are"
        reader.mistake(told, 1, "engines", "give each configuration its `engine`, and no `engines`")
    tables = document.get("configurations")
    if isinstance(tables, list):
        for number, table in enumerate(tables):
            if isinstance(table, dict):
                reader.check(table, _ONE, reader.line_of_table(number))
    if len(found.found) > before:
        return None
    places = tuple(map(reader.place_of, document["problems"]))
    stated = replace(_stated(Path(file).parent, document), places=places)
    labels = [one.label for one in stated.configurations]
    for label in sorted({label for label in labels if labels.count(label) > 1}):
        told = f"two configurations are called `{label}`"
        start = reader.line_of_table(len(labels) - 1 - labels[::-1].index(label))
        reader.mistake(told, start, "", "give each a `name`, or take one away")
    return None if len(found.found) > before else stated


def _stated(beside: Path, document: dict[str, Any]) -> Stated:
    """What a document without mistakes states."""
    usual = _arguments(document)
    tables = document.get("configurations") or [
        {"engine": engine} for engine in document.get("engines", ["auto"])
    ]
    seeds = document.get("seeds", [0])
    functions, domain = document.get("functions"), document.get("domain")
    return Stated(
        tuple(document["problems"]),
        domain=None if domain is None else (beside / domain).as_posix(),
        functions=None if functions is None else (beside / functions).as_posix(),
        seeds=tuple(range(seeds)) if isinstance(seeds, int) else tuple(dict.fromkeys(seeds)),
        configurations=tuple(
            Configuration(name=table.get("name", ""), **{**usual, **_arguments(table)})
            for table in tables
        ),
    )


def _arguments(table: Mapping[str, Any]) -> dict[str, Any]:
    return {field: table[key] for key, (field, _) in _HOW.items() if key in table}


class _Reader:
    """The text of a suite, and where things stand in it: TOML's own reader does not tell."""

    def __init__(self, file: str, found: Collector) -> None:
        self.file = file
        self.found = found
        self.lines: list[str] = []

    def document(self) -> dict[str, Any] | None:
        """The document; None, with a diagnostic, if it cannot be read."""
        try:
            text = Path(self.file).read_text("utf-8")
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            self.found.add(UnreadableFile(location=at(self.file), reason=reason))
            return None
        except UnicodeDecodeError:
            self.found.add(BadSuite(location=at(self.file), reason="it is not UTF-8"))
            return None
        self.lines = text.splitlines()
        try:
            return tomllib.loads(text)
        except tomllib.TOMLDecodeError as error:
            place = _PLACE.search(str(error))
            line, column = (int(place[1]), int(place[2])) if place else (len(self.lines), 1)
            told = _PLACE.sub("", str(error)).strip()
            reason = f"no TOML: {told[:1].lower()}{told[1:]}"
            self.found.add(BadSuite(location=at(self.file, line, column), reason=reason))
            return None

    def check(self, table: Mapping[str, Any], known: Mapping[str, _Check], start: int) -> None:
        """Report keys that are not known, and values that are not as they have to be."""
        for key, value in table.items():
            if key not in known:
                near = get_close_matches(key.replace("_", "-"), known, 1)
                cure = f"did you mean `{near[0]}`?" if near else f"there are {', '.join(known)}"
                self.mistake(f"there is no key `{key}`", start, key, cure)
            elif not known[key][0](value):
                self.mistake(f"`{key}` has to be {known[key][1]}", start, key, None)

    def line_of_table(self, number: int) -> int:
        """The line of the header of one of the configurations, from 0."""
        headers = [i for i, line in enumerate(self.lines, 1) if _is_header(line)]
        return headers[number] if number < len(headers) else 1

    def place_of(self, text: str) -> Location:
        """Where a string stands in the file; the start of the file if that is not found."""
        for number, line in enumerate(self.lines, 1):
            for quoted in (f'"{text}"', f"'{text}'"):
                column = line.find(quoted)
                if column >= 0:
                    return at(self.file, number, column + 1, len(quoted))
        return at(self.file)

    def mistake(self, reason: str, start: int, key: str, cure: str | None) -> None:
        """Report a mistake, at a key on or after a line if it is found there."""
        line, column = self._place(start, key)
        place = at(self.file, line, column, max(1, len(key)))
        self.found.add(BadSuite(location=place, reason=reason, cure=cure))

    def _place(self, start: int, key: str) -> tuple[int, int]:
        wanted = re.compile(rf"[\s{{,\"']*({re.escape(key)})[\"']?\s*=") if key else None
        for number in range(start, len(self.lines) + 1):
            match = wanted and wanted.match(self.lines[number - 1])
            if match:
                return number, match.start(1) + 1
        return start, 1


def _is_header(line: str) -> bool:
    return re.match(r"\s*\[\[\s*configurations\s*\]\]", line) is not None
