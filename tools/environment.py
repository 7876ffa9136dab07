"""Make the project's virtual environment, `.venv`, or bring it up to date.

    python3 tools/environment.py planners verify view examples physics ray bench dev

installs the project editable, with the extras named, at the versions in constraints.txt. What the
environment was made from is written into it as a stamp, so running this again costs nothing until
pyproject.toml, constraints.txt, the extras wanted or the Python change.
"""

import sys

if sys.version_info < (3, 11):  # noqa: UP036 - it is this file that tells users of an old Python
    # Python compiles the whole file first, so the rest of it has to be syntax of Python 3.6.
    sys.exit(
        "error: cdlc needs Python 3.11 or later, and this is Python {}.{}; "
        "run the same command with a newer one, such as `python3.11`".format(*sys.version_info)
    )

import contextlib
import hashlib
import importlib.util
import json
import os
import shutil
import subprocess
import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

if sys.platform != "win32":
    import fcntl

ROOT = Path(__file__).resolve().parent.parent
INTERRUPTED = 130  # the exit status shells give for Ctrl-C


class SetupError(Exception):
    """The environment cannot be set up; the text says why and what to do."""


class Stamp(NamedTuple):
    """What an environment is made from. (Importing dataclasses would cost the usual run 15 ms.)"""

    root: str
    python: str
    inputs: str
    extras: tuple[str, ...]


def main(arguments: Sequence[str]) -> int:
    """Set `.venv` up with the extras named, separated by spaces or commas."""
    return run(ROOT, " ".join(arguments).replace(",", " ").split())


def run(root: Path, extras: Sequence[str]) -> int:
    """Set up, and turn what can go wrong into a message and an exit status."""
    try:
        ensure(root, extras)
    except (SetupError, OSError) as error:
        say(f"error: {error}")
        return 1
    except KeyboardInterrupt:
        say("interrupted; run it again to finish setting up .venv")
        return INTERRUPTED
    return 0


def ensure(root: Path, extras: Sequence[str]) -> None:
    """Bring `.venv` under `root` to a state that covers `extras`."""
    venv = root / ".venv"
    wanted = stamp_for(root, extras)
    if is_current(venv, wanted):
        return
    reject_unknown(extras, known_extras(root))
    with locked(venv):
        if not is_current(venv, wanted):  # another run may have done it while this one waited
            bring_up_to_date(root, venv, wanted)


def bring_up_to_date(root: Path, venv: Path, wanted: Stamp) -> None:
    """Install what is wanted and what was there before; the stamp is off while that goes on."""
    extras = union(wanted.extras, read_stamp(venv), known_extras(root))
    stamp_path(venv).unlink(missing_ok=True)
    if is_usable(venv):
        say("updating .venv...")
    else:
        say("setting up .venv (the first run takes a minute)...")
        create(venv)
    install(python_of(venv), root, extras)
    write_stamp(venv, stamp_for(root, extras))


# The stamp


def stamp_for(root: Path, extras: Sequence[str]) -> Stamp:
    """Describe the environment that this Python would make of `root` as it is now."""
    inputs = hashlib.sha256()
    for name in ("pyproject.toml", "constraints.txt"):
        inputs.update(hashlib.sha256((root / name).read_bytes()).digest())
    return Stamp(str(root), python_version(), inputs.hexdigest(), tuple(sorted(set(extras))))


def is_current(venv: Path, wanted: Stamp) -> bool:
    """Whether the environment is whole and has at least what is wanted."""
    stamp = read_stamp(venv)
    return (
        stamp is not None
        and (stamp.root, stamp.python, stamp.inputs) == (wanted.root, wanted.python, wanted.inputs)
        and set(wanted.extras) <= set(stamp.extras)
        and os.access(python_of(venv), os.X_OK)
    )


def read_stamp(venv: Path) -> Stamp | None:
    """Return the stamp in the environment; None if there is none, or none that can be read."""
    try:
        fields = json.loads(stamp_path(venv).read_text(encoding="utf-8"))
        return Stamp(**{**fields, "extras": tuple(fields["extras"])})
    except (OSError, ValueError, TypeError, KeyError):
        return None


def write_stamp(venv: Path, stamp: Stamp) -> None:
    """Store the stamp, in one step, so that nobody reads half of it."""
    draft = stamp_path(venv).with_suffix(".new")
    draft.write_text(json.dumps(stamp._asdict(), indent=2) + "\n", encoding="utf-8")
    draft.replace(stamp_path(venv))


