"""Every message of the frontend. The docstring of a kind is its page in `cdlc explain`."""

from collections.abc import Sequence
from dataclasses import dataclass

from cdlc.diagnostics import Diagnostic, Help, Label, Lint, Replacement, suggest
from crow.program import Location, Type

# ------------------------------------------------------------------------------------ reading files


@dataclass(frozen=True, kw_only=True)
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


@dataclass(frozen=True, kw_only=True)
class NotText(Diagnostic):
    """A file that is no UTF-8 text, such as a picture or an archive.

    CDL is UTF-8 text without NUL characters. Save the file as UTF-8, or name another file.
    """

    reason: str

    def message(self) -> str:
        return f"not a CDL text: {self.reason}"


@dataclass(frozen=True, kw_only=True)
class EmptyFile(Diagnostic):
    """A file without a single definition.

    A domain defines at least a feature; a problem file names itself, its domain and a goal.
    """

    def message(self) -> str:
        return "the file defines nothing"

    def help(self) -> tuple[Help, ...]:
        return (Help('start with `typedef`, `feature` and `behavior`, or with `problem "name"`'),)


@dataclass(frozen=True, kw_only=True)
class LineTooLong(Diagnostic):
    """A line of over a megabyte, which is a damaged or generated file.

    Break the line; brackets may span lines.
    """

    limit: int

    def message(self) -> str:
        return f"a line of over {self.limit:,} characters"


@dataclass(frozen=True, kw_only=True)
class IncludeCycle(Diagnostic):
    """A file that includes itself, directly or through others.

        include "a.cdl"     # in b.cdl, which a.cdl includes

    Move what both need into a third file.
    """

    chain: Sequence[str]

    def message(self) -> str:
        return f"files include each other: {' → '.join(self.chain)}"


# ------------------------------------------------------------------------------------------- layout


@dataclass(frozen=True, kw_only=True)
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


@dataclass(frozen=True, kw_only=True)
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


@dataclass(frozen=True, kw_only=True)
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


@dataclass(frozen=True, kw_only=True)
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


@dataclass(frozen=True, kw_only=True)
class UnclosedBracket(Diagnostic):
    """A bracket that is never closed; everything after it would belong to it."""

    bracket: str
    closing: str

    def message(self) -> str:
        return f"`{self.bracket}` is never closed"

    def help(self) -> tuple[Help, ...]:
        return (Help(f"add the matching `{self.closing}`"),)


@dataclass(frozen=True, kw_only=True)
class UnmatchedBracket(Diagnostic):
    """A closing bracket that fits no open one."""

    bracket: str
    opened: Location | None

    def message(self) -> str:
        return f"unmatched `{self.bracket}`"

    def labels(self) -> tuple[Label, ...]:
        return () if self.opened is None else (Label(self.opened, "this bracket is open"),)


@dataclass(frozen=True, kw_only=True)
class NestingTooDeep(Diagnostic):
    """Brackets, blocks or expressions nested beyond what a person writes.

    Name parts of it with `let` or a `def`.
    """

    limit: int

    def message(self) -> str:
        return f"nested more than {self.limit:,} deep"

    def help(self) -> tuple[Help, ...]:
        return (Help("name parts of it with `let` or a `def`"),)


# ------------------------------------------------------------------------------------------- syntax


@dataclass(frozen=True, kw_only=True)
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


@dataclass(frozen=True, kw_only=True)
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


@dataclass(frozen=True, kw_only=True)
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


@dataclass(frozen=True, kw_only=True)
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


@dataclass(frozen=True, kw_only=True)
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


# -------------------------------------------------------------------------------------------- names

# What is a literal or an object elsewhere, with its CDL spelling and advice.
_OTHER_LITERALS: dict[str, tuple[str | None, str]] = {
    "true": ("True", "write `True`"),
    "false": ("False", "write `False`"),
    **dict.fromkeys(
        ("None", "null", "nil"),
        (None, "there is no such value: every feature has one of its type"),
    ),
    "self": (None, "there is no `self`; a behavior reads features of its parameters"),
}


