"""Messages about the grammar."""

from dataclasses import dataclass

from cdlc.diagnostics import Diagnostic, Help, Replacement


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class SyntaxError_(Diagnostic):  # noqa: N801 - `SyntaxError` is a builtin
    """Text that the grammar does not allow at this place.

        achieve on(x,, y)

    The label says what was expected; the grammar is in docs/reference/grammar.md.
    """

    found: str
    expected: str
    hint: Help | None = None

    def message(self) -> str:
        return f"unexpected {self.found}"

    def label(self) -> str:
        return f"expected {self.expected}" if self.expected else ""

    def help(self) -> tuple[Help, ...]:
        return () if self.hint is None else (self.hint,)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class MissingColon(Diagnostic):
    """A header whose block follows without the `:` that opens it.

        behavior move_away(o: Object, t: Trajectory)
          goal: not blocking(o, t)

    Add the colon at the end of the line.
    """

    def message(self) -> str:
        return "missing `:`"

    def label(self) -> str:
        return "expected `:`"

    def help(self) -> tuple[Help, ...]:
        return (Help("add a colon", Replacement(self.location, ":")),)


_INSTEAD_OF_RESERVED = {
    "symbol": "`bind v: T where: …` introduces a variable with its constraint",
    "assert_hold": "an `assert` of a behavior with `eff` is held until its next `do`",
    "assert_once": "write `assert` in a behavior without `eff`",
    "achieve_hold": "an `achieve` of a behavior with `eff` is held until its next `do`",
    "pachieve": "write `achieve`",
    "untrack": "write `achieve_once` for a condition that need not hold any longer",
    "preamble": "statements before `promotable:` run first",
    "critical": "statements outside `promotable:` are never interleaved",
    "mem_query": "`bind o: T where: …` finds an object by a condition",
    "findall": "`foreach o: T:` with `if` visits all objects with a property",
    "findone": "`bind o: T where: …` finds one object with a property",
    "batched": "conditions over many objects are `forall` and `exists`",
    "heuristic": "planners choose their heuristic with an option",
    "undirected_generator": "write one `generator` for each direction",
    "import": '`include "file.cdl"` brings in definitions',
}


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class ReservedWord(Diagnostic):
    """A construct of the authors' implementation that is not part of this language yet.

        symbol p

    The word is reserved, also as a name; the help says what to write instead.
    """

    word: str

    def message(self) -> str:
        return f"`{self.word}` is not supported"

    def label(self) -> str:
        return "reserved word"

    def help(self) -> tuple[Help, ...]:
        return (Help(_INSTEAD_OF_RESERVED[self.word]),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class WhileLoop(Diagnostic):
    """A loop whose length depends on the state.

        while pose[x] > 0:
          do move_to(x, pose[x] - 1)

    CDL is data-oblivious (Appendix D.1): how long a program is depends on the objects only, so that
    it can be turned into preconditions and effects. Use `for i in range(n):` with a bound known at
    compile time, `foreach o: T:` over the objects of a type, or `achieve` the condition the loop is
    to reach and let behaviors refine it as often as needed.
    """

    def message(self) -> str:
        return "`while` is not data-oblivious"

    def label(self) -> str:
        return "its length depends on the state"

    def help(self) -> tuple[Help, ...]:
        return (
            Help("use `for i in range(n):`, `foreach o: T:`, or `achieve` what it is to reach"),
        )


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class Elision(Diagnostic):
    """`...` as it stands for omitted text in a paper.

        forall x: Object: g[x, ...] = True

    `f[...]` names the one cell of a feature without arguments; other uses of `...` are no CDL.
    Write out what it stands for.
    """

    def message(self) -> str:
        return "`...` stands for omitted text here"

    def label(self) -> str:
        return "write the arguments out"

    def notes(self) -> tuple[str, ...]:
        return ("`f[...]` is only for a feature `f` without arguments",)
