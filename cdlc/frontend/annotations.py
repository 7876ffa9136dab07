"""Annotations: kept in the program; unknown ones are a warning (language.md §2)."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

from cdlc.diagnostics import nearest
from cdlc.frontend import errors, syntax
from cdlc.frontend.scope import Context
from crow.program import Annotation, Scalar, Type, UnknownType
from crow.program.types import is_integer

Owner = Literal[
    "object type",
    "value type",
    "object constant",
    "feature",
    "external function",
    "derived function",
    "controller",
    "behavior",
    "generator",
    "statement",
]
Value = Scalar | tuple[str, ...] | None


@dataclass(frozen=True, slots=True)
class Rule:
    """Where an annotation may stand, and what is wrong with its value, if anything."""

    owners: frozenset[Owner]
    fault: Callable[[Value], str | None]
    example: str


def _whole(value: Value) -> str | None:
    is_whole = isinstance(value, int) and not isinstance(value, bool)
    return None if is_whole else "its value is a whole number"


def _positive(value: Value) -> str | None:
    wrong = _whole(value) is not None or not isinstance(value, int) or value < 1
    return "its value is a whole number from 1 on" if wrong else None


def _distance(value: Value) -> str | None:
    wrong = isinstance(value, bool) or not isinstance(value, int | float) or value < 0
    return "its value is a number from 0 on" if wrong else None


def _text(value: Value) -> str | None:
    return None if isinstance(value, str) else "its value is a string"


def _names(value: Value) -> str | None:
    return None if isinstance(value, tuple) else "its value is the names of features, or `all`"


_NAMED: frozenset[Owner] = frozenset(
    ("object type", "value type", "object constant", "feature", "external function",
     "derived function", "controller", "behavior")
)  # fmt: skip
RULES: Mapping[str, Rule] = {
    "min": Rule(frozenset(("feature",)), _whole, "feature [[min=0, max=20]] f() -> int32"),
    "max": Rule(frozenset(("feature",)), _whole, "feature [[min=0, max=20]] f() -> int32"),
    "reads": Rule(
        frozenset(("external function", "generator")),
        _names,
        "def [[reads=position]] f(x: T) -> bool",
    ),
    "max_nested": Rule(frozenset(("behavior",)), _positive, "behavior [[max_nested=1]] b(x: T):"),
    "tolerance": Rule(
        frozenset(("value type",)), _distance, "typedef [[tolerance=0.01]] Pose: vector[float32, 2]"
    ),
    "pddl": Rule(_NAMED, _text, 'feature [[pddl="on-table"]] on_table(x: T)'),
}


def check_annotations(
    written: tuple[syntax.Annotation, ...],
    owner: Owner,
    context: Context,
    type_: Type | None = None,
) -> tuple[Annotation, ...]:
    """The annotations of a definition or statement; `type_` is that of an annotated feature.

    Bare names after `reads=name` are further names of it: `[[reads=position, attached]]`.
    """
    checked: list[Annotation] = []
    for item in written:
        location = context.location(item.span)
        name = item.name.text
        if item.value is None and name not in RULES and checked and checked[-1].name == "reads":
            names = checked[-1].value
            if isinstance(names, tuple):
                _check_read(item.name, owner, context)
                longer = (*names, name)
                checked[-1] = Annotation("reads", longer, location=checked[-1].location)
                continue
        value = _value(item, owner, context)
        if name not in RULES:
            near = nearest(name, list(RULES))
            context.found.add(errors.UnknownAnnotation(location=location, name=name, near=near))
        elif any(other.name == name for other in checked):
            _report(item, "it is given twice", context)
        elif (fault := _fault(name, owner, value, type_)) is not None:
            _report(item, fault, context)
        checked.append(Annotation(name, value, location=location))
    _check_bounds(written, checked, context)
    return tuple(checked)


def _value(item: syntax.Annotation, owner: Owner, context: Context) -> Value:
    match item.value:
        case syntax.Name(text=text) as name:
            if item.name.text == "reads":
                _check_read(name, owner, context)
            return (text,)
        case syntax.Literal(value=value):
            return value
        case None:
            return None


def _check_read(name: syntax.Name, owner: Owner, context: Context) -> None:
    """Report a name in `reads` that is neither `all` nor a feature."""
    declared = context.declarations
    if owner not in RULES["reads"].owners or name.text == "all" or name.text in declared.features:
        return
    location = context.location(name.span)
    kind = declared.kind(name.text)
    if kind is None:
        known = [*declared.features, "all"]
        context.found.add(
            errors.UnknownFeature(location=location, name=name.text, known=known, what="feature")
        )
    else:
        context.found.add(
            errors.BadAnnotation(
                location=location,
                name="reads",
                reason=f"`{name.text}` is a {kind}, and what is read are features",
                example=RULES["reads"].example,
            )
        )


def _fault(name: str, owner: Owner, value: Value, type_: Type | None) -> str | None:
    rule = RULES[name]
    if owner not in rule.owners:
        owners = [o for o in Owner.__args__ if o in rule.owners]  # type: ignore[attr-defined]
        wanted = (
            " or ".join(_with_article(o) for o in owners) if len(owners) < 3 else "a definition"
        )
        return f"it belongs to {wanted}, not to {_with_article(owner)}"
    is_bound = name in ("min", "max") and not isinstance(type_, UnknownType | None)
    if is_bound and type_ is not None and not is_integer(type_):
        return f"only features of an integer type have bounds, not those of type `{type_}`"
    return rule.fault(value)


def _with_article(owner: str) -> str:
    return f"{'an' if owner[0] in 'aeo' else 'a'} {owner}"


def _check_bounds(
    written: tuple[syntax.Annotation, ...], checked: list[Annotation], context: Context
) -> None:
    bounds = {a.name: a.value for a in checked if a.name in ("min", "max")}
    low, high = bounds.get("min"), bounds.get("max")
    if isinstance(low, int) and isinstance(high, int) and low > high:
        last = next(item for item in reversed(written) if item.name.text in ("min", "max"))
        _report(last, f"the bounds {low} to {high} leave no value", context)


def _report(item: syntax.Annotation, reason: str, context: Context) -> None:
    name = item.name.text
    location = context.location(item.span)
    example = RULES[name].example
    context.found.add(
        errors.BadAnnotation(location=location, name=name, reason=reason, example=example)
    )
