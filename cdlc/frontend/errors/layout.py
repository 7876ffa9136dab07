"""Messages about lines and indentation."""

from collections.abc import Sequence
from dataclasses import dataclass

from cdlc.diagnostics import Diagnostic, Help, Label, Replacement
from crow.program import Location


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class TabInIndentation(Diagnostic):
    """A tab before the first word of a line.

    Indentation is by spaces, so that a file means the same in every editor. Replace the tab.
    """

    text: str

    def message(self) -> str:
        return "tab in indentation"

    def help(self) -> tuple[Help, ...]:
        spaces = self.text.expandtabs(4)
        return (Help("indent with spaces", Replacement(self.location, spaces)),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class InconsistentIndentation(Diagnostic):
    """A line indented less than its block, but like no block around it.

        body:
            achieve a()
          achieve b()     # 4 or 0 spaces, not 2

    Align the line with the block it belongs to.
    """

    levels: Sequence[int]

    def message(self) -> str:
        return "indentation matches no enclosing block"

    def help(self) -> tuple[Help, ...]:
        levels = ", ".join(str(level) for level in sorted(set(self.levels)))
        return (Help(f"the blocks around it are indented by {levels} spaces"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class UnexpectedIndentation(Diagnostic):
    """A line indented deeper than the one before it, which opens no block.

        feature f()
          feature g()

    Remove the indentation, or end the line before with `:`.
    """

    def message(self) -> str:
        return "unexpected indentation"

    def label(self) -> str:
        return "no block is opened before this line"


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class ExpectedBlock(Diagnostic):
    """A line that ends in `:` without an indented block under it.

        body:
        eff:
          f[...] = True

    Indent what belongs to it, or write `pass`.
    """

    def message(self) -> str:
        return "expected an indented block"

    def label(self) -> str:
        return "nothing is indented under this line"

    def help(self) -> tuple[Help, ...]:
        return (Help("indent the block, or write `pass` for an empty one"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class UnclosedBracket(Diagnostic):
    """A bracket that is never closed; everything after it would belong to it.

        achieve on(x, y
        achieve clear(x)

    The line it stands on is left out and reading goes on with the next one. Add the bracket.
    """

    bracket: str
    closing: str

    def message(self) -> str:
        return f"`{self.bracket}` is never closed"

    def help(self) -> tuple[Help, ...]:
        return (Help(f"add the matching `{self.closing}`"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class UnmatchedBracket(Diagnostic):
    """A closing bracket that fits no open one.

        achieve on(x, y))

    Remove it, or add the bracket it was to close.
    """

    bracket: str
    opened: Location | None

    def message(self) -> str:
        return f"unmatched `{self.bracket}`"

    def labels(self) -> tuple[Label, ...]:
        return () if self.opened is None else (Label(self.opened, "this bracket is open"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class NestingTooDeep(Diagnostic):
    """Brackets, blocks or expressions nested beyond what a person writes.

        assert not not not not …

    Brackets may nest 1,000 deep, blocks 100 and expressions 150, where a chain of `+` counts a
    level for each term and one of `and` or `or` a single level; files include each other and types
    are based on each other at most 100 deep. Name parts of the expression with `let` or a `def`.
    """

    limit: int

    def message(self) -> str:
        return f"nested more than {self.limit:,} deep"

    def help(self) -> tuple[Help, ...]:
        return (Help("name parts of it with `let` or a `def`"),)
