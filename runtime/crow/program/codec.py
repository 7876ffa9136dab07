"""Programs as versioned JSON and back; the round trip is the identity, locations included.

The JSON follows the node classes: `{"node": "Read", "feature": "on", …}`. Fields at their default
are left out. Reading checks every field against its annotation, so a damaged file is refused with
the path to the damage instead of failing later.
"""

import types
from collections.abc import Callable, Mapping
from dataclasses import MISSING, Field, fields
from functools import cache
from typing import Any, Literal, TypeVar, Union, cast, get_args, get_origin, get_type_hints

from crow.program import definitions, expressions, statements
from crow.program import types as program_types
from crow.program.definitions import ProblemStatement, Program
from crow.program.location import Location

VERSION = 1

_T = TypeVar("_T")

Json = None | bool | int | float | str | list["Json"] | dict[str, "Json"]

_UNIONS = (
    program_types.Type,
    expressions.Expression,
    statements.Statement,
    definitions.Definition,
)
_OTHERS = (
    Program,
    ProblemStatement,
    definitions.Promotable,
    expressions.Parameter,
    statements.Annotation,
)
NODES: Mapping[str, type] = {
    cls.__name__: cls
    for cls in (*(c for union in _UNIONS for c in get_args(union)), *_OTHERS)
    if cls is not statements.Simulate  # it stands for Python, which is given with a program
}


class ProgramFormatError(ValueError):
    """The JSON is no compiled program of this version; the message says where it stops."""


def encode(program: Program, problem: ProblemStatement | None = None) -> dict[str, Json]:
    """The JSON form of a program and, if given, of one problem for it."""
    document: dict[str, Json] = {"version": VERSION, "program": encode_value(program)}
    if problem is not None:
        document["problem"] = encode_value(problem)
    return document


def decode_program(document: object) -> Program:
    """The program of a JSON document.

    Raises ProgramFormatError if the document is not a compiled program of this version.
    """
    return _decode_part(document, "program", Program)


def decode_problem(document: object) -> ProblemStatement | None:
    """The problem of a JSON document, or None when it holds a program alone.

    Raises ProgramFormatError if the document is not a compiled program of this version.
    """
    if isinstance(document, dict) and "problem" not in document:
        checked_version(document)
        return None
    return _decode_part(document, "problem", ProblemStatement)


def checked_version(document: object) -> dict[str, Any]:
    """The document, if it is of this version. Raises ProgramFormatError."""
    if not isinstance(document, dict) or "version" not in document:
        raise ProgramFormatError("not a compiled program: no `version` at the top")
    if type(document["version"]) is not int or document["version"] != VERSION:
        raise ProgramFormatError(
            f"compiled for version {document['version']!r} of the format; this is version {VERSION}"
        )
    return document


def _decode_part(document: object, part: str, expected: type[_T]) -> _T:
    checked = checked_version(document)
    if part not in checked:
        raise ProgramFormatError(f"not a compiled program: no `{part}` at the top")
    try:
        annotation: Any = expected
        value: _T = decode_value(annotation, checked[part], part)
    except RecursionError:
        raise ProgramFormatError(f"`{part}` is nested too deeply") from None
    return value


def decode_value(annotation: Any, value: object, path: str) -> Any:
    """A value of an annotated type from its JSON. Raises ProgramFormatError, naming the path."""
    return _decoder(annotation)(value, path)


def encode_value(value: object) -> Json:
    """The JSON of part of a program."""
    match value:
        case Location():
            return [value.file, value.line, value.column, value.end_line, value.end_column]
        case tuple():
            return [encode_value(item) for item in value]
        case None | bool() | int() | float() | str():
            return value
        case _:
            encoded: dict[str, Json] = {"node": type(value).__name__}
            for field, default in encoded_fields(cast("Any", type(value))):
                item = getattr(value, field)
                if item is not default and (default is MISSING or item != default):
                    encoded[field] = encode_value(item)
            return encoded


@cache
def encoded_fields(cls: Any) -> tuple[tuple[str, object], ...]:
    """The fields of a node class with their defaults."""
    return tuple((field.name, field.default) for field in fields(cls))


