"""Problems as bytes for another process: compiled programs, and what is said about them.

A program travels as its JSON (`crow.program.codec`), and once to each process that needs it; with
each problem go its objects, initial state and goal. Python functions travel by name: of a module
that can be imported, or of the file that they were taken from.
"""

import inspect
import json
import pickle
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass, replace
from hashlib import sha256
from typing import Any, Final, Generic, TypeVar, get_args

from crow.functions import NOTHING, Kind, Registered, Registration
from crow.many.tasks import Configuration, Task
from crow.problem import Problem, State, World
from crow.program import Program, Simulate
from crow.program.codec import decode_program, encode
from crow.python_files import run_file
from crow.registration import with_effects

MOST_KEPT: Final = 16
"""So many programs, and the functions for them, are kept at either end."""

_T = TypeVar("_T")


class NotSent(Exception):  # noqa: N818 - about a problem, not about a failure
    """A problem that cannot travel; the message says which part of it and why."""


@dataclass(frozen=True, slots=True)
class Packed:
    """A task as bytes: `parts`, by keys, may be there already where it goes."""

    parts: Mapping[str, bytes]
    body: bytes
    configuration: Configuration


class Recent(Generic[_T]):
    """What was used last, by keys: two of them that are used alike hold the same keys."""

    def __init__(self, most: int = MOST_KEPT) -> None:
        self._kept: OrderedDict[Any, _T] = OrderedDict()
        self._most = most

    def get(self, key: object) -> _T | None:
        """What is kept; it counts as used."""
        found = self._kept.get(key)
        if found is not None:
            self._kept.move_to_end(key)
        return found

    def put(self, key: object, value: _T) -> _T:
        """Keep something; what was used longest ago has to go."""
        self._kept[key] = value
        self._kept.move_to_end(key)
        while len(self._kept) > self._most:
            self._kept.popitem(last=False)
        return value


# --------------------------------------------------------------------------------------------- out


class Packer:
    """Packs tasks; a program that was packed lately is not made JSON again."""

    def __init__(self) -> None:
        # With what each was made of, or its id might be another's.
        self._made: Recent[tuple[object, str, bytes]] = Recent()

    def pack(self, task: Task) -> Packed:
        """A task as bytes. Raises NotSent."""
        problem, world = task.problem, task.problem.world
        try:
            parts = [self._part(world.program, _program_bytes)]
            if world.registered is not NOTHING:
                parts.append(self._part(world.registered, _registered_bytes))
            about = (
                [key for key, _ in parts],
                problem.name,
                dict(world.objects),
                dict(problem.initial.cells),
                problem.goal,
                problem.minimize,
            )
            return Packed(dict(parts), pickle.dumps(about), task.configuration)
        except NotSent:
            raise
        except Exception as error:  # values of the user's may raise anything
            raise NotSent(f"{type(error).__name__}: {error}") from error

    def _part(self, of: Any, to_bytes: Any) -> tuple[str, bytes]:
        made = self._made.get(id(of))
        if made is None:
            data = to_bytes(of)
            made = self._made.put(id(of), (of, sha256(data).hexdigest(), data))
        return made[1:]


def _program_bytes(program: Program) -> bytes:
    """A program as JSON, without the effects that stand for Python, which comes beside it."""
    written = [
        replace(c, effect=None) if c.effect and isinstance(c.effect[0], Simulate) else c
        for c in program.controllers
    ]
    return json.dumps(encode(replace(program, controllers=tuple(written)))).encode()


@dataclass(frozen=True, slots=True)
class _OfFile:
    """A Python function that a file has under a name."""

    file: str
    name: str


def _registered_bytes(registered: Registered) -> bytes:
    return pickle.dumps({kind: _sendable(registered, kind) for kind in get_args(Kind)})


def _sendable(registered: Registered, kind: Kind) -> list[Registration]:
    found: Mapping[str, Registration] = getattr(registered, f"{kind}s")
    return [replace(one, call=_by_name(one)) for one in found.values()]


def _by_name(one: Registration) -> Any:
    """The Python itself, where it pickles by its name, or a name in a file. Raises NotSent."""
    try:
        pickle.dumps(one.call)
    except Exception as error:  # noqa: BLE001 - pickling may raise anything
        names = getattr(inspect.unwrap(one.call), "__globals__", {})
        name = next((n for n, value in names.items() if value is one.call), None)
        if name is not None and isinstance(names.get("__file__"), str):
            return _OfFile(names["__file__"], name)
        raise NotSent(
            f"the Python of `{one.name}` cannot travel to another process: it has to be a function"
            f" of a module that can be imported, under its own name there ({error})"
        ) from None
    return one.call


# ---------------------------------------------------------------------------------------------- in


class Unpacker:
    """Unpacks tasks; programs and functions stay for those that follow."""

    def __init__(self) -> None:
        self._parts: Recent[Any] = Recent()
        self._worlds: Recent[World] = Recent(1)

    def problem(self, parts: Mapping[str, bytes], body: bytes) -> Problem:
        """The problem of a task; `parts` are those that were not sent before.

        Raises what loading the modules of the user's functions raises.
        """
        keys, name, objects, cells, goal, minimize = pickle.loads(body)  # noqa: S301 - our own
        program = self._part(keys[0], parts, _program_of)
        registered = self._part(keys[1], parts, _registered_of) if len(keys) > 1 else NOTHING
        world = self._world((*keys, tuple(objects.items())), program, objects, registered)
        return Problem.made(name, world, State(cells), goal, minimize)

    def _part(self, key: str, parts: Mapping[str, bytes], of_bytes: Any) -> Any:
        found = self._parts.get(key)
        return self._parts.put(key, of_bytes(parts[key])) if found is None else found

    def _world(self, key: object, program: Program, objects: Any, registered: Registered) -> World:
        """A world; if it is that of the task before, with all that was found out about it."""
        found = self._worlds.get(key)
        if found is None:
            own = with_effects(program, registered)
            found = self._worlds.put(key, World(own, objects, registered))
        return found


def _program_of(data: bytes) -> Program:
    return decode_program(json.loads(data))


def _registered_of(data: bytes) -> Registered:
    files: dict[str, Mapping[str, Any]] = {}

    def found(one: Registration) -> Registration:
        call: Any = one.call
        if not isinstance(call, _OfFile):
            return one
        if call.file not in files:
            files[call.file] = run_file(call.file)
        return replace(one, call=files[call.file][call.name])

    kinds = pickle.loads(data)  # noqa: S301 - our own
    return Registered(**{f"{k}s": {r.name: found(r) for r in rs} for k, rs in kinds.items()})
