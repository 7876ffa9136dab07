"""Python for a program: decorators, and what a module, a file, a mapping or an object gives.

    @crow.function
    def near(a, b):
        return distance(a, b) < 3

    domain = cdlc.load("walks.cdl", functions=module)

`crow.registration` binds it to the declarations of a program (semantics.md §4, App. B).
"""

import inspect
import os
import pickle
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from types import ModuleType
from typing import Any, Final, Literal, TypeVar, overload

from crow.program import Location

Kind = Literal["function", "generator", "effect", "controller"]
Python = Callable[..., Any]
_F = TypeVar("_F", bound=Python)

_MARKS: Final = "__crow_marks__"


class FunctionsError(ValueError):
    """Python that cannot be run or does not fit its program; `mistakes` are all of them."""

    def __init__(self, message: str, mistakes: "tuple[Mistake, ...]" = ()) -> None:
        super().__init__(message)
        self.mistakes = mistakes


@dataclass(frozen=True, slots=True)
class Mistake:
    """What is wrong with something given, and where the program declares it."""

    message: str
    location: Location | None
    help: str | None = None


@dataclass(frozen=True, slots=True)
class Mark:
    """What a decorator says of a Python function; a name of None is that of the function."""

    kind: Kind
    name: str | None = None
    is_vectorized: bool = False
    is_complete: bool = False
    is_batch: bool = False
    limit: int | None = None


@dataclass(frozen=True, slots=True)
class Given:
    """A Python function under the name of what it is for.

    What is not decorated has no kind yet, and is left alone, unless it was named for the program
    (`is_meant`), where the program declares nothing of its name. In a mapping, names are those of
    the program (`is_named`).
    """

    name: str
    call: Python
    mark: Mark | None
    is_meant: bool
    is_named: bool = False


@dataclass(frozen=True, slots=True)
class Collected:
    """Python functions that were collected, decorated ones first."""

    given: tuple[Given, ...]


@dataclass(frozen=True, slots=True)
class Registration:
    """A Python function for one declaration of a program.

    `reads` are the features that it may read, which makes the state its first argument; None if
    it does not get the state.
    """

    name: str
    call: Python
    mark: Mark
    reads: frozenset[str] | None
    takes_random: bool = False


@dataclass(frozen=True)
class Registered:
    """The Python of one program by kind and name; it pickles where its functions do."""

    functions: Mapping[str, Registration] = field(default_factory=dict)
    generators: Mapping[str, Registration] = field(default_factory=dict)
    effects: Mapping[str, Registration] = field(default_factory=dict)
    controllers: Mapping[str, Registration] = field(default_factory=dict)

    def __getstate__(self) -> dict[str, Any]:
        for kind in (self.functions, self.generators, self.effects, self.controllers):
            for one in kind.values():
                _check_pickles(one)
        return self.__dict__


NOTHING: Final = Registered()
"""No Python at all."""


def _check_pickles(one: Registration) -> None:
    try:
        pickle.dumps(one.call)
    except Exception as error:  # noqa: BLE001 - pickling may raise anything
        raise pickle.PicklingError(
            f"the Python of `{one.name}` cannot be pickled: it has to come from a module that can"
            f" be imported, and under its own name there ({error})"
        ) from None


# --------------------------------------------------------------------------------------- decorators


def _marked(given: "str | Python | None", mark: Mark) -> Any:
    """The decorator, or what it makes of a function where it stands without parentheses."""
    named = replace(mark, name=given) if isinstance(given, str) else mark

    def decorate(python: _F) -> _F:
        try:
            setattr(python, _MARKS, tuple(dict.fromkeys((*_marks(python), named))))
        except AttributeError:
            message = f"{python!r:.60} cannot be decorated; give it in a mapping"
            raise TypeError(message) from None
        return python

    return decorate(given) if callable(given) else decorate


@overload
def function(name: _F, /) -> _F: ...
@overload
def function(name: str | None = None, /, *, vectorized: bool = False) -> Callable[[_F], _F]: ...
def function(name: Any = None, /, *, vectorized: bool = False) -> Any:
    """Mark the Python of an external function: `f(*arguments)`.

    It gets the state first where the program declares `[[reads=…]]`. Without a name it has that of
    the Python function. A `vectorized` one gets numpy arrays with a row for each candidate, and
    returns as many results.
    """
    return _marked(name, Mark("function", is_vectorized=vectorized))