def union(wanted: Sequence[str], previous: Stamp | None, known: set[str]) -> list[str]:
    """Return the extras wanted, with those installed before that the project still has."""
    before = set(previous.extras) & known if previous else set()
    return sorted(before | set(wanted))


def stamp_path(venv: Path) -> Path:
    """Where the stamp is."""
    return venv / "setup-stamp.json"


def python_version() -> str:
    """Return this Python's feature version, such as 3.11: patch releases share an environment."""
    return "{}.{}".format(*sys.version_info)


# The extras of the project


def known_extras(root: Path) -> set[str]:
    """Return the extras that pyproject.toml declares."""
    return set(project_table(root).get("optional-dependencies", {}))


def project_table(root: Path) -> dict[str, Any]:
    """Return the table [project] of pyproject.toml."""
    table = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert isinstance(table, dict)
    return table


def reject_unknown(extras: Sequence[str], known: set[str]) -> None:
    """Refuse a misspelt extra, of which pip would only warn."""
    for extra in extras:
        if extra not in known:
            raise SetupError(f"there is no extra `{extra}`; there are: {', '.join(sorted(known))}")


# The environment


def require_venv_module() -> None:
    """Refuse a Python without what makes environments, which Debian puts in its own package."""
    if not (importlib.util.find_spec("venv") and importlib.util.find_spec("ensurepip")):
        raise SetupError(
            f"{sys.executable} lacks the modules venv and ensurepip; "
            "install them (on Debian and Ubuntu: apt install python3-venv)"
        )


def is_usable(venv: Path) -> bool:
    """Whether an environment without a current stamp is one that pip can bring up to date."""
    python = python_of(venv)
    try:
        activate = python.with_name("activate").read_text(encoding="utf-8")
        probe = "import sys, pip; print('{}.{}'.format(*sys.version_info))"
        answer = quietly([python, "-I", "-c", probe])
    except (OSError, ValueError, SetupError):
        return False
    return str(venv) in activate and answer.strip() == python_version()  # and it was not moved


def create(venv: Path) -> None:
    """Make an empty environment in place of whatever is there."""
    require_venv_module()
    import venv as venv_module

    clear(venv)
    # In this process, which may be running from the very files that were just deleted.
    venv_module.create(venv, symlinks=os.name != "nt")
    quietly([python_of(venv), "-I", "-m", "ensurepip", "--default-pip"])


def clear(venv: Path) -> None:
    """Delete all that is in the environment but the lock."""
    venv.mkdir(exist_ok=True)
    for path in venv.iterdir():
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        elif path != lock_path(venv):
            path.unlink()


def install(python: Path, root: Path, extras: Sequence[str]) -> None:
    """Install the project editable with `extras` at the pinned versions."""
    project = f".[{','.join(extras)}]" if extras else "."
    pip(python, root, "install", "--quiet", "-c", "constraints.txt", "-e", project)


def pip(python: Path, cwd: Path, *arguments: str) -> str:
    """Run the environment's pip in `cwd` and return its output."""
    return quietly([python, "-I", "-m", "pip", "--disable-pip-version-check", *arguments], cwd)


def python_of(venv: Path) -> Path:
    """Where the interpreter of an environment is."""
    return venv / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")


# The system


@contextlib.contextmanager
def locked(venv: Path) -> Iterator[None]:
    """Let one run at a time change the environment, where the system has such locks."""
    venv.mkdir(exist_ok=True)
    with lock_path(venv).open("a") as lock:
        if sys.platform != "win32":
            # Programs started here hold the lock too: if this one is killed, its pip runs on.
            os.set_inheritable(lock.fileno(), True)  # noqa: FBT003 - it takes no keyword
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                say("waiting for another run to finish setting up .venv...")
                fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def lock_path(venv: Path) -> Path:
    """Where the lock is: inside, as the project ignores that folder already."""
    return venv / "setup.lock"


def quietly(command: Sequence[str | Path], cwd: Path | None = None) -> str:
    """Run a command and return what it prints; if it fails, that becomes the error."""
    result = subprocess.run(
        command,
        cwd=cwd,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        close_fds=False,
    )
    if result.returncode:
        shown = " ".join(map(str, command))
        raise SetupError(f"`{shown}` exited with status {result.returncode}\n{result.stdout}")
    return result.stdout


def say(message: str) -> None:
    """Tell the user, off the standard output, which belongs to what runs next."""
    print(message.rstrip(), file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
