"""Messages about names and annotations."""

from collections.abc import Sequence
from dataclasses import dataclass

from cdlc.diagnostics import Diagnostic, Help, Label, Lint, Replacement, suggest
from crow.program import Location

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


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
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


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class UnknownFeature(UnknownName):
    """A read, write or call of a feature or function that is not defined.

        achieve claer(x)

    Correct the spelling, or declare it: `feature clear(x: block)`.
    """

    what: str = "feature or function"
    is_bare: bool = False
    """Whether it is assigned to like a variable, without brackets."""

    def help(self) -> tuple[Help, ...]:
        found = UnknownName.help(self)
        if found or not self.is_bare:
            return found
        return (Help(f"a new variable is introduced by `let`: `let {self.name} = …`"),)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class UnknownType(UnknownName):
    """A type that is neither built in nor defined by a `typedef`.

        feature on(x: blok)

    Correct the spelling, or declare it: `typedef block: object`.
    """

    what: str = "type"


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class UnknownCommand(UnknownName):
    """A call of a controller or behavior that is not defined.

        do pick_up(x)

    Correct the spelling, or declare it: `controller pick_up(x: block)`.
    """

    what: str = "controller or behavior"


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class DuplicateDefinition(Diagnostic):
    """Two definitions, objects or constants with one name.

        feature clear(x: block)
        controller clear(x: block)

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


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
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


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
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


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
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


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
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


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
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


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class UnknownPragma(Lint):
    """A `#!pragma` line; none is known, and the line is read as a comment.

        #!pragma search=depth

    Remove the line: planners take their settings as options.
    """

    def message(self) -> str:
        return "unknown pragma"