@overload
def generator(name: _F, /) -> _F: ...
@overload
def generator(
    name: str | None = None,
    /,
    *,
    complete: bool = False,
    limit: int | None = None,
    batch: bool = False,
) -> Callable[[_F], _F]: ...
def generator(
    name: Any = None,
    /,
    *,
    complete: bool = False,
    limit: int | None = None,
    batch: bool = False,
) -> Any:
    """Mark the Python of a generator: `f(*inputs)` yields tuples of outputs (App. B.1).

    It gets the state first where the function in its goal reads it, and a numpy.random.Generator
    where it has a parameter `rng`. `complete`: it ends, and yields every solution. `limit`: the
    most values asked of one call. `batch`: it yields tuples of arrays, a row for each solution.
    Raises ValueError for a limit that is not positive.
    """
    if limit is not None and not (type(limit) is int and limit >= 1):
        raise ValueError(f"the limit of a generator is a whole number from 1 on, not {limit!r}")
    return _marked(name, Mark("generator", is_complete=complete, is_batch=batch, limit=limit))


@overload
def effect(name: _F, /) -> _F: ...
@overload
def effect(name: str | None = None, /) -> Callable[[_F], _F]: ...
def effect(name: Any = None, /) -> Any:
    """Mark the effect of a controller as a simulator computes it: `f(state, *arguments)` (§2.2).

    It returns the new values of cells, such as `{("position", "a"): (0, 1)}`.
    """
    return _marked(name, Mark("effect"))


@overload
def controller(name: _F, /) -> _F: ...
@overload
def controller(name: str | None = None, /) -> Callable[[_F], _F]: ...
def controller(name: Any = None, /) -> Any:
    """Mark what carries a controller out, `f(*arguments)`: see crow.Robot."""
    return _marked(name, Mark("controller"))


# --------------------------------------------------------------------------------------- collecting


def collected(given: object) -> Collected:
    """What a module, a file, a mapping or an object gives.

    A mapping names each function for the program; of anything else, decorated functions are taken,
    of a module or file also those that have the name of a function or generator of the program.
    Raises FunctionsError for a file that cannot be run, and what is none of these.
    """
    match given:
        case Collected():
            return given
        case str() | os.PathLike():
            from crow.python_files import run_file

            return _of_names(run_file(os.fspath(given)), takes_plain=True)
        case ModuleType():
            return _of_names(vars(given), takes_plain=True)
        case Mapping():
            return Collected(tuple(_of_mapping(given)))
        case _:
            found = _of_names(_methods(given), takes_plain=False)
            if not found.given:
                raise FunctionsError(
                    f"functions are given as a module, a file, a mapping or an object with"
                    f" decorated methods; {given!r:.60} is none of these"
                )
            return found


def _methods(given: object) -> dict[str, Any]:
    """The decorated methods of an object; its properties are not looked at."""
    found = {}
    for name in dir(given):
        own = inspect.getattr_static(given, name)
        if _marks(getattr(own, "__func__", own)):
            found[name] = getattr(given, name)
    return found


def _of_names(names: Mapping[str, Any], *, takes_plain: bool) -> Collected:
    marked: dict[Given, None] = {}  # once, though a module has it under two names
    plain = []
    for name, python in names.items():
        if not callable(python):
            continue
        marks = _marks(python)
        own = getattr(python, "__name__", name)
        marked |= {Given(m.name or own, python, m, is_meant=True): None for m in marks}
        if takes_plain and not marks and not name.startswith("_"):
            plain.append(Given(name, python, None, is_meant=False))
    return Collected((*marked, *plain))


def _of_mapping(given: Mapping[Any, Any]) -> Iterator[Given]:
    for name, python in given.items():
        if not isinstance(name, str) or not callable(python):
            raise FunctionsError(f"`{name}`: {python!r:.60} is no Python function")
        marks = _marks(python)
        for mark in marks:
            yield Given(name, python, mark, is_meant=True, is_named=True)
        if not marks:
            yield Given(name, python, None, is_meant=True, is_named=True)


def _marks(python: Python) -> tuple[Mark, ...]:
    marks = getattr(python, _MARKS, ())
    return marks if isinstance(marks, tuple) else ()
