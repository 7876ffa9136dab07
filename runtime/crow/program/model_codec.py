"""Hoare models as JSON and back. Formulas share parts, so their nodes stand in one table.

`nodes` lists every node once, parts before wholes; where a program's JSON has an expression, a
model's has its place in the table. So the JSON grows with the graph of the formulas, not with
their text, which can be exponentially larger.
"""

from collections.abc import Iterator
from dataclasses import MISSING, fields
from functools import cache
from types import NoneType
from typing import Any, Final, cast, get_args, get_origin, get_type_hints

from crow.program.codec import (
    NODES,
    Json,
    ProgramFormatError,
    checked_version,
    decode_value,
    encode_value,
    encoded_fields,
)
from crow.program.expressions import Expression
from crow.program.statements import Do
from crow.program.triples import Conflict, HoareModel, Triple, Unmodelled, Update

PARTS: Final[tuple[type, ...]] = (HoareModel, Triple, Update, Conflict, Unmodelled, Do)
"""What a model is made of besides expressions; in its JSON these have no `node`."""

EXPRESSIONS: Final[frozenset[type]] = frozenset(get_args(Expression))


def encode_model(model: HoareModel) -> dict[str, Json]:
    """The JSON form of a model; its size is linear in that of the formulas as graphs."""
    table = _Table()
    encoded = table.encode(model)
    assert isinstance(encoded, dict)
    return {"nodes": table.nodes, **encoded}


def decode_model(document: object) -> HoareModel | None:
    """The model that a compiled program carries, or None where it has none.

    Raises ProgramFormatError if the document is not a compiled program of this version.
    """
    part = checked_version(document).get("model")
    return None if part is None else decode_model_part(part)


def decode_model_part(part: object) -> HoareModel:
    """The model of what `encode_model` returns. Raises ProgramFormatError for anything else."""
    if not isinstance(part, dict) or not isinstance(part.get("nodes"), list):
        raise ProgramFormatError("model: no table of `nodes`")
    reader = _Reader()
    for index, node in enumerate(part["nodes"]):
        reader.nodes.append(reader.node(node, f"model.nodes[{index}]"))
    rest = {name: value for name, value in part.items() if name != "nodes"}
    model: HoareModel = reader.part(HoareModel, rest, "model")
    return model


class _Table:
    """Expressions by their place in the table of nodes."""

    def __init__(self) -> None:
        self.nodes: list[Json] = []
        self._places: dict[int, int] = {}

    def encode(self, value: object) -> Json:
        """JSON of part of a model, with every expression in it put into the table."""
        match value:
            case _ if type(value) in EXPRESSIONS:
                return self._place(cast("Expression", value))
            case tuple():
                return [self.encode(item) for item in value]
            case frozenset():
                return [*sorted(cast("frozenset[int]", value))]
            case _ if type(value) in PARTS:
                return self._fields(value)
            case _:
                return encode_value(value)

    def _fields(self, value: object) -> dict[str, Json]:
        encoded: dict[str, Json] = {}
        for name, default in encoded_fields(cast("Any", type(value))):
            item = getattr(value, name)
            if item is not default and (default is MISSING or item != default):
                encoded[name] = self.encode(item)
        return encoded

    def _place(self, root: Expression) -> int:
        stack: list[tuple[Expression, bool]] = [(root, False)]
        while stack:
            node, is_ready = stack.pop()
            if id(node) in self._places:
                continue
            if is_ready:
                encoded = {"node": type(node).__name__, **self._fields(node)}
                self._places[id(node)] = len(self.nodes)
                self.nodes.append(cast("Json", encoded))
            else:
                stack.append((node, True))
                stack.extend((part, False) for part in reversed(tuple(_parts(node))))
        return self._places[id(root)]


def _parts(node: Expression) -> Iterator[Expression]:
    """The expressions directly under one."""
    for name, _ in encoded_fields(cast("Any", type(node))):
        value = getattr(node, name)
        if isinstance(value, tuple):
            yield from (item for item in value if type(item) in EXPRESSIONS)
        elif type(value) in EXPRESSIONS:
            yield value


class _Reader:
    """Reads parts of a model whose table has been read up to some node."""

    def __init__(self) -> None:
        self.nodes: list[Expression] = []

    def node(self, value: object, path: str) -> Expression:
        """One node of the table; its parts stand before it."""
        name = value.get("node") if isinstance(value, dict) else None
        cls = NODES.get(name) if isinstance(name, str) else None
        if cls not in EXPRESSIONS or cls is None:
            raise ProgramFormatError(f"{path}: expected an expression, found {value!r:.40}")
        rest = {n: v for n, v in cast("dict[str, Any]", value).items() if n != "node"}
        return cast("Expression", self.part(cls, rest, path))

    def part(self, cls: type, value: object, path: str) -> Any:
        """A part of the given class."""
        if not isinstance(value, dict):
            raise ProgramFormatError(f"{path}: expected an object, found {value!r:.40}")
        known = field_types(cls)
        for name in value:
            if name not in known:
                raise ProgramFormatError(f"{path}: `{cls.__name__}` has no field `{name}`")
        arguments = {}
        for name, (annotation, is_required) in known.items():
            if name in value:
                arguments[name] = self._value(annotation, value[name], f"{path}.{name}")
            elif is_required:
                raise ProgramFormatError(f"{path}: `{cls.__name__}` without `{name}`")
        return cls(**arguments)

    def _value(self, annotation: Any, value: object, path: str) -> Any:
        if annotation == Expression:
            return self._expression(value, path)
        if get_origin(annotation) is tuple:
            return tuple(self._items(get_args(annotation)[0], value, path))
        if get_origin(annotation) is frozenset:
            return frozenset(self._items(int, value, path))
        if annotation in PARTS:
            return self.part(annotation, value, path)
        if frozenset(get_args(annotation)) == EXPRESSIONS | {NoneType}:
            return None if value is None else self._expression(value, path)
        return decode_value(annotation, value, path)

    def _items(self, annotation: Any, value: object, path: str) -> Iterator[Any]:
        if not isinstance(value, list):
            raise ProgramFormatError(f"{path}: expected a list, found {value!r:.40}")
        for index, item in enumerate(value):
            yield self._value(annotation, item, f"{path}[{index}]")

    def _expression(self, value: object, path: str) -> Expression:
        if type(value) is not int or not 0 <= value < len(self.nodes):
            raise ProgramFormatError(f"{path}: no node {value!r:.40} before this one")
        return self.nodes[value]


@cache
def field_types(cls: type) -> dict[str, tuple[Any, bool]]:
    """The annotation of each field, and whether it has to be given."""
    hints = get_type_hints(cls)
    return {f.name: (hints[f.name], f.default is MISSING) for f in fields(cast("Any", cls))}