@dataclass(frozen=True, kw_only=True)
class UnknownName(Diagnostic):
    """A name that nothing in scope has.

        behavior r(x: block):
          goal: clear(z)

    Names are case-sensitive. Correct the spelling, or declare the name.
    """

    name: str
    known: Sequence[str]
    what: str = "name"

    def message(self) -> str:
        return f"unknown {self.what} `{self.name}`"

    def label(self) -> str:
        return "not defined"

    def missing_name(self) -> str | None:
        return self.name

    def help(self) -> tuple[Help, ...]:
        if self.name in _OTHER_LITERALS:
            literal, text = _OTHER_LITERALS[self.name]
            return (Help(text, None if literal is None else Replacement(self.location, literal)),)
        return suggest(self.name, list(self.known), self.location)


@dataclass(frozen=True, kw_only=True)
class UnknownFeature(UnknownName):
    """A read, write or call of a feature or function that is not defined.

        achieve claer(x)

    Correct the spelling, or declare it: `feature clear(x: block)`.
    """

    what: str = "feature or function"


@dataclass(frozen=True, kw_only=True)
class UnknownType(UnknownName):
    """A type that is neither built in nor defined by a `typedef`.

        feature on(x: blok)

    Correct the spelling, or declare it: `typedef block: object`.
    """

    what: str = "type"


@dataclass(frozen=True, kw_only=True)
class UnknownCommand(UnknownName):
    """A call of a controller or behavior that is not defined.

        do pick_up(x)

    Correct the spelling, or declare it: `controller pick_up(x: block)`.
    """

    what: str = "controller or behavior"


@dataclass(frozen=True, kw_only=True)
class DuplicateDefinition(Diagnostic):
    """Two definitions, objects or constants with one name.

    Types have names of their own; all other definitions, objects and constants share one space.
    Rename one of them.
    """

    name: str
    first: Location

    def message(self) -> str:
        return f"`{self.name}` is defined twice"

    def label(self) -> str:
        return "defined again here"

    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, "first defined here"),)


@dataclass(frozen=True, kw_only=True)
class HidesDefinition(Diagnostic):
    """A parameter or local with the name of a definition or object.

        feature x()
        behavior r(x: block):

    Rename the parameter or local.
    """

    name: str
    defined: Location | None

    def message(self) -> str:
        return f"`{self.name}` is already the name of a definition"

    def labels(self) -> tuple[Label, ...]:
        return () if self.defined is None else (Label(self.defined, "defined here"),)

    def help(self) -> tuple[Help, ...]:
        return (Help("choose another name"),)


@dataclass(frozen=True, kw_only=True)
class Shadowing(Lint):
    """A `bind` or `let` that takes the name of a parameter or of an earlier local.

        behavior move_away(o: Object, t: Trajectory):
          body:
            bind t: Trajectory where: connect(a, b, t)

    From here on the name means the new variable, in its own condition too. Choose another name if
    that is not meant.
    """

    name: str
    first: Location | None

    def message(self) -> str:
        return f"`{self.name}` shadows an earlier variable"

    def labels(self) -> tuple[Label, ...]:
        return () if self.first is None else (Label(self.first, "the earlier one"),)


@dataclass(frozen=True, kw_only=True)
class WrongKind(Diagnostic):
    """A name used as something it is not.

        do clear(x)        # `clear` is a feature

    The help says how such a thing is used.
    """

    name: str
    is_a: str
    wanted: str
    advice: str
    defined: Location | None

    def message(self) -> str:
        article = "an" if self.is_a[0] in "aeio" else "a"
        return f"`{self.name}` is {article} {self.is_a}, not a {self.wanted}"

    def labels(self) -> tuple[Label, ...]:
        return () if self.defined is None else (Label(self.defined, "defined here"),)

    def help(self) -> tuple[Help, ...]:
        return (Help(self.advice),) if self.advice else ()


@dataclass(frozen=True, kw_only=True)
class UnknownAnnotation(Lint):
    """An annotation that no part of the toolchain knows.

        feature [[colour]] f()

    Known are `min`, `max`, `reads`, `max_nested`, `tolerance` and `pddl`. It is kept in the program
    and has no effect.
    """

    name: str
    near: str | None = None

    def message(self) -> str:
        return f"unknown annotation `{self.name}`"

    def help(self) -> tuple[Help, ...]:
        return () if self.near is None else (Help(f"did you mean `{self.near}`?"),)


