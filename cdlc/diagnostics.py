"""What the compiler has to say about its input: one frozen dataclass a kind of problem.

Values are fields and texts are small methods, so a kind reads as one page; its docstring is that
page for `cdlc explain`. The code is the class name in kebab case and never changes its meaning.
"""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from enum import StrEnum
from typing import ClassVar

from crow.program import Location


class Severity(StrEnum):
    """How bad it is: errors stop the pipeline, warnings do not."""

    ERROR = "error"
    WARNING = "warning"


@dataclass(frozen=True, slots=True)
class Label:
    """A place and what is to be said about it."""

    location: Location
    text: str


@dataclass(frozen=True, slots=True)
class Replacement:
    """New text for a place."""

    location: Location
    text: str


@dataclass(frozen=True, slots=True)
class Help:
    """A proposal, with the edit that carries it out where there is one."""

    text: str
    replacement: Replacement | None = None


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class Diagnostic:
    """One problem in the input, at one place."""

    location: Location

    code: ClassVar[str] = ""
    severity: ClassVar[Severity] = Severity.ERROR
    kinds: ClassVar[dict[str, type["Diagnostic"]]] = {}

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        cls.code = re.sub(r"(?<!^)(?=[A-Z])", "-", cls.__name__.rstrip("_")).lower()
        Diagnostic.kinds[cls.code] = cls

    # Written once instead of compiled for each kind: that is a good part of start-up.
    def __repr__(self) -> str:
        return f"<{self.code} at {self.location}>"

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and vars(other) == vars(self)

    def __hash__(self) -> int:
        return hash((type(self), self.location))

    def message(self) -> str:
        """The problem in one line."""
        raise NotImplementedError

    def label(self) -> str:
        """What is wrong at the very place; may be empty."""
        return ""

    def labels(self) -> tuple[Label, ...]:
        """Other places that belong to the problem."""
        return ()

    def notes(self) -> tuple[str, ...]:
        """Explanations."""
        return ()

    def help(self) -> tuple[Help, ...]:
        """Proposals for a cure."""
        return ()

    def missing_name(self) -> str | None:
        """The name that is said to be missing; see `Collector.forgive_names`."""
        return None


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class Lint(Diagnostic):
    """A problem that does not stop the pipeline."""

    severity: ClassVar[Severity] = Severity.WARNING


# The two bases are no kinds of their own.
Diagnostic.kinds.clear()


@dataclass(slots=True)
class Collector:
    """Gathers diagnostics; a problem reported twice at one place is kept once."""

    found: list[Diagnostic] = field(default_factory=list)
    _seen: set[tuple[str, Location]] = field(default_factory=set)
    _forgiven: set[str] = field(default_factory=set)
    _forgives_all: bool = False

    def add(self, diagnostic: Diagnostic) -> None:
        """Keep a diagnostic, unless it follows from an earlier one."""
        name = diagnostic.missing_name()
        if name is not None and (self._forgives_all or name in self._forgiven):
            return
        key = (diagnostic.code, diagnostic.location)
        if key not in self._seen:
            self._seen.add(key)
            self.found.append(diagnostic)

    def forgive_names(self, names: Iterable[str] | None = None) -> None:
        """Drop later complaints that these names are missing, or that any is.

        What could not be read may define them; that it could not be read has been reported.
        """
        if names is None:
            self._forgives_all = True
        else:
            self._forgiven.update(names)

    @property
    def errors(self) -> int:
        """How many of them are errors."""
        return sum(d.severity is Severity.ERROR for d in self.found)

    @property
    def has_errors(self) -> bool:
        """Whether any of them is an error."""
        return any(d.severity is Severity.ERROR for d in self.found)

    def sorted(self) -> tuple[Diagnostic, ...]:
        """All of them in source order."""
        return tuple(sorted(self.found, key=lambda d: d.location))

    def __iter__(self) -> Iterator[Diagnostic]:
        return iter(self.sorted())


def nearest(name: str, known: list[str]) -> str | None:
    """The known name most like `name`, ignoring case, or None when none is close."""
    from difflib import get_close_matches  # which most runs do without

    by_folded = {candidate.lower(): candidate for candidate in reversed(known)}
    matches = get_close_matches(name.lower(), by_folded, n=1, cutoff=0.7)
    return by_folded[matches[0]] if matches else None


def suggest(name: str, known: list[str], location: Location) -> tuple[Help, ...]:
    """A "did you mean" for an unknown name, or nothing."""
    match = nearest(name, known)
    if match is None:
        return ()
    return (Help(f"did you mean `{match}`?", Replacement(location, match)),)
