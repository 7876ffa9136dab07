"""What is declared while PDDL is read, and how its mistakes are reported."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from cdlc.diagnostics import Collector
from cdlc.frontend import errors
from cdlc.frontend.pddl.nodes import Schema, Typed, ancestors
from cdlc.frontend.pddl.words import Item, Word, Words
from cdlc.source import SourceFile, Span


class PddlError(Exception):
    """A part cannot be read; it has been reported."""


@dataclass(frozen=True, slots=True)
class Context:
    """The names in scope: `variables` are those of an action with the names used for them."""

    source: SourceFile
    found: Collector
    types: dict[str, str] = field(default_factory=dict)
    predicates: dict[str, Schema] = field(default_factory=dict)
    functions: dict[str, Schema] = field(default_factory=dict)
    objects: dict[str, str] = field(default_factory=dict)
    variables: Mapping[str, Typed] = field(default_factory=dict)
    used: set[str] = field(default_factory=set)

    # ------------------------------------------------------------------------------- diagnostics

    def syntax(self, item: Item, problem: str) -> PddlError:
        """Report a malformed part."""
        location = self.source.location(item.span)
        self.found.add(errors.PddlSyntax(location=location, problem=problem))
        return PddlError()

    def unknown(self, item: Item, kind: str, name: str, known: Sequence[str]) -> PddlError:
        """Report a name that is not declared."""
        location = self.source.location(item.span)
        self.found.add(errors.PddlName(location=location, kind=kind, name=name, known=known))
        return PddlError()

    def miscounted(self, item: Item, schema: Schema, count: int) -> PddlError:
        """Report a wrong number of arguments."""
        reason = f"takes {len(schema.parameters)} arguments, not {count}"
        location = self.source.location(item.span)
        found = errors.PddlName(location=location, kind="name", name=schema.name, reason=reason)
        self.found.add(found)
        return PddlError()

    def unsupported(self, span: Span, construct: str, reason: str) -> PddlError:
        """Report something that CDL has no form for."""
        location = self.source.location(span)
        diagnostic = errors.PddlUnsupported(location=location, construct=construct, reason=reason)
        self.found.add(diagnostic)
        return PddlError()

    # ------------------------------------------------------------------------------------- names

    def with_variables(self, declared: Sequence[Typed]) -> "tuple[Context, tuple[Typed, ...]]":
        """The scope inside a quantifier or action, and its variables under names of their own."""
        fresh = []
        for variable in declared:
            name, number = variable.name, 1
            while name in self.used:
                number += 1
                name = f"{variable.name}{number}"
            self.used.add(name)
            fresh.append(replace(variable, name=name))
        names = {d.name: f for d, f in zip(declared, fresh, strict=True)}
        return replace(self, variables={**self.variables, **names}), tuple(fresh)

    def term(self, item: Item) -> str:
        """A variable in scope, under its own name, or an object."""
        if not isinstance(item, Word):
            reason = "the value of an object fluent has no place among the arguments of CDL"
            raise self.unsupported(item.span, f"`({item.head} …)` as an argument", reason)
        if item.text.startswith("?"):
            if item.text not in self.variables:
                raise self.unknown(item, "variable", item.text, list(self.variables))
            return self.variables[item.text].name
        if item.text not in self.objects:
            raise self.unknown(item, "object", item.text, list(self.objects))
        return item.text

    def typed_list(
        self, items: Sequence[Item], *, default: str = "object", widens: bool = False
    ) -> Iterator[Typed]:
        """`a b - t c` as names with types.

        `(either t u)` is refused, or with `widens` is the nearest type above all of them.
        """
        pending: list[Word] = []
        position = 0
        while position < len(items):
            item = items[position]
            if not isinstance(item, Word):
                raise self.syntax(item, "expected a name")
            if item.text != "-":
                pending.append(item)
                position += 1
                continue
            if position + 1 == len(items):
                raise self.syntax(item, "expected a type after `-`")
            type_ = self._type(items[position + 1], widens=widens)
            yield from (Typed(word.text, type_) for word in pending)
            pending.clear()
            position += 2
        yield from (Typed(word.text, default) for word in pending)

    def _type(self, item: Item, *, widens: bool) -> str:
        if isinstance(item, Words):
            if item.head == "either" and widens:
                lines = [ancestors(self._type(i, widens=False), self.types) for i in item.items[1:]]
                return next(t for t in lines[0] if all(t in line for line in lines))
            if item.head == "either":
                reason = "a CDL type has one parent: declare a common one in PDDL"
                raise self.unsupported(item.span, "a type `either`", reason)
            raise self.syntax(item, "expected a type")
        if item.text not in self.types and item.text not in ("object", "number"):
            raise self.unknown(item, "type", item.text, [*self.types, "object"])
        return item.text


def words_of(item: Item, context: Context, what: str) -> Words:
    """An item that has to be a list."""
    if isinstance(item, Words):
        return item
    raise context.syntax(item, f"expected {what}")