@dataclass(frozen=True, kw_only=True)
class BadAnnotation(Diagnostic):
    """A known annotation in the wrong place or with the wrong value.

        feature [[min=20, max=0]] level(x: tank) -> int32

    `min` and `max` bound a feature of an integer type; `reads` names the features that an external
    function reads, or `all`; `max_nested` on a behavior is a whole number from 1 on; `tolerance` on
    a value typedef is a number; `pddl` is a string. Correct the value, or move the annotation.
    """

    name: str
    reason: str
    example: str

    def message(self) -> str:
        return f"wrong annotation `{self.name}`: {self.reason}"

    def help(self) -> tuple[Help, ...]:
        return (Help(f"for example `{self.example}`"),)


@dataclass(frozen=True, kw_only=True)
class UnknownPragma(Lint):
    """A `#!pragma` line; none is known, and the line is read as a comment."""

    def message(self) -> str:
        return "unknown pragma"


# -------------------------------------------------------------------------------------------- types


@dataclass(frozen=True, kw_only=True)
class WrongArgumentCount(Diagnostic):
    """A call or read with more or fewer arguments than declared.

    feature on(x: block, y: block)
    achieve on(x)
    """

    name: str
    expected: int
    found: int
    declared: Location | None
    most: int | None = None

    def message(self) -> str:
        plural = "" if self.expected == 1 and self.most is None else "s"
        wanted = f"{self.expected}" if self.most is None else f"{self.expected} to {self.most}"
        return f"`{self.name}` takes {wanted} argument{plural}, not {self.found}"

    def labels(self) -> tuple[Label, ...]:
        return () if self.declared is None else (Label(self.declared, "declared here"),)


@dataclass(frozen=True, kw_only=True)
class WrongArgumentType(Diagnostic):
    """An argument whose type is not that of the parameter.

    controller attach(x: Object)
    do attach(pose)
    """

    name: str
    expected: Type
    found: Type
    declared: Location | None
    fitting: str | None = None

    def message(self) -> str:
        return f"wrong argument type in call of `{self.name}`"

    def label(self) -> str:
        return f"expected `{self.expected}`, found `{self.found}`"

    def labels(self) -> tuple[Label, ...]:
        return () if self.declared is None else (Label(self.declared, "declared here"),)

    def help(self) -> tuple[Help, ...]:
        if self.fitting is None:
            return ()
        return (Help(f"did you mean `{self.fitting}`?", Replacement(self.location, self.fitting)),)


@dataclass(frozen=True, kw_only=True)
class WrongType(Diagnostic):
    """A value of another type than its place wants.

        on_table[x] = 1          # a feature of type bool

    An int may stand where a float is wanted, never the reverse; a bool is no number; two value
    typedefs do not convert into each other.
    """

    expected: str
    found: Type
    reason: str = ""
    declared: Location | None = None

    def message(self) -> str:
        return f"expected {self.expected}, found `{self.found}`"

    def labels(self) -> tuple[Label, ...]:
        return () if self.declared is None else (Label(self.declared, "declared here"),)

    def notes(self) -> tuple[str, ...]:
        return (self.reason,) if self.reason else ()


@dataclass(frozen=True, kw_only=True)
class NotComparable(Diagnostic):
    """A comparison of values that have nothing to compare.

        x == 1                   # `x` is an object

    Objects compare by `==` and `!=` when one type is a kind of the other; numbers compare with
    numbers, and other values with values of their own type.
    """

    operator: str
    left: Type
    right: Type

    def message(self) -> str:
        return f"`{self.left}` and `{self.right}` do not compare by `{self.operator}`"


@dataclass(frozen=True, kw_only=True)
class NotAnObjectType(Diagnostic):
    """A quantifier, `foreach` or `objects:` line over a value type.

        forall p: Pose: …

    There are finitely many objects and endlessly many values. Quantify over an object type.
    """

    type: Type

    def message(self) -> str:
        return f"`{self.type}` is not an object type"

    def label(self) -> str:
        return "only objects can be counted through"


