"""What is left to do, as immutable data that is shared: equal remainders are one object.

So a configuration of the search, state, context and remainder, is compared and hashed by identity.
"""

from dataclasses import dataclass, replace
from enum import IntEnum, auto
from typing import Any, TypeVar

from crow.search.code import CallOp, Code, Test, Wanted
from crow.search.expressions import Environment
from crow.values import Value

Held = tuple[tuple[Test, Environment], ...]
"""Conditions that must still hold at the next `do`."""


@dataclass(slots=True, eq=False)
class Application:
    """A behavior applied to arguments in a program of some depth; None is the initial program.

    `nested` counts the applications among its ancestors, for behaviors that limit them.
    """

    code: Code | None
    arguments: tuple[Value, ...]
    depth: int
    nested: tuple[tuple[str, int], ...]


@dataclass(slots=True, eq=False)
class Context:
    """Where an application's body stands: its variables, and what is held."""

    application: Application
    values: Environment
    held: Held


# -------------------------------------------------------------------------- members of M, as a tree


@dataclass(slots=True, eq=False)
class Open:
    """A member that is not refined yet.

    `what` is an assertion, a condition, a call, or a behavior with its arguments; `after` is
    asserted behind a behavior; `may_be_null` is False where its null refinement was tried.
    """

    what: "Test | Wanted | CallOp | tuple[Code, tuple[Value, ...]]"
    values: Environment
    application: Application
    depth: int
    after: Test | None = None
    may_be_null: bool = True


@dataclass(slots=True, eq=False)
class Nested:
    """An unordered group within a chain."""

    members: "Members"


@dataclass(slots=True, eq=False)
class Refined:
    """A member that was refined: its promotable children, then its R, then assertions.

    `context` is None for a compound condition, which has no R but assertions.
    """

    context: Context | None
    children: "Members"
    after: Held


Member = Open | Nested | Refined
Members = tuple[tuple[Member, ...], ...]
"""Chains, unordered among each other; a member completes after those before it in its chain."""


# ----------------------------------------------------------------------------------- continuations


class Kind(IntEnum):
    """What a frame does."""

    BLOCK = auto()
    """The instructions of a block from an index on."""
    RESTORE = auto()
    """The context of the caller."""
    START = auto()
    """The M of a behavior starts here."""
    MIDDLE = auto()
    """Members of M, chosen forward: start state, members, and the path of what is chosen next."""
    LEFT_DONE = auto()
    """The L of a member of M has run in the start state: state to go on in, and its place."""
    TAIL = auto()
    """Members of M, chosen from the end, and the chain of what follows them."""
    TAIL_LEFT_DONE = auto()
    """The L of a last member of M has run."""
    PENDING = auto()
    """What follows the members of M that were chosen from the end."""
    BEGIN = auto()
    """R begins."""
    END = auto()
    """R ends with the effect."""
    CHECK = auto()
    """An assertion that stands in no block."""
    ACHIEVE = auto()
    """A condition to try again."""
    APPLY = auto()
    """A behavior on the way to a condition."""
    UNORDERED = auto()
    """An unordered group of L or R."""
    PART_DONE = auto()
    """One statement of an unordered group has run."""
    SECTION = auto()
    """An L or R with a `commit` begins."""
    SECTION_END = auto()
    """And ends."""
    SETTLE = auto()
    """Values that were found are put in, and those that can be drawn are."""


@dataclass(slots=True, eq=False)
class Frame:
    """One thing to do, and what to do after it."""

    kind: Kind
    first: Any
    second: Any
    third: Any
    next: "Frame | None"


_T = TypeVar("_T", Open, Nested, Refined)


class Shared:
    """Makes equal data one object."""

    def __init__(self) -> None:
        self._known: dict[Any, Any] = {}

    def application(
        self,
        code: Code | None,
        arguments: tuple[Value, ...],
        depth: int,
        nested: tuple[tuple[str, int], ...],
    ) -> Application:
        """An application."""
        key = (Application, code, arguments, depth, nested)
        found = self._known.get(key)
        if found is None:
            found = self._known[key] = Application(code, arguments, depth, nested)
        return found

    def context(self, application: Application, values: Environment, held: Held) -> Context:
        """A context."""
        key = (Context, application, values, held)
        found = self._known.get(key)
        if found is None:
            found = self._known[key] = Context(application, values, held)
        return found

    def frame(
        self, kind: Kind, following: Frame | None, first: Any = None, second: Any = None,
        third: Any = None,
    ) -> Frame:  # fmt: skip
        """A frame."""
        key = (kind, first, second, third, following)
        found = self._known.get(key)
        if found is None:
            found = self._known[key] = Frame(kind, first, second, third, following)
        return found

    def open(
        self, what: Any, values: Environment, application: Application, depth: int,
        after: Test | None = None,
    ) -> Open:  # fmt: skip
        """A member that is not refined yet."""
        return self._member(Open(what, values, application, depth, after))

    def tried(self, member: Open) -> Open:
        """A member that may not be null any more."""
        return self._member(replace(member, may_be_null=False))

    def nested(self, members: Members) -> Nested:
        """A group within a chain."""
        return self._member(Nested(members))

    def refined(self, context: Context | None, children: Members, after: Held) -> Refined:
        """A refined member."""
        return self._member(Refined(context, children, after))

    def _member(self, member: _T) -> _T:
        key = (type(member), *(getattr(member, name) for name in member.__slots__))
        found: _T = self._known.setdefault(key, member)
        return found
