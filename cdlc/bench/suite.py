"""Suites: what is to be solved, in which ways, and a hash of all of it."""

import errno
import glob
import json
import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256
from itertools import product
from pathlib import Path
from typing import Any, Final

from cdlc.bench.errors import NoProblems, at
from cdlc.bench.toml import Stated, read_toml
from cdlc.diagnostics import Collector
from cdlc.frontend.errors import UnreadableFile
from crow.many.tasks import Configuration
from crow.program import Location

_IS_PROBLEM: Final = re.compile(rb'^[ \t]*problem[ \t]+"', re.MULTILINE)
_NAMES_FILE: Final = re.compile(rb'^[ \t]*(?:domain|include)[ \t]+"([^"\n]+\.cdl)"', re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Run:
    """One problem, by its file, in one configuration; `domain` wins over the one it names."""

    file: str
    domain: str | None
    functions: str | None
    configuration: Configuration

    @property
    def key(self) -> str:
        """What tells this run from all others of its suite."""
        return f"{self.file} {self.configuration.label} seed={self.configuration.seed}"


@dataclass(frozen=True, slots=True)
class Options:
    """What the command line says of all suites; None and empty for nothing."""

    engines: tuple[str, ...] = ()
    seeds: tuple[int, ...] = ()
    limits: Mapping[str, Any] | None = None
    functions: str | None = None


@dataclass(frozen=True, slots=True)
class Suite:
    """All runs, each once, with a hash of the runs and of the texts they come from."""

    runs: tuple[Run, ...]
    digest: str


def suite_of(given: Iterable[str], options: Options, found: Collector) -> Suite:
    """The suite of what is given; mistakes are reported."""
    runs: dict[str, Run] = {}
    for one in given:
        stated = _stated(one, found)
        if stated is None:
            continue
        for run in _runs(stated, options):
            runs.setdefault(run.key, run)
    every = tuple(runs.values())
    return Suite(every, "" if found.has_errors else _digest(every))


def _stated(given: str, found: Collector) -> Stated | None:
    """What is given as a suite; None, with diagnostics, if it is none."""
    if given.endswith(".toml"):
        stated = read_toml(given, found)
        if stated is None:
            return None
        beside = Path(given).parent
        problems = [
            file
            for pattern, place in zip(stated.problems, stated.places, strict=True)
            for file in _problems(str(beside / pattern), place, found)
        ]
        return replace(stated, problems=tuple(problems))
    return Stated(tuple(_problems(given, at(given), found)))


def _problems(given: str, place: Location, found: Collector) -> list[str]:
    """The problem files that a file, folder or glob stands for, in order."""
    if Path(given).is_dir():
        files = sorted(path.as_posix() for path in Path(given).rglob("*.cdl"))
        problems = [file for file in files if _is_problem(file)]
        reason = "has no problems in it"
    elif glob.has_magic(given) and not Path(given).exists():
        files = sorted(glob.glob(given, recursive=True))  # noqa: PTH207 - it may be absolute
        problems = [Path(f).as_posix() for f in files if Path(f).is_file() and _is_problem(f)]
        reason = "matches no problem"
    elif not Path(given).exists():
        wanted_by = None if place.file == given else place
        reason = os.strerror(errno.ENOENT).lower()
        found.add(UnreadableFile(location=at(given), reason=reason, wanted_by=wanted_by))
        return []
    else:
        problems = [given] if _is_problem(given) else []
        reason = 'is no problem: it has no line `problem "…"`'
    if not problems:
        found.add(NoProblems(location=place, given=given, reason=reason))
    return problems


def _is_problem(file: str) -> bool:
    return bool(_IS_PROBLEM.search(_bytes(file)))


def _bytes(file: str) -> bytes:
    """What a file holds; nothing if it cannot be read, which is told when it is to be solved."""
    try:
        return Path(file).read_bytes()
    except OSError:
        return b""


def _runs(stated: Stated, options: Options) -> Iterator[Run]:
    """Each problem in each configuration with each seed, problem by problem."""
    seeds = options.seeds or stated.seeds
    limits = dict(options.limits or {})
    configurations: Sequence[Configuration] = [
        replace(one, **limits) for one in stated.configurations
    ]
    if options.engines:
        usual = replace(configurations[0], name="")
        configurations = [replace(usual, engine=engine) for engine in options.engines]
    functions = options.functions or stated.functions
    for file, configuration, seed in product(stated.problems, configurations, seeds):
        yield Run(file, stated.domain, functions, replace(configuration, seed=seed))


# --------------------------------------------------------------------------------------------- hash


def _digest(runs: tuple[Run, ...]) -> str:
    """A hash of the runs, and of what the files hold that they come from."""
    files: dict[str, str] = {}
    told = []
    for run in runs:
        for file in (run.file, run.domain, run.functions):
            if file is not None:
                _add(file, files)
        told.append([run.key, run.domain, run.functions, run.configuration.json()])
    document = json.dumps([told, sorted(files.items())])
    return sha256(document.encode()).hexdigest()


def _add(file: str, files: dict[str, str]) -> None:
    """Hash a file, and those it names."""
    waiting = [file]
    while waiting:
        name = waiting.pop()
        if name in files:
            continue
        data = _bytes(name)
        files[name] = sha256(data).hexdigest()
        if name.endswith(".cdl"):
            beside = Path(name).parent
            named = (one.decode("utf-8", "replace") for one in _NAMES_FILE.findall(data))
            waiting += [(beside / one).as_posix() for one in named]