@dataclass(frozen=True, kw_only=True)
class ValueIndex(Diagnostic):
    """A feature indexed by a value instead of objects.

        feature level(n: int64) -> float32
        level[count(x) + 1]

    Features are tables over the finitely many objects of a problem, and which cell is read or
    written cannot depend on a computed value (data-obliviousness, Appendix D.1). Introduce an
    object type for the index, or write `f(x) if v == 0 else g(x)` for a few values.
    """

    type: Type
    feature: str | None = None
    declared: Location | None = None

    def message(self) -> str:
        if self.feature is None:
            return f"a feature cannot be indexed by `{self.type}`"
        return f"`{self.feature}` is indexed by objects, not by `{self.type}`"

    def label(self) -> str:
        return "not an object"

    def labels(self) -> tuple[Label, ...]:
        return () if self.declared is None else (Label(self.declared, "declared here"),)

    def notes(self) -> tuple[str, ...]:
        return ("which cell is read cannot depend on a computed value: CDL is data-oblivious",)

    def help(self) -> tuple[Help, ...]:
        return (Help("introduce an object type for what it counts: `typedef T: object`"),)


@dataclass(frozen=True, kw_only=True)
class TypeCycle(Diagnostic):
    """A `typedef` that is based on itself.

    typedef a: b
    typedef b: a
    """

    chain: Sequence[str]

    def message(self) -> str:
        return f"type is based on itself: {' → '.join(self.chain)}"


@dataclass(frozen=True, kw_only=True)
class UninferableParameter(Diagnostic):
    """A parameter without a type that its uses do not decide.

        behavior r(x):
          eff: pass

    Give the type: `x: block`.
    """

    name: str
    candidates: Sequence[str]

    def message(self) -> str:
        return f"cannot infer the type of `{self.name}`"

    def label(self) -> str:
        if not self.candidates:
            return "no use says what it is"
        return f"its uses want {' and '.join(f'`{c}`' for c in self.candidates)}"

    def help(self) -> tuple[Help, ...]:
        return (Help(f"give its type: `{self.name}: T`"),)


@dataclass(frozen=True, kw_only=True)
class MissingType(Diagnostic):
    """A parameter or variable whose type has to be given.

        feature on(x, y: block)

    Only parameters of behaviors and generators are inferred from their use.
    """

    name: str

    def message(self) -> str:
        return f"`{self.name}` has no type"

    def help(self) -> tuple[Help, ...]:
        return (Help(f"write `{self.name}: T`"),)


@dataclass(frozen=True, kw_only=True)
class NumberTooLarge(Diagnostic):
    """A literal that its type cannot hold: int64 ends at 2**63 - 1, int32 at 2**31 - 1.

        feature count() -> int32
        init:
          count = 3000000000

    Use a wider type, or a smaller unit.
    """

    bits: int = 64

    def message(self) -> str:
        return f"number does not fit into {self.bits} bits"


# --------------------------------------------------------------------------------------- statements


@dataclass(frozen=True, kw_only=True)
class MisplacedStatement(Diagnostic):
    """A statement in a section that cannot hold it.

        eff:
          achieve clear(x)

    Bodies say what to do (`achieve`, `assert`, `do`, `bind`, …), effects what changes (`f[x] = e`),
    derived functions what the value is (`return e`).
    """

    statement: str
    section: str
    advice: str = ""

    def message(self) -> str:
        return f"{self.statement} cannot stand in {self.section}"

    def help(self) -> tuple[Help, ...]:
        return (Help(self.advice),) if self.advice else ()


@dataclass(frozen=True, kw_only=True)
class MisplacedPromotable(Diagnostic):
    """A second or nested `promotable:`.

    A body is `<L, M, R>`: what stands before the promotable section, the section, what stands after
    it. So there is at most one, at the top level of the body.
    """

    reason: str

    def message(self) -> str:
        return self.reason


