"""PDDL domains and problems read into nodes."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from cdlc.diagnostics import Collector
from cdlc.frontend.pddl.context import Context, PddlError, words_of
from cdlc.frontend.pddl.formulas import atom, effects, formula, literal, number
from cdlc.frontend.pddl.nodes import (
    TRUE,
    Action,
    Atom,
    Derived,
    Domain,
    Effect,
    Formula,
    Number,
    Problem,
    Schema,
    Typed,
)
from cdlc.frontend.pddl.words import Item, Word, Words, read_words
from cdlc.source import SourceFile, Span

_TIME = "CDL plans have no time of their own"
_UNSUPPORTED = {
    ":durative-action": ("a durative action", _TIME),
    ":process": ("a process", _TIME),
    ":event": ("an event", _TIME),
    ":constraints": ("a constraint on the trajectory", "CDL has goals at the end of a plan"),
    ":method": ("an HTN method", "write it as a behavior"),
    ":task": ("an HTN task", "write it as the goal of a behavior"),
}


def read_domain(source: SourceFile, found: Collector) -> tuple[Domain, Context] | None:
    """A domain, and the scope that its problems are read in.

    None, with diagnostics in `found`, where a part of it cannot be read.
    """
    top = read_words(source, found)
    if top is None:
        return None
    before = found.errors
    reader = _Reader(Context(source, found))
    domain = reader.domain(top)
    return None if domain is None or found.errors > before else (domain, reader.context)


def read_problem(source: SourceFile, domain: Context, found: Collector) -> Problem | None:
    """A problem of a domain; None, with diagnostics in `found`, where it cannot be read."""
    top = read_words(source, found)
    if top is None:
        return None
    before = found.errors
    context = replace(domain, source=source, found=found, objects=dict(domain.objects))
    problem = _Reader(context).problem(top)
    return None if problem is None or found.errors > before else problem


class _Reader:
    def __init__(self, context: Context) -> None:
        self.context = context
        self.actions: list[Action] = []
        self.derived: list[Derived] = []
        self.constants: list[Typed] = []

    # ------------------------------------------------------------------------------------ domain

    def domain(self, top: Words) -> Domain | None:
        name = self._title(top, "domain")
        sections = list(self._sections(top))
        # What is declared may stand after what uses it.
        for kinds in ((":types",), (":constants", ":predicates", ":functions"), ()):
            for section in sections:
                known = section.head in (":types", ":constants", ":predicates", ":functions")
                if section.head in kinds or (not kinds and not known):
                    self._attempt(section)
        if name is None:
            return None
        context = self.context
        return Domain(
            name,
            context.types,
            tuple(self.constants),
            tuple(context.predicates.values()),
            tuple(context.functions.values()),
            tuple(self.actions),
            tuple(self.derived),
        )

    def _title(self, top: Words, kind: str) -> str | None:
        match top.items[1:2]:
            case (Words(items=(Word(text=word), Word(text=name))),) if word == kind:
                return name
            case _:
                problem = f"expected `(define ({kind} …) …)`"
                self.context.syntax(top.items[1] if len(top.items) > 1 else top, problem)
                return None

    def _sections(self, top: Words) -> Iterator[Words]:
        for item in top.items[2:]:
            if isinstance(item, Words) and item.head.startswith(":"):
                yield item
            else:
                self.context.syntax(item, "expected a section such as `(:action …)`")

    def _attempt(self, section: Words) -> None:
        """Read a section; a mistake in it is reported, and the others are still read."""
        try:
            self._section(section)
        except PddlError:
            return

    def _section(self, section: Words) -> None:
        context, rest = self.context, section.items[1:]
        match section.head:
            case ":requirements":
                return
            case ":types":
                self._types(rest)
            case ":constants":
                self.constants = list(context.typed_list(rest))
                context.objects.update({c.name: c.type for c in self.constants})
            case ":predicates":
                for schema in self._schemas(rest):
                    context.predicates[schema.name] = schema
            case ":functions":
                self._functions(rest)
            case ":action":
                self._action(section)
            case ":derived":
                self._derived(section)
            case head if head in _UNSUPPORTED:
                raise context.unsupported(section.span, *_UNSUPPORTED[head])
            case head:
                raise context.syntax(section, f"unknown section `{head}`")

    def _types(self, items: Sequence[Item]) -> None:
        """Parents by type; a parent that is not listed is a type under `object`."""
        names = (item.text for item in items if isinstance(item, Word))
        own = (name for name in names if name not in ("-", "object"))
        self.context.types.update(dict.fromkeys(own, "object"))
        for declared in self.context.typed_list(items):
            if declared.name != "object":
                self.context.types[declared.name] = declared.type

    def _schemas(self, items: Sequence[Item]) -> Iterator[Schema]:
        for item in items:
            words = words_of(item, self.context, "a name with parameters")
            if not words.head:
                raise self.context.syntax(item, "expected a name with parameters")
            parameters = self.context.typed_list(words.items[1:], widens=True)
            yield Schema(words.head, tuple(parameters))

    def _functions(self, items: Sequence[Item]) -> None:
        pending: list[Words] = []
        position = 0
        while position < len(items):
            item = items[position]
            if isinstance(item, Words):
                pending.append(item)
                position += 1
                continue
            if position + 1 == len(items) or item.text != "-":
                raise self.context.syntax(item, "expected `- number`")
            type_ = items[position + 1]
            if not isinstance(type_, Word) or type_.text != "number":
                reason = "declare a predicate with one parameter more"
                raise self.context.unsupported(type_.span, "an object fluent", reason)
            position += 2
        for schema in self._schemas(pending):
            self.context.functions[schema.name] = schema

    def _fields(self, section: Words, start: int) -> dict[str, Item]:
        """`:key value` pairs of an action."""
        fields: dict[str, Item] = {}
        items = section.items[start:]
        for key, value in zip(items[::2], items[1::2], strict=False):
            if not isinstance(key, Word) or not key.text.startswith(":"):
                raise self.context.syntax(key, "expected `:parameters` or the like")
            fields[key.text] = value
        if len(items) % 2:
            raise self.context.syntax(items[-1], "nothing follows this")
        return fields

    def _action(self, section: Words) -> None:
        context = self.context
        if len(section.items) < 2 or not isinstance(section.items[1], Word):
            raise context.syntax(section, "expected the name of the action")
        name = section.items[1].text
        fields = self._fields(section, 2)
        unknown = fields.keys() - {":parameters", ":precondition", ":effect"}
        if unknown:
            raise context.syntax(section.items[1], f"unknown part `{min(unknown)}` of an action")
        given = fields.get(":parameters")
        declared = () if given is None else words_of(given, context, "parameters").items
        fresh = replace(context, used=set())
        inner, parameters = fresh.with_variables(tuple(fresh.typed_list(declared)))
        precondition: Formula = TRUE
        if ":precondition" in fields:
            precondition = formula(fields[":precondition"], inner)
        changed: tuple[Effect, ...] = ()
        if ":effect" in fields:
            changed = tuple(effects(fields[":effect"], inner))
        span = section.items[1].span
        self.actions.append(Action(name, parameters, precondition, changed, span))

    def _derived(self, section: Words) -> None:
        context = self.context
        if len(section.items) != 3:
            raise context.syntax(section, "expected `(:derived (p ?x) φ)`")
        head = words_of(section.items[1], context, "a predicate with parameters")
        schema = context.predicates.get(head.head)
        if schema is None:
            raise context.unknown(section, "predicate", head.head, list(context.predicates))
        fresh = replace(context, used=set())
        declared = tuple(fresh.typed_list(head.items[1:]))
        if len(declared) != len(schema.parameters):
            raise context.miscounted(head, schema, len(declared))
        pairs = zip(declared, schema.parameters, strict=True)
        # Types may be given with the declaration alone.
        typed = [replace(d, type=s.type) if d.type == "object" else d for d, s in pairs]
        inner, parameters = fresh.with_variables(typed)
        body = formula(section.items[2], inner)
        self.derived.append(Derived(schema.name, parameters, body, head.span))

    # ----------------------------------------------------------------------------------- problem

    def problem(self, top: Words) -> Problem | None:
        name = self._title(top, "problem")
        sections = {section.head: section for section in self._sections(top)}
        try:
            return None if name is None else self._problem(name, sections, top.span)
        except PddlError:
            return None

    def _problem(self, name: str, sections: dict[str, Words], span: Span) -> Problem:
        context = self.context
        for head, section in sections.items():
            if head in _UNSUPPORTED:
                raise context.unsupported(section.span, *_UNSUPPORTED[head])
        objects: tuple[Typed, ...] = ()
        if ":objects" in sections:
            objects = tuple(context.typed_list(sections[":objects"].items[1:]))
            objects = tuple(o for o in objects if o.name not in context.objects)
            context.objects.update({o.name: o.type for o in objects})
        facts, numbers = self._init(sections.get(":init"))
        if ":goal" not in sections or len(sections[":goal"].items) != 2:
            raise context.syntax(Words((), Span(span.start, span.start + 1)), "there is no `:goal`")
        goal = formula(sections[":goal"].items[1], replace(context, used=set()))
        minimize = self._metric(sections.get(":metric"))
        return Problem(name, objects, facts, numbers, goal, minimize)

    def _init(
        self, section: Words | None
    ) -> tuple[tuple[Atom, ...], tuple[tuple[Atom, int | float], ...]]:
        facts: list[Atom] = []
        numbers: list[tuple[Atom, int | float]] = []
        for item in () if section is None else section.items[1:]:
            words = words_of(item, self.context, "a fact in parentheses")
            match words.head:
                case "=":
                    numbers.append(self._initial_number(words))
                case "not":
                    continue
                case "at" if len(words.items) == 3 and literal(words.items[1]) is not None:
                    reason = "CDL has no time"
                    raise self.context.unsupported(words.span, "a timed literal", reason)
                case _:
                    facts.append(atom(words, self.context))
        return tuple(facts), tuple((cell, value) for cell, value in numbers if value != 0)

    def _initial_number(self, words: Words) -> tuple[Atom, int | float]:
        if len(words.items) == 3:
            cell = number(words.items[1], self.context)
            value = literal(words.items[2])
            if isinstance(cell, Atom) and value is not None:
                return cell, value
        raise self.context.syntax(words, "expected `(= (f …) n)` with a number n")

    def _metric(self, section: Words | None) -> Number | None:
        if section is None:
            return None
        context = self.context
        match section.items[1:]:
            case (Word(text="minimize"), expression):
                return number(expression, context)
            case (Word(text="maximize"), _):
                reason = "CDL minimizes costs; negate the metric"
                raise context.unsupported(section.span, "`maximize`", reason)
            case _:
                raise context.syntax(section, "expected `(:metric minimize …)`")
