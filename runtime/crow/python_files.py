"""A file of Python, run for the functions in it."""

import importlib.util
import sys
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

from crow.functions import FunctionsError

_HERE: Final = Path(__file__).parent


def run_file(path: str) -> Mapping[str, Any]:
    """The names that a file defines. Raises FunctionsError for what cannot be read or run.

    Files beside it can be imported while it runs.
    """
    name = f"functions_in_{Path(path).stem}"
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise FunctionsError(f"`{path}`: not a file of Python, which ends in `.py`")
    module = importlib.util.module_from_spec(spec)
    with _importing(name, module, str(Path(path).resolve().parent)):
        try:
            spec.loader.exec_module(module)
        except OSError as error:
            if error.filename is None or Path(error.filename) != Path(path).absolute():
                raise FunctionsError(_told(path, error)) from error
            raise FunctionsError(f"`{path}`: {error.strerror or error}") from error
        except Exception as error:
            raise FunctionsError(_told(path, error)) from error
    return vars(module)


def _told(path: str, error: Exception) -> str:
    return f"`{path}`: {type(error).__name__}: {error}\n{user_traceback(error, path)}".rstrip()


def user_traceback(error: BaseException, first: str | None = None) -> str:
    """The traceback of an exception, of the user's own code alone; from the file `first` on."""
    told = traceback.TracebackException.from_exception(error)
    frames = list(told.stack)
    if first is not None:
        start = str(Path(first).absolute())
        begun = [i for i, frame in enumerate(frames) if frame.filename == start]
        frames = frames[begun[0] :] if begun else []
    own = [frame for frame in frames if Path(frame.filename).parent != _HERE]
    told.stack = traceback.StackSummary.from_list(own)
    return "".join(told.format())


@contextmanager
def _importing(name: str, module: Any, folder: str) -> Iterator[None]:
    """Let a module find itself, as dataclasses want, and its neighbours; nothing of it stays."""
    before = sys.modules.get(name)
    sys.modules[name] = module
    is_new = folder not in sys.path
    if is_new:
        sys.path.insert(0, folder)
    try:
        yield
    finally:
        if before is None:
            del sys.modules[name]
        else:
            sys.modules[name] = before
        if is_new and folder in sys.path:
            sys.path.remove(folder)