@dataclass(frozen=True, kw_only=True)
class NotPromotable(Diagnostic):
    """A statement that cannot be interleaved with others.

        promotable:
          bind y: block where: on(x, y)
          achieve clear(y)

    A promotable section holds `achieve`, `assert`, calls of behaviors, groups, `foreach` and `if`,
    and may end in controller calls. Move other statements before or after it.
    """

    statement: str
    move: str

    def message(self) -> str:
        return f"{self.statement} cannot stand in a promotable section"

    def help(self) -> tuple[Help, ...]:
        return (Help(f"move it {self.move} the section"),)


@dataclass(frozen=True, kw_only=True)
class DuplicateSection(Diagnostic):
    """Two sections of one kind in a definition: `goal:`, `body:` and `eff:` stand at most once."""

    section: str
    first: Location

    def message(self) -> str:
        return f"`{self.section}:` stands twice"

    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, "first here"),)


@dataclass(frozen=True, kw_only=True)
class MisplacedSection(Diagnostic):
    """A section that this kind of definition does not have.

        controller c(x: block):
          goal: holding(x)

    Controllers have `eff:`; behaviors `goal:`, `body:` and `eff:`; generators `goal:`, `in:` and
    `out:`.
    """

    section: str
    owner: str
    allowed: Sequence[str]

    def message(self) -> str:
        return f"a {self.owner} has no section `{self.section}:`"

    def help(self) -> tuple[Help, ...]:
        return (Help(f"it may have {', '.join(f'`{s}:`' for s in self.allowed)}"),)


@dataclass(frozen=True, kw_only=True)
class UnsupportedGoal(Diagnostic):
    """A behavior goal that is not one literal, one value equation or one comparison.

        goal: on(x, y) and clear(x)

    A goal is matched against what is to be achieved: `f(x)`, `not f(x)`, `f(x) == v` or `f(x) < v`,
    with parameters or constants as arguments. Write one behavior for each part, or a `def` that
    names the whole.
    """

    reason: str

    def message(self) -> str:
        return f"not a goal: {self.reason}"

    def help(self) -> tuple[Help, ...]:
        return (Help("a goal is `f(x)`, `not f(x)`, `f(x) == v` or a comparison of a feature"),)


@dataclass(frozen=True, kw_only=True)
class EqualsInGoal(Diagnostic):
    """A goal with `=` where a comparison is meant.

        goal: position(o) = p

    Compare with `==`. Only the goal of a generator may be written with `=`, as in Appendix B.1.
    """

    def message(self) -> str:
        return "`=` does not compare"

    def help(self) -> tuple[Help, ...]:
        return (Help("compare with `==`", Replacement(self.location, "==")),)


@dataclass(frozen=True, kw_only=True)
class CallForIndex(Diagnostic):
    """An assignment to a call instead of to a cell.

        on_table(A) = True

    Reads may be written `f(x)` or `f[x]`; what is assigned is a cell, `f[x]`.
    """

    cell: str

    def message(self) -> str:
        return "cannot assign to a call"

    def help(self) -> tuple[Help, ...]:
        return (Help(f"write `{self.cell}`", Replacement(self.location, self.cell)),)


@dataclass(frozen=True, kw_only=True)
class NotAssignable(Diagnostic):
    """An assignment to something that is no feature and no local variable.

        x = True                 # `x` is a parameter

    Effects assign features, `f[x] = e`; locals come from `let`.
    """

    name: str
    is_a: str

    def message(self) -> str:
        return f"cannot assign to the {self.is_a} `{self.name}`"


@dataclass(frozen=True, kw_only=True)
class RecursiveCall(Diagnostic):
    """A function or behavior that calls itself, directly or through others.

        def f(x: float32) -> float32:
          return g(x)
        def g(x: float32) -> float32:
          return f(x)

    Without recursion every computation has a bounded depth (Appendix D.3). Behaviors recur through
    `achieve`.
    """

    chain: Sequence[str]
    steps: Sequence[tuple[str, str, Location | None]] = ()

    def message(self) -> str:
        return f"recursive call: {' → '.join(self.chain)}"

    def labels(self) -> tuple[Label, ...]:
        return tuple(
            Label(place, f"`{caller}` calls `{called}`")
            for caller, called, place in self.steps
            if place is not None
        )

    def help(self) -> tuple[Help, ...]:
        return (Help("functions cannot recur; behaviors recur through `achieve`"),)


