"""Messages about reading files."""

from collections.abc import Sequence
from dataclasses import dataclass

from cdlc.diagnostics import Diagnostic, Help, Label
from crow.program import Location


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class UnreadableFile(Diagnostic):
    """A file that cannot be opened: it is missing, a directory, or not readable.

        cdlc check blokcs.cdl

    Check the name; `include` and `domain` paths are relative to the file they stand in.
    """

    reason: str
    wanted_by: Location | None = None

    def message(self) -> str:
        return f"cannot read `{self.location.file}`: {self.reason}"

    def labels(self) -> tuple[Label, ...]:
        return () if self.wanted_by is None else (Label(self.wanted_by, "named here"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class NotText(Diagnostic):
    """A file that is no UTF-8 text, such as a picture or an archive.

    CDL is UTF-8 text without NUL characters. Save the file as UTF-8, or name another file.
    """

    reason: str

    def message(self) -> str:
        return f"not a CDL text: {self.reason}"


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class EmptyFile(Diagnostic):
    """A file without a single definition.

        # only comments

    A domain defines at least a feature; a problem file names itself, its domain and a goal.
    """

    def message(self) -> str:
        return "the file defines nothing"

    def help(self) -> tuple[Help, ...]:
        return (Help('start with `typedef`, `feature` and `behavior`, or with `problem "name"`'),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class LineTooLong(Diagnostic):
    """A line of over a megabyte, which is a damaged or generated file.

    Break the line; brackets may span lines.
    """

    limit: int

    def message(self) -> str:
        return f"a line of over {self.limit:,} characters"


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class IncludeCycle(Diagnostic):
    """A file that includes itself, directly or through others.

        include "a.cdl"     # in b.cdl, which a.cdl includes

    Move what both need into a third file.
    """

    chain: Sequence[str]

    def message(self) -> str:
        return f"files include each other: {' → '.join(self.chain)}"
