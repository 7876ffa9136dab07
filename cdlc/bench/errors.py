"""Every message about suites and files of results. The docstring of a kind is its page."""

from dataclasses import dataclass

from cdlc.diagnostics import Diagnostic, Help
from crow.program import Location


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class BadSuite(Diagnostic):
    """A suite, given to `cdlc bench` as a TOML file, that cannot be read or says what is not known.

        problems = ["easy/*.cdl"]       # relative to this file
        engines = ["auto", "best"]
        seeds = 5                       # or a list: [0, 3, 7]
        time-limit = 30.0

    Its keys are those of the table in docs/reference/commands.md; limits are positive numbers.
    """

    reason: str
    cure: str | None = None

    def message(self) -> str:
        return self.reason

    def help(self) -> tuple[Help, ...]:
        return () if self.cure is None else (Help(self.cure),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class NoProblems(Diagnostic):
    """Something given to `cdlc bench`, or listed in a suite, that names no problem.

        cdlc bench examples/blocks

    A folder stands for the files `*.cdl` in it, at any depth, that begin with a line `problem "…"`;
    domains among them are left out. A glob stands for the files that it matches.
    """

    given: str
    reason: str

    def message(self) -> str:
        return f"`{self.given}` {self.reason}"

    def help(self) -> tuple[Help, ...]:
        return (Help("give problem files, a folder or glob of some, or a suite (TOML)"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class BadResults(Diagnostic):
    """A file of results that `cdlc bench` did not write, or that was changed since.

        cdlc report results.jsonl

    Its first line is a header and each further one a record, in JSON. A last line that was cut off,
    as by a crash, is no fault: `cdlc bench --resume` drops it.
    """

    reason: str

    def message(self) -> str:
        return f"not a file of results: {self.reason}"

    def help(self) -> tuple[Help, ...]:
        return (Help("`cdlc bench SUITE --out FILE.jsonl` writes them"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class OtherSuite(Diagnostic):
    """Results of another suite than the one that is to go on.

        cdlc bench suite.toml --out results.jsonl --resume

    The results are those of the same files, texts, engines, seeds and limits, or they would not
    belong together. What has changed since may be one of these; then the run has to begin anew.
    """

    differs: str

    def message(self) -> str:
        return f"these are results of another suite: {self.differs}"

    def help(self) -> tuple[Help, ...]:
        return (Help("give another name to `--out`, and no `--resume`"),)


def at(file: str, line: int = 1, column: int = 1, length: int = 1) -> Location:
    """A place on one line of a file."""
    return Location(file, line, column, line, column + length)