# ---------------------------------------------------------------------------------------- problems


@dataclass(frozen=True, kw_only=True)
class MissingPart(Diagnostic):
    """A problem file without one of its parts: its domain or its goal.

    problem "sussman"
    domain "blocks.cdl"
    objects: …
    init: …
    goal: on(A, B)
    """

    part: str
    example: str

    def message(self) -> str:
        return f"the problem has no {self.part}"

    def help(self) -> tuple[Help, ...]:
        return (Help(f"add `{self.example}`"),)


@dataclass(frozen=True, kw_only=True)
class MisplacedPart(Diagnostic):
    """A part of a problem in a domain file.

        objects:
          A, B: block

    Objects, initial values and the goal belong into a file that starts with `problem "name"` and
    names the domain.
    """

    part: str

    def message(self) -> str:
        return f"`{self.part}` belongs in a problem file"

    def help(self) -> tuple[Help, ...]:
        return (Help('start the file with `problem "name"` and `domain "file.cdl"`'),)


@dataclass(frozen=True, kw_only=True)
class OutOfBounds(Diagnostic):
    """An initial value outside the bounds of its feature.

        feature [[min=0, max=20]] level(x: tank) -> int32
        init:
          level[A] = 21

    Correct the value or the bounds.
    """

    feature: str
    value: int
    low: int | None
    high: int | None
    declared: Location | None

    def message(self) -> str:
        return f"{self.value} is outside the bounds of `{self.feature}`"

    def label(self) -> str:
        low, high = self.low, self.high
        if low is None:
            return f"at most {high}"
        return f"at least {low}" if high is None else f"{low} to {high}"

    def labels(self) -> tuple[Label, ...]:
        return () if self.declared is None else (Label(self.declared, "declared here"),)


@dataclass(frozen=True, kw_only=True)
class WrongFileKind(Diagnostic):
    """A problem where a domain is wanted, or a domain where a problem is.

        cdlc plan sussman.cdl blocks.cdl

    `cdlc plan DOMAIN PROBLEM`: a problem file starts with `problem "name"`.
    """

    is_a: str
    wanted: str

    def message(self) -> str:
        return f"this is a {self.is_a} file; a {self.wanted} file is wanted"


# ------------------------------------------------------------------------------- data-obliviousness


@dataclass(frozen=True, kw_only=True)
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


@dataclass(frozen=True, kw_only=True)
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


@dataclass(frozen=True, kw_only=True)
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


@dataclass(frozen=True, kw_only=True)
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


@dataclass(frozen=True, kw_only=True)
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


@dataclass(frozen=True, kw_only=True)
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


@dataclass(frozen=True, kw_only=True)
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


@dataclass(frozen=True, kw_only=True)
class ReturnInForeach(Diagnostic):
    """A `return` in a `foreach`, whose iterations are parallel: which of them would return?

    Use `forall`, `exists`, or a quantity computed without a loop.
    """

    def message(self) -> str:
        return "`return` inside `foreach`"

    def help(self) -> tuple[Help, ...]:
        return (Help("a property of all objects is `forall o: T: …`, of one `exists o: T: …`"),)


@dataclass(frozen=True, kw_only=True)
class MissingSection(Diagnostic):
    """A generator without a section it needs.

        generator sample(o: Object, g: Grasp):
          in: o
          out: g

    `goal:` says which constraint it finds values for, and `out:` which values it yields.
    """

    section: str

    def message(self) -> str:
        return f"there is no `{self.section}:`"


@dataclass(frozen=True, kw_only=True)
class BadDirection(Diagnostic):
    """A parameter of a generator that is neither input nor output, or both.

        generator invert_f(x, y, z):
          goal: f(x, y) == z
          in: z
          out: x

    List every parameter once, after `in:` if its value is given or after `out:` if it is found.
    """

    name: str
    is_both: bool

    def message(self) -> str:
        if self.is_both:
            return f"`{self.name}` is both an input and an output"
        return f"`{self.name}` is neither an input nor an output"

    def help(self) -> tuple[Help, ...]:
        return (Help("list it once, after `in:` if it is given or after `out:` if it is found"),)
