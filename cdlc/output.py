"""Writing results: files whole or not at all."""

import os
import shutil
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from itertools import count
from pathlib import Path


def write_whole(path: Path, content: str | bytes) -> None:
    """Write a file through a neighbour that takes its place, so that no half of it is ever seen.

    Raises OSError.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    temporary = Path(name)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content.encode("utf-8") if isinstance(content, str) else content)
        temporary.chmod(_mode(path))
        temporary.replace(path)
    except BaseException:
        with suppress(OSError):
            temporary.unlink()
        raise


def write_all(files: dict[Path, str]) -> None:
    """Write several files; the first that cannot be written stops the rest. Raises OSError."""
    for path, text in files.items():
        write_whole(path, text)


def write_folder(path: Path, files: Mapping[str, str]) -> Path:
    """Write files, by their names within it, into a new folder that is there whole or not at all.

    A name that is taken gets the first number from 2 that makes it free. Returns the folder.
    Raises OSError.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = Path(tempfile.mkdtemp(dir=path.parent, prefix=f".{path.name}."))
    try:
        for name, text in files.items():
            write_whole(temporary / name, text)
        mask = os.umask(0)
        os.umask(mask)
        temporary.chmod(0o777 & ~mask)
        return _moved(temporary, path)
    except BaseException:
        shutil.rmtree(temporary, ignore_errors=True)
        raise


def _moved(temporary: Path, path: Path) -> Path:
    """A folder moved to the first free name."""
    for number in count(1):
        target = path if number == 1 else path.with_name(f"{path.name}-{number}")
        if not os.path.lexists(target):
            with suppress(FileExistsError):
                return temporary.rename(target)
            # Somebody else was quicker.
    raise AssertionError("names do not run out")


def _mode(path: Path) -> int:
    """The permissions of the file that is replaced, or those a new file gets."""
    with suppress(OSError):
        return path.stat().st_mode & 0o777
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask
