"""Values of steps and traces, as written in calls and as JSON has them, checked against types."""

import math
import re

from crow.problem import World
from crow.program import STRING, ListType, ObjectType, Type, VectorType
from crow.program.types import BOOL, is_integer, is_number, underlying
from crow.values import Value, converted

# As many digits as a number of any type may have; Python refuses to read very long ones.
_INTEGER = re.compile(r"-?[0-9]{1,20}")
_NUMBER = re.compile(r"-?[0-9]{1,400}(\.[0-9]{0,400})?([eE][+-]?[0-9]{1,4})?")


class WrongValueError(ValueError):
    """What is no value of the type wanted; `known` are the objects that are."""

    def __init__(self, reason: str, known: tuple[str, ...] = ()) -> None:
        super().__init__(reason)
        self.known = known


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
    raise _wrong(text, type_)


def read_json(value: object, type_: Type, world: World) -> Value:
    """The value of a type that a JSON value stands for. Raises WrongValueError."""
    match underlying(type_), value:
        case ObjectType() as wanted, str() as name:
            if not world.is_of(name, wanted):
                raise _wrong_object(name, wanted, world)
            return name
        case ((VectorType(element=element) | ListType(element=element)), list() | tuple() as items):
            read: Value = tuple(read_json(item, element, world) for item in items)
        case plain, bool() if plain == BOOL:
            return value
        case plain, str() if plain == STRING:
            return value
        case plain, int() | float() if is_number(plain) and not isinstance(value, bool):
            read = value
        case _:
            raise _wrong(repr(value), type_)
    if isinstance(read, float) and not math.isfinite(read):
        raise _wrong(repr(value), type_)
    try:
        return converted(read, type_)
    except ArithmeticError as error:
        raise WrongValueError(str(error)) from None


def _wrong(written: str, type_: Type) -> WrongValueError:
    return WrongValueError(f"`{written:.40}` is no value of type `{type_}`")


def _wrong_object(name: str, type_: ObjectType, world: World) -> WrongValueError:
    reason = f"no object `{name}`"
    if name in world.objects:
        reason = f"`{name}` is a `{world.objects[name]}`, not a `{type_}`"
    return WrongValueError(reason, world.objects_of(type_))