Decoder = Callable[[Any, str], Any]


@cache
def _decoder(annotation: Any) -> Decoder:
    """A function from JSON and its path to a value of the annotated type."""
    if annotation in NODES.values():
        return _node_decoder((annotation,))
    if annotation is Location:
        return _decode_location
    origin, arguments = get_origin(annotation), get_args(annotation)
    if origin is tuple:
        return _tuple_decoder(_decoder(arguments[0]))
    if origin is Literal:
        return _choice_decoder(arguments)
    if origin in (Union, types.UnionType):
        return _union_decoder(arguments)
    return _scalar_decoder((annotation,))


def _union_decoder(arguments: tuple[Any, ...]) -> Decoder:
    nodes = tuple(a for a in arguments if a in NODES.values())
    scalars = tuple(a for a in arguments if a in (bool, int, float, str))
    lists = tuple(a for a in arguments if get_origin(a) is tuple or a is Location)
    optional = types.NoneType in arguments

    def decode(value: Any, path: str) -> Any:
        if value is None and optional:
            return None
        if lists and (isinstance(value, list) or not (nodes or scalars)):
            return _decoder(lists[0])(value, path)
        if nodes:
            return _node_decoder(nodes)(value, path)
        return _scalar_decoder(scalars)(value, path)

    return decode


def _scalar_decoder(allowed: tuple[type, ...]) -> Decoder:
    def decode(value: Any, path: str) -> Any:
        if type(value) not in allowed:
            raise ProgramFormatError(f"{path}: expected {_names(allowed)}, found {value!r:.40}")
        return value

    return decode


def _choice_decoder(choices: tuple[Any, ...]) -> Decoder:
    def decode(value: Any, path: str) -> Any:
        if value not in choices:
            raise ProgramFormatError(f"{path}: expected one of {choices}, found {value!r:.40}")
        return value

    return decode


def _tuple_decoder(item: Decoder) -> Decoder:
    def decode(value: Any, path: str) -> Any:
        if not isinstance(value, list):
            raise ProgramFormatError(f"{path}: expected a list, found {value!r:.40}")
        return tuple(item(element, f"{path}[{index}]") for index, element in enumerate(value))

    return decode


@cache
def _node_decoder(allowed: tuple[type, ...]) -> Decoder:
    def decode(value: Any, path: str) -> Any:
        name = value.get("node") if isinstance(value, dict) else None
        cls = NODES.get(name) if isinstance(name, str) else None
        if cls not in allowed or cls is None:
            raise ProgramFormatError(f"{path}: expected {_names(allowed)}, found {value!r:.40}")
        return _decode_fields(cls, value, path)

    return decode


def _decode_fields(cls: type, value: dict[str, Any], path: str) -> Any:
    known = _field_decoders(cls)
    for name in value:
        if name != "node" and name not in known:
            raise ProgramFormatError(f"{path}: `{cls.__name__}` has no field `{name}`")
    arguments: dict[str, Any] = {}
    for name, (required, decode) in known.items():
        if name in value:
            arguments[name] = decode(value[name], f"{path}.{name}")
        elif required:
            raise ProgramFormatError(f"{path}: `{cls.__name__}` without `{name}`")
    return cls(**arguments)


@cache
def _field_decoders(cls: type) -> dict[str, tuple[bool, Decoder]]:
    hints = get_type_hints(cls)
    return {f.name: (_is_required(f), _decoder(hints[f.name])) for f in fields(cls)}


def _is_required(field: Field[Any]) -> bool:
    return field.default is MISSING and field.default_factory is MISSING


def _decode_location(value: Any, path: str) -> Location:
    match value:
        case [str(file), *numbers] if len(numbers) == 4 and all(map(_is_number, numbers)):
            return Location(file, *numbers)
        case _:
            raise ProgramFormatError(f"{path}: expected [file, 4 numbers], found {value!r:.40}")


def _is_number(value: object) -> bool:
    return type(value) is int and value >= 1


def _names(allowed: tuple[type, ...]) -> str:
    names = [f"`{cls.__name__}`" for cls in allowed]
    return " or ".join(names) if len(names) <= 3 else f"one of {', '.join(names)}"
