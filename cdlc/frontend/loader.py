"""Files to definitions: reading, `include`, and the domain that a problem file names."""

import codecs
import errno
import os
import re
import stat
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from crow.program import Location

from cdlc.diagnostics import Collector
from cdlc.frontend import errors, syntax
from cdlc.frontend.check_declarations import Sourced
from cdlc.frontend.parser import parse
from cdlc.source import SourceFile

EMPTY_DOMAIN = "__empty__"
STANDARD_INPUT = "-"
# A generated problem of a million facts is a tenth of it.
MAX_BYTES = 200_000_000

_START = (1, 1, 1, 1)


@dataclass(slots=True)
class Files:
    """The files of one compilation: `sources` holds every text read, by the name shown for it."""

    found: Collector
    read_standard_input: Callable[[], bytes]
    sources: dict[str, SourceFile] = field(default_factory=dict)
    modules: dict[str, syntax.Module] = field(default_factory=dict)
    included: set[str] = field(default_factory=set)

    def load(self, name: str, wanted_by: Location | None = None) -> syntax.Module | None:
        """Read and parse a file once; None, with a diagnostic, when it cannot be read."""
        if name in self.modules:
            return self.modules[name]
        source = self.read(name, wanted_by)
        if source is None:
            self.found.forgive_names()
            return None
        before = len(self.found.found)
        module = parse(source, self.found)
        if not module.definitions and len(self.found.found) == before:
            self.found.add(errors.EmptyFile(location=Location(name, *_START)))
        self.modules[name] = module
        return module

    def definitions(self, name: str, chain: tuple[str, ...] = ()) -> Iterator[Sourced]:
        """The definitions of a loaded file, those of its includes in their places."""
        source = self.sources[name]
        for node in self.modules[name].definitions:
            if not isinstance(node, syntax.Include):
                yield source, node
                continue
            path = beside(name, node.path)
            location = source.location(node.span)
            if path in (*chain, name):
                whole = (*chain, name, path)
                self.found.add(errors.IncludeCycle(location=location, chain=whole))
            elif self.load(path, location) is not None:
                self.included.add(path)
                yield from self.definitions(path, (*chain, name))

    def read(self, name: str, wanted_by: Location | None = None) -> SourceFile | None:
        """Read a file's text; None, with a diagnostic, when it cannot be read."""
        source = self._read(name, wanted_by)
        if source is not None:
            self.sources[name] = source
        return source

    def _read(self, name: str, wanted_by: Location | None) -> SourceFile | None:
        try:
            data = self.read_standard_input() if name == STANDARD_INPUT else _read_regular(name)
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
        except ValueError:  # a NUL or a surrogate in the name
            reason = "not a file name"
        else:
            if len(data) <= MAX_BYTES:
                return _decode(name, data, self.found)
            reason = f"over {MAX_BYTES // 1_000_000} MB"
        location = Location(name, *_START)
        self.found.add(errors.UnreadableFile(location=location, reason=reason, wanted_by=wanted_by))
        return None


def _read_regular(name: str) -> bytes:
    """The bytes of a regular file, one more than are allowed at most; others may never end."""
    # Opening a FIFO would wait for a writer.
    descriptor = os.open(name, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0))
    with os.fdopen(descriptor, "rb") as file:
        mode = os.fstat(descriptor).st_mode
        if stat.S_ISDIR(mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        if not stat.S_ISREG(mode):
            raise OSError(errno.EINVAL, "not a regular file")
        return file.read(MAX_BYTES + 1)


def _decode(name: str, data: bytes, found: Collector) -> SourceFile | None:
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        found.add(errors.NotText(location=Location(name, *_START), reason="it is UTF-16"))
        return None
    if b"\0" in data:
        line = data.count(b"\n", 0, data.index(b"\0")) + 1
        location = Location(name, line, 1, line, 1)
        found.add(errors.NotText(location=location, reason="it contains a NUL character"))
        return None
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        start = data.rfind(b"\n", 0, error.start) + 1
        line = data.count(b"\n", 0, start) + 1
        column = len(data[start : error.start].decode("utf-8", "replace")) + 1
        location = Location(name, line, column, line, column + 1)
        found.add(errors.NotText(location=location, reason="it is not UTF-8"))
        return None
    # Lines may end as on old Macs; offsets stay what they are.
    return SourceFile(name, re.sub("\r(?!\n)", "\n", text) if "\r" in text else text)


def beside(name: str, path: str) -> str:
    """A path as written in a file, relative to the folder of that file."""
    return path if name == STANDARD_INPUT else str(Path(name).parent / path)


def title(module: syntax.Module, keyword: str) -> syntax.Title | None:
    """The `domain "…"` or `problem "…"` line of a file."""
    titles = (n for n in module.definitions if isinstance(n, syntax.Title))
    return next((t for t in titles if t.keyword == keyword), None)
