"""Every message of the backends. The docstring of a kind is its page."""

from dataclasses import dataclass

from cdlc.diagnostics import Diagnostic, Help, Label, Lint
from crow.program import Location, Type


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class NoInitialValue(Diagnostic):
    """An `init` that cannot be computed: an unset value is read, or a number does not fit.

        init:
          size[A] = size[B] / count

    Numbers are 0 and truth values False until they are set; all other values have to be set first.
    """

    reason: str

    def message(self) -> str:
        return f"the initial state cannot be computed: {self.reason}"


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class NotInPddl(Diagnostic):
    """Something that PDDL has no form for.

        eff:
          level[x] = level(x) % 3

    PDDL has Boolean, object-valued and numeric features, conditions and effects over them, and
    `+ - * /`. Everything else stays with the runtime, which plans with the CDL program itself.
    """

    construct: str
    cure: str | None = None

    def message(self) -> str:
        return f"{self.construct} has no PDDL"

    def notes(self) -> tuple[str, ...]:
        return () if self.cure is not None else ("the runtime plans with the CDL program itself",)

    def help(self) -> tuple[Help, ...]:
        return () if self.cure is None else (Help(self.cure),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class NotInFormat(Diagnostic):
    """Something that PDDL or the runtime has, and the format asked for has not.

        feature level(j: jug) -> int64        # --emit hddl

    HDDL has no numbers, and its tasks take objects only. unified-planning's problems have no
    derived predicates. `--emit pddl` has both, and the runtime plans with the CDL program itself.
    """

    construct: str
    format: str
    cure: str

    def message(self) -> str:
        return f"{self.construct} has no {self.format}"

    def help(self) -> tuple[Help, ...]:
        return (Help(self.cure),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class NeedsProblem(Diagnostic):
    """A domain alone, where a whole task is asked for.

        cdlc compile blocks.cdl --emit up

    A problem of unified-planning has objects, an initial state and a goal. Give the problem file,
    with or without that of its domain: `cdlc compile sussman.cdl --emit up`.
    """

    format: str

    def message(self) -> str:
        return f"`--emit {self.format}` needs a problem, and this is a domain"

    def help(self) -> tuple[Help, ...]:
        return (Help(f"name the problem, too: cdlc compile DOMAIN PROBLEM --emit {self.format}"),)


# A message is no index: past this many uses the rest is counted.
_MOST_USES = 8


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class NotDiscrete(Diagnostic):
    """A feature whose values PDDL does not have: vectors, strings, Python objects.

        feature position(x: Object) -> Pose

    PDDL has truth values, objects and numbers. The runtime plans with all values; for a PDDL
    planner, use a feature over finitely many objects instead.
    """

    feature: str
    type: Type
    uses: tuple[Location, ...]

    def message(self) -> str:
        return f"feature `{self.feature}` of type `{self.type}` is not discrete: PDDL cannot say it"

    def labels(self) -> tuple[Label, ...]:
        return tuple(Label(place, "used here") for place in self.uses[:_MOST_USES])

    def notes(self) -> tuple[str, ...]:
        more = len(self.uses) - _MOST_USES
        return (f"and {more} more uses",) if more > 0 else ()

    def help(self) -> tuple[Help, ...]:
        return (Help("plan with the runtime, which takes values of every type"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class SplitBehavior(Lint):
    """A behavior that achieves something after it has acted, or uses a local that this may change.

        body:
          do unlock(d)
          achieve at(room)         # other behaviors act here
          do open_door(d)
        eff:
          open[d] = True

    It is no single step, so PDDL gets one action a phase, with a predicate that says which phase is
    to come; the goal demands that none is open. A planner may do anything between two phases, where
    the program does what the `achieve` asks for.
    """

    behavior: str
    again: tuple[Location, ...]

    def message(self) -> str:
        return f"`{self.behavior}` is split for PDDL, one action a phase"

    def labels(self) -> tuple[Label, ...]:
        return tuple(Label(place, "a phase begins here") for place in self.again)

    def help(self) -> tuple[Help, ...]:
        return (Help("achieve everything before the first `do`, and it is one action"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class UnsetInPddl(Diagnostic):
    """A feature with objects as values that the initial state leaves without one.

        objects:
          cup: Item
        init:
          pass                 # loc[cup] = table

    In PDDL an object-valued feature is a predicate that holds for exactly one value, so there has
    to be one from the start.
    """

    feature: str
    cells: tuple[str, ...]
    problem: str

    def message(self) -> str:
        more = len(self.cells) - 1
        others = f" nor have {more} more cells" if more else ""
        return f"`{self.cells[0]}` has no initial value{others}, which PDDL needs"

    def label(self) -> str:
        return f"unset in the problem `{self.problem}`"

    def help(self) -> tuple[Help, ...]:
        return (Help(f"set `{self.cells[0].replace('(', '[').replace(')', ']')}` in `init:`"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class FunctionFailed(Diagnostic):
    """Python, given with `--functions`, that raised, or gave what is no value of its type.

        def near(a: place, b: place) -> bool      # def near(a, b): return distance[a, b] < 3

    It gets objects as their names, vectors as tuples and numbers as they are, and has to return a
    value of the type that is declared: of `bool` True or False, of a vector a tuple, list or numpy
    array of its length, of a number one that is finite. What it raises is shown as Python shows it.
    """

    call: str
    reason: str
    traceback: str = ""

    def message(self) -> str:
        return f"`{self.call}` {self.reason}"

    def label(self) -> str:
        return "its Python failed"

    def notes(self) -> tuple[str, ...]:
        return (self.traceback.rstrip(),) if self.traceback else ()


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class WrongFunction(Diagnostic):
    """Python, given with `--functions`, that does not fit the program.

        def near(a: place, b: place) -> bool      # def near(a): ...

    Functions are called by their names with as many values as the program declares, after the state
    where `[[reads=…]]` says that it is read. What is decorated (`@crow.function`,
    `@crow.generator`, `@crow.effect`, `@crow.controller`) has to be declared in the program.
    """

    wrong: str
    cure: str | None

    def message(self) -> str:
        return self.wrong

    def label(self) -> str:
        return "declared here"

    def help(self) -> tuple[Help, ...]:
        return () if self.cure is None else (Help(self.cure),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class NotPlannable(Diagnostic):
    """A value to choose, planned with an engine that chooses among objects alone.

        bind p: Pose where: on_table(p)

    Such a `bind`, and a value parameter that the goal does not mention, are for the engines `auto`,
    `iddfs` and `iw`. They draw values from generators, and solve equations for them.
    """

    construct: str
    engine: str

    def message(self) -> str:
        return f"the engine `{self.engine}` does not cover {self.construct}"

    def help(self) -> tuple[Help, ...]:
        return (Help("plan with `auto`, `iddfs` or `iw`, which draw values"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class MissingFunction(Diagnostic):
    """A call of an external function whose Python was not given.

        def near(a: place, b: place) -> bool      # a `def` without a body

    Planning evaluates it, so its Python has to be there: `--functions FILE.py` on the command line,
    `functions=` in the library. A function of the same name in that file, or one with
    `@crow.function("near")`, is called with as many values as the program declares.
    """

    function: str

    def message(self) -> str:
        return f"the external function `{self.function}` has no Python, which planning needs"

    def help(self) -> tuple[Help, ...]:
        return (Help("give it with `--functions FILE.py`, or write its body in CDL"),)
