"""Annotations: kept in the program; unknown ones are a warning (language.md §2)."""

from crow.program import Annotation

from cdlc.frontend import errors, syntax
from cdlc.frontend.scope import Context

KNOWN = frozenset(("min", "max", "reads", "max_nested", "tolerance", "pddl"))


def check_annotations(
    written: tuple[syntax.Annotation, ...], context: Context
) -> tuple[Annotation, ...]:
    """The annotations of a definition or statement.

    Bare names after `reads=name` are further names of it: `[[reads=position, attached]]`.
    """
    checked: list[Annotation] = []
    for item in written:
        location = context.location(item.span)
        name = item.name.text
        if item.value is None and checked and checked[-1].name == "reads":
            names = checked[-1].value
            assert isinstance(names, tuple)
            checked[-1] = Annotation("reads", (*names, name), location=checked[-1].location)
            continue
        if name not in KNOWN:
            context.found.add(errors.UnknownAnnotation(location=location, name=name))
        match item.value:
            case syntax.Name(text=text):
                checked.append(Annotation(name, (text,), location=location))
            case syntax.Literal(value=value):
                checked.append(Annotation(name, value, location=location))
            case None:
                checked.append(Annotation(name, location=location))
    return tuple(checked)
