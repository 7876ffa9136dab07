"""Messages about statements and sections."""

from collections.abc import Sequence
from dataclasses import dataclass

from cdlc.diagnostics import Diagnostic, Help, Label, Replacement
from crow.program import Location


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
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


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class MisplacedPromotable(Diagnostic):
    """A second or nested `promotable:`.

        body:
          promotable:
            achieve clear(x)
          promotable:
            achieve clear(y)

    A body is `<L, M, R>`: what stands before the promotable section, the section, what stands after
    it. So there is at most one, at the top level of the body.
    """

    reason: str

    def message(self) -> str:
        return self.reason


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
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


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class DuplicateSection(Diagnostic):
    """Two sections of one kind in a definition.

        behavior r(x: block, y: block):
          goal: clear(x)
          goal: clear(y)

    `goal:`, `body:` and `eff:` stand at most once. Write two behaviors, or put the parts together.
    """

    section: str
    first: Location

    def message(self) -> str:
        return f"`{self.section}:` stands twice"

    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, "first here"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
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


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
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


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class EqualsInGoal(Diagnostic):
    """A goal with `=` where a comparison is meant.

        goal: position(o) = p

    Compare with `==`. Only the goal of a generator may be written with `=`, as in Appendix B.1.
    """

    def message(self) -> str:
        return "`=` does not compare"

    def help(self) -> tuple[Help, ...]:
        return (Help("compare with `==`", Replacement(self.location, "==")),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
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


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class NotAssignable(Diagnostic):
    """An assignment to something that is no feature and no local variable.

        x = True                 # `x` is a parameter

    Effects assign features, `f[x] = e`; locals come from `let`.
    """

    name: str
    is_a: str

    def message(self) -> str:
        return f"cannot assign to the {self.is_a} `{self.name}`"


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
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


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
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


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
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
