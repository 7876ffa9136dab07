"""Values on their way out to the user's Python, and back: numpy and lists become values of CDL."""

from crow.problem import World
from crow.program import PYOBJECT, ListType, Type
from crow.program.types import underlying
from crow.reading import WrongValueError, read_json, wrong_value
from crow.values import Opaque, Value


def taken_in(value: object, type_: Type, world: World) -> Value:
    """The value of a type that the user's Python gave.

    Numpy's scalars and arrays, and lists, become numbers and tuples. Raises WrongValueError for
    another type or shape, a number that is not finite or does not fit, and an object that the
    problem does not have.
    """
    plain = underlying(type_)
    if plain == PYOBJECT:
        return hashable(value)
    if isinstance(plain, ListType) and underlying(plain.element) == PYOBJECT:
        if not isinstance(value, list | tuple):
            raise wrong_value(repr(value), type_)
        return tuple(map(hashable, value))
    try:
        return read_json(_pure(value), type_, world)
    except WrongValueError as error:
        shape = getattr(value, "shape", None)
        if shape:
            message = f"an array of shape {shape} is no value of type `{type_}`: {error}"
            raise WrongValueError(message, error.known) from None
        raise


def _pure(value: object) -> object:
    """Numbers and lists of Python for those of numpy; told by what they can do, not imported."""
    if isinstance(value, list | tuple):
        return tuple(map(_pure, value))
    if hasattr(value, "dtype") and hasattr(value, "tolist"):
        return value.tolist()
    return value


def hashable(value: object) -> Value:
    """A Python value as it stands inside: itself, or Opaque where it cannot be hashed."""
    if value is None:
        return Opaque(None)
    try:
        hash(value)
    except TypeError:
        return Opaque(value)
    return value
