"""Messages about loops, and what is left of data-obliviousness."""

from collections.abc import Sequence
from dataclasses import dataclass

from cdlc.diagnostics import Diagnostic, Help, Label, Lint
from crow.program import Location


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class RangeNotConstant(Diagnostic):
    """A `range` whose bound is not known at compile time.

        for i in range(count(x)):

    CDL is data-oblivious (Appendix D.1): how often a loop runs cannot depend on the state. Use a
    number, or `foreach o: T:` to run once for each object.
    """

    reason: str = "not a whole number"

    def message(self) -> str:
        return "the bound of `range` is not known at compile time"

    def label(self) -> str:
        return self.reason

    def help(self) -> tuple[Help, ...]:
        return (Help("use a number, or `foreach o: T:` over objects"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class UnrollLimit(Diagnostic):
    """A `for` with more copies than can sensibly be written out.

        for i in range(10**12):

    Loops over a range are unrolled, and in nested loops the numbers of copies multiply. Use fewer
    iterations, or arithmetic instead of a loop.
    """

    variable: str
    copies: int
    limit: int
    around: Sequence[Location] = ()

    def message(self) -> str:
        times = f"{self.copies:,}" if self.copies < 10**30 else "over 10**30"
        return (
            f"the loop over `{self.variable}` would be unrolled into {times} copies;"
            f" the limit is {self.limit:,}"
        )

    def labels(self) -> tuple[Label, ...]:
        return tuple(Label(location, "inside this loop") for location in self.around)

    def help(self) -> tuple[Help, ...]:
        return (Help("use fewer iterations, or arithmetic instead of a loop"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class OuterLocal(Diagnostic):
    """An assignment, inside `foreach`, to a local from outside.

        let n = 0
        foreach o: Object:
          n = n + 1

    The iterations of a `foreach` run in parallel (Appendix D.3), so none sees what another wrote.
    """

    name: str
    first: Location | None

    def message(self) -> str:
        return f"`{self.name}` belongs to the code around the `foreach`"

    def label(self) -> str:
        return "iterations are parallel and cannot assign it"

    def labels(self) -> tuple[Label, ...]:
        return () if self.first is None else (Label(self.first, "introduced here"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class OutsideLoop(Diagnostic):
    """A `break` or `continue` that belongs to no `for` of its iteration.

        foreach o: Object:
          break

    They end a `for i in range(n):` or an iteration of it; a `foreach` is parallel and has no end to
    jump to.
    """

    word: str
    in_foreach: bool

    def message(self) -> str:
        return f"`{self.word}` outside a `for`"

    def label(self) -> str:
        return "iterations of `foreach` are parallel" if self.in_foreach else ""


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class WriteConflict(Diagnostic):
    """Iterations of a `foreach` that write different values to one cell.

        foreach x: block:
          highest[...] = x
        foreach x: block:
          weight[...] += mass(x)

    The iterations run in parallel (Appendix D.3): each reads the state before the loop and its own
    writes, so nothing adds up and no iteration is the last. Write a cell of each object,
    `f[x] = e`, or say with `exists` and `forall` what holds afterwards.
    """

    cell: str
    variable: str
    loop: Location | None
    augments: bool

    def message(self) -> str:
        if self.augments:
            return f"the iterations over `{self.variable}` all change `{self.cell}`"
        return f"the iterations over `{self.variable}` write different values to `{self.cell}`"

    def label(self) -> str:
        return f"this cell does not depend on `{self.variable}`, its value does"

    def labels(self) -> tuple[Label, ...]:
        return () if self.loop is None else (Label(self.loop, "parallel iterations"),)

    def help(self) -> tuple[Help, ...]:
        if self.augments:
            return (
                Help(
                    "iterations do not add up, as each starts from the value before the loop; count"
                    " in an external function, or keep one cell an object"
                ),
            )
        return (Help(f"index the cell by `{self.variable}`, or write it outside the `foreach`"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class PossibleWriteConflict(Lint):
    """Iterations of a `foreach` that write one cell, each with a value of its own.

        foreach x: block:
          loaded[...] = on(x, truck)

    Unless all values are equal, this is an error when the effect is applied: iterations are
    parallel and none is the last. Write what holds afterwards:
    `loaded[...] = exists x: block: on(x, truck)`.
    """

    cell: str
    variable: str
    loop: Location | None

    def message(self) -> str:
        return f"the iterations over `{self.variable}` may write different values to `{self.cell}`"

    def labels(self) -> tuple[Label, ...]:
        return () if self.loop is None else (Label(self.loop, "parallel iterations"),)

    def help(self) -> tuple[Help, ...]:
        return (Help("write the cell once, with `exists`, `forall` or a conditional value"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class MissingReturn(Diagnostic):
    """A `def` with a way through it that returns nothing.

        def f(x: block) -> bool:
          if clear(x):
            return True

    Add an `else`, or a `return` at the end.
    """

    name: str

    def message(self) -> str:
        return f"`{self.name}` does not return on every path"


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class ReturnInForeach(Diagnostic):
    """A `return` in a `foreach`, whose iterations are parallel: which of them would return?

        def covered() -> bool:
          foreach x: block:
            return clear(x)

    Use `forall`, `exists`, or a quantity computed without a loop.
    """

    def message(self) -> str:
        return "`return` inside `foreach`"

    def help(self) -> tuple[Help, ...]:
        return (Help("a property of all objects is `forall o: T: …`, of one `exists o: T: …`"),)
