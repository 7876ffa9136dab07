"""The JSON schema of compiled programs, made from the node classes, so that it cannot go stale."""

import types
from dataclasses import MISSING, fields
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

from crow.program.codec import NODES, VERSION
from crow.program.definitions import ProblemStatement, Program
from crow.program.expressions import Expression
from crow.program.location import Location
from crow.program.model_codec import EXPRESSIONS, PARTS, field_types
from crow.program.statements import Statement
from crow.program.triples import HoareModel
from crow.program.types import Type

_FAMILIES: dict[str, Any] = {
    "Type": Type,
    "Expression": Expression,
    "Statement": Statement,
}

_SCALARS: dict[Any, dict[str, Any]] = {
    bool: {"type": "boolean"},
    # A float such as 1.0 is an integer to JSON schema, and so an int would pass for a float.
    int: {"type": "integer"},
    float: {"type": "number"},
    str: {"type": "string"},
    types.NoneType: {"type": "null"},
}


def schema() -> dict[str, Any]:
    """The schema of what `encode` returns."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "A compiled CDL program",
        "type": "object",
        "properties": {
            "version": {"const": VERSION},
            "program": _reference(Program),
            "problem": _reference(ProblemStatement),
            "model": {"$ref": "#/$defs/Model"},
        },
        "required": ["version", "program"],
        "additionalProperties": False,
        "$defs": definitions(),
    }


def hoare_schema() -> dict[str, Any]:
    """The schema of `compile --emit hoare --format json`: a model without its program."""
    whole = schema()
    properties = {name: whole["properties"][name] for name in ("version", "model")}
    return {
        **whole,
        "title": "The Hoare model of a CDL program",
        "properties": properties,
        "required": list(properties),
        "$defs": _needed(properties, whole["$defs"]),
    }


def _needed(roots: object, definitions: dict[str, Any]) -> dict[str, Any]:
    """The definitions that a schema refers to, and those that they do."""
    needed: dict[str, Any] = {}
    pending = [roots]
    while pending:
        match pending.pop():
            case {"$ref": str(reference)} if reference.removeprefix("#/$defs/") not in needed:
                name = reference.removeprefix("#/$defs/")
                needed[name] = definitions[name]
                pending.append(definitions[name])
            case dict() as inner:
                pending.extend(inner.values())
            case list() as inner:
                pending.extend(inner)
            case _:
                continue
    return dict(sorted(needed.items()))


def definitions() -> dict[str, Any]:
    """What the schema refers to."""
    nodes = {name: _node(cls) for name, cls in sorted(NODES.items())}
    return {
        "Location": {
            "description": "File, line, column, end line, end column; columns count from 1.",
            "type": "array",
            "prefixItems": [{"type": "string"}, *[{"type": "integer"}] * 4],
            "items": False,
            "minItems": 5,
        },
        **{
            name: _choice({n: _reference(m) for n, m in NODES.items() if m in get_args(family)})
            for name, family in _FAMILIES.items()
        },
        **nodes,
        **_model(),
    }


def _choice(schemas: dict[str, Any]) -> dict[str, Any]:
    """One of several node classes, told apart by `node` before anything else is looked at.

    With `anyOf`, a validator would try each class on every node and all nodes below it, which takes
    time exponential in their depth.
    """
    return {
        "type": "object",
        "required": ["node"],
        "properties": {"node": {"enum": list(schemas)}},
        "allOf": [
            {"if": {"properties": {"node": {"const": name}}}, "then": schema}
            for name, schema in schemas.items()
        ],
    }


def _node(cls: Any) -> dict[str, Any]:
    hints = get_type_hints(cls)
    required = [f.name for f in fields(cls) if f.default is MISSING]
    return {
        "description": str(cls.__doc__),
        "type": "object",
        "properties": {
            "node": {"const": cls.__name__},
            **{f.name: _value(hints[f.name]) for f in fields(cls)},
        },
        "required": ["node", *required],
        "additionalProperties": False,
    }


def _reference(cls: Any) -> dict[str, Any]:
    return {"$ref": f"#/$defs/{cls.__name__}"}


def _value(annotation: Any) -> dict[str, Any]:
    """The schema of a field from its annotation."""
    if annotation in _SCALARS:
        return _SCALARS[annotation]
    if annotation is Location or annotation in NODES.values():
        return _reference(annotation)
    origin, arguments = get_origin(annotation), get_args(annotation)
    if origin is tuple:
        return {"type": "array", "items": _value(arguments[0])}
    if origin is Literal:
        return {"enum": list(arguments)}
    if origin in (Union, types.UnionType):
        return _union(frozenset(arguments), arguments)
    raise TypeError(f"no schema for {annotation!r}")


def _union(members: frozenset[Any], ordered: tuple[Any, ...]) -> dict[str, Any]:
    """A union as a reference to its name where it has one, with what comes on top of it."""
    for name, family in _FAMILIES.items():
        whole = frozenset(get_args(family))
        if whole <= members:
            reference = {"$ref": f"#/$defs/{name}"}
            rest = [_value(member) for member in ordered if member not in whole]
            return {"anyOf": [reference, *rest]} if rest else reference
    return {"anyOf": [_value(member) for member in ordered]}


# ------------------------------------------------------------------------------------------ models


def _model() -> dict[str, Any]:
    """`Model`, its parts and the nodes of its table, in which an expression is its place."""
    nodes = {"type": "array", "items": {"$ref": "#/$defs/ModelNode"}}
    ordered = sorted(EXPRESSIONS, key=lambda cls: cls.__name__)
    choices = {c.__name__: _model_part(c, {"node": {"const": c.__name__}}) for c in ordered}
    return {
        "Place": {
            "description": "The place of a node in the table, from 0; parts stand before wholes.",
            "type": "integer",
            "minimum": 0,
        },
        "ModelNode": _choice(choices),
        "Model": _model_part(HoareModel, {"nodes": nodes}),
        **{f"Model{cls.__name__}": _model_part(cls, {}) for cls in PARTS if cls is not HoareModel},
    }


def _model_part(cls: type, extra: dict[str, Any]) -> dict[str, Any]:
    types_of = field_types(cls)
    own = {name: _model_value(annotation) for name, (annotation, _) in types_of.items()}
    return {
        "description": str(cls.__doc__).partition("\n")[0],
        "type": "object",
        "properties": {**extra, **own},
        "required": [*extra, *(name for name, (_, required) in types_of.items() if required)],
        "additionalProperties": False,
    }


def _model_value(annotation: Any) -> dict[str, Any]:
    """The schema of a field of a model."""
    place = {"$ref": "#/$defs/Place"}
    if annotation == Expression:
        return place
    if get_origin(annotation) is tuple:
        return {"type": "array", "items": _model_value(get_args(annotation)[0])}
    if get_origin(annotation) is frozenset:
        return {"type": "array", "items": {"type": "integer", "minimum": 0}}
    if annotation in PARTS:
        return {"$ref": f"#/$defs/Model{annotation.__name__}"}
    if frozenset(get_args(annotation)) == EXPRESSIONS | {types.NoneType}:
        return {"anyOf": [place, {"type": "null"}]}
    return _value(annotation)
