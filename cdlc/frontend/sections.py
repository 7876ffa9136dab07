"""Where statements stand, which decides what is allowed there (language.md §3)."""

from dataclasses import dataclass
from typing import Literal

from cdlc.frontend import errors, syntax
from cdlc.frontend.scope import Context
from crow.program import UNKNOWN, Type

SectionKind = Literal["body", "effect", "function", "init"]

SECTION_NAMES: dict[SectionKind, str] = {
    "body": "a body",
    "effect": "an effect",
    "function": "a derived function",
    "init": "the initial state",
}


@dataclass(frozen=True, slots=True)
class Section:
    """Where statements stand: the kind of section, and in a function the type to return."""

    kind: SectionKind
    returns: Type = UNKNOWN


_EVERYWHERE: tuple[SectionKind, ...] = ("body", "effect", "function", "init")
_DOING = "effects and functions only compute; move it into `body:`"
CHANGING = "only effects change features; move it into `eff:`"


def misplaced(node: syntax.Statement, section: Section) -> tuple[str, str] | None:
    """The statement in words and a cure, when it cannot stand in this kind of section."""
    what, allowed, advice = _placement(node)
    return None if section.kind in allowed else (what, advice)


def _placement(node: syntax.Statement) -> tuple[str, tuple[SectionKind, ...], str]:
    match node:
        case syntax.Assert():
            return "`assert`", ("body",), _DOING
        case syntax.Achieve(once=once):
            return ("`achieve_once`" if once else "`achieve`"), ("body",), _DOING
        case syntax.CallStatement():
            return "a call", ("body",), _DOING
        case syntax.Bind():
            return "`bind`", ("body",), _DOING
        case syntax.Group(order=order):
            return f"`{order}:`", ("body",), _DOING
        case syntax.Promotable():
            return "`promotable:`", ("body",), _DOING
        case syntax.Word(word="commit"):
            return "`commit`", ("body",), _DOING
        case syntax.Word(word="break" | "continue" as word):
            advice = "in a body, `for` repeats its block a fixed number of times; use `if`"
            return f"`{word}`", ("effect", "function"), advice
        case syntax.Return():
            return "`return`", ("function",), "only a `def` returns a value"
        case syntax.Assignment(target=syntax.Call()):
            return "an assignment to a feature", ("effect", "init"), CHANGING
        case _:
            return "", _EVERYWHERE, ""


def report_misplaced(
    node: syntax.Statement, what: str, section: Section, advice: str, context: Context
) -> None:
    """Report a statement that cannot stand in its section."""
    context.found.add(
        errors.MisplacedStatement(
            location=context.location(node.span),
            statement=what,
            section=SECTION_NAMES[section.kind],
            advice=advice,
        )
    )
