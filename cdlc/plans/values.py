"""Values of steps, as written in calls, checked against types."""

import re

from crow.problem import World
from crow.program import STRING, ListType, ObjectType, Type, VectorType
from crow.program.types import BOOL, is_integer, is_number, underlying
from crow.reading import read_json, wrong_value
from crow.values import Value

# As many digits as a number of any type may have; Python refuses to read very long ones.
_INTEGER = re.compile(r"-?[0-9]{1,20}")
_NUMBER = re.compile(r"-?[0-9]{1,400}(\.[0-9]{0,400})?([eE][+-]?[0-9]{1,4})?")


def read_text(text: str, type_: Type, world: World) -> Value:
    """The value of a type that stands in a call: `a`, `True`, `-1.5`, `"s"`, `[1, 2]`.

    Raises WrongValueError.
    """
    plain = underlying(type_)
    if isinstance(plain, ObjectType):
        return read_json(text, plain, world)
    if plain == BOOL and text in ("True", "False"):
        return text == "True"
    if is_integer(plain) and _INTEGER.fullmatch(text):
        return read_json(int(text), type_, world)
    if is_number(plain) and not is_integer(plain) and _NUMBER.fullmatch(text):
        return read_json(float(text), type_, world)
    if plain == STRING and len(text) > 1 and text[0] == text[-1] == '"':
        return text[1:-1]
    if isinstance(plain, VectorType | ListType) and text[:1] == "[" and text[-1:] == "]":
        items = text[1:-1].split(",") if text[1:-1].strip() else []
        read = [read_text(item.strip(), plain.element, world) for item in items]
        return read_json(read, type_, world)
    raise wrong_value(text, type_)
