"""Values that come from outside, JSON or Python, checked against the types of a program."""

import math

from crow.problem import World
from crow.program import PYOBJECT, STRING, ListType, ObjectType, Type, VectorType
from crow.program.types import BOOL, is_number, underlying
from crow.values import Value, converted


class WrongValueError(ValueError):
    """What is no value of the type wanted; `known` are the objects that are."""

    def __init__(self, reason: str, known: tuple[str, ...] = ()) -> None:
        super().__init__(reason)
        self.known = known


def read_json(value: object, type_: Type, world: World) -> Value:
    """The value of a type that a value of JSON or Python stands for. Raises WrongValueError."""
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
        case plain, _ if plain == PYOBJECT:
            return _plain_data(value)
        case _:
            raise wrong_value(repr(value), type_)
    if isinstance(read, float) and not math.isfinite(read):
        raise wrong_value(repr(value), type_)
    try:
        return converted(read, type_)
    except ArithmeticError as error:
        raise WrongValueError(str(error)) from None


def _plain_data(value: object) -> Value:
    """A value of Python that is plain data, lists as tuples. Raises WrongValueError for others."""
    match value:
        case list() | tuple():
            return tuple(map(_plain_data, value))
        case bool() | int() | float() | str():
            return value
        case {"opaque": str(shown)}:
            raise WrongValueError(f"`{shown:.40}` is a value of Python, which no file has")
        case _:
            raise wrong_value(repr(value), PYOBJECT)


def wrong_value(written: str, type_: Type) -> WrongValueError:
    """That something written is no value of a type."""
    return WrongValueError(f"`{written:.40}` is no value of type `{type_}`")


def _wrong_object(name: str, type_: ObjectType, world: World) -> WrongValueError:
    reason = f"no object `{name}`"
    if name in world.objects:
        reason = f"`{name}` is a `{world.objects[name]}`, not a `{type_}`"
    return WrongValueError(reason, world.objects_of(type_))
