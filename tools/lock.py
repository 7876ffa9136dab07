"""Pin what the extras pull in: `python3 tools/lock.py` writes constraints.txt anew.

The pins are the newest versions that pyproject.toml allows, as an empty environment gets them.
"""

import re
import sys
import tempfile
from pathlib import Path

import environment

EXTRAS = "planners,verify,view,examples,physics,ray,bench,dev"
HEADER = f"""\
# The exact versions installed by the extras {EXTRAS}; tools/environment.py passes them to pip.
# Written by `python3 tools/lock.py`: change the ranges in pyproject.toml and run that.
"""
UNPINNED = ("cdlc", "pip", "setuptools", "wheel")


def main() -> int:
    """Write the pins that the ranges in pyproject.toml resolve to today."""
    try:
        require_oldest_python(environment.ROOT)
        pins = resolve(environment.ROOT)
        (environment.ROOT / "constraints.txt").write_text(HEADER + pins, encoding="utf-8")
    except (environment.SetupError, OSError) as error:
        environment.say(f"error: {error}")
        return 1
    return 0


def require_oldest_python(root: Path) -> None:
    """Refuse a Python for which pip may choose versions that the oldest one cannot install."""
    oldest = environment.project_table(root)["requires-python"].removeprefix(">=")
    if environment.python_version() != oldest:
        raise environment.SetupError(f"run this with Python {oldest}, the oldest supported")


def resolve(root: Path) -> str:
    """Install the project with its extras in a throw-away environment and list what came."""
    with tempfile.TemporaryDirectory() as scratch:
        venv = Path(scratch) / "venv"
        environment.create(venv)
        python = environment.python_of(venv)
        environment.pip(python, root, "install", "--quiet", f".[{EXTRAS}]")
        excluded = [f"--exclude={name}" for name in UNPINNED]
        return pins_of(environment.pip(python, root, "freeze", "--quiet", *excluded))


def pins_of(frozen: str) -> str:
    """Sort the output of `pip freeze`, and refuse what is more than a name and a version."""
    lines = sorted(frozen.splitlines(), key=str.lower)
    for line in lines:
        if not re.fullmatch(r"[\w.-]+==[\w.!+]+", line):
            raise environment.SetupError(f"cannot pin `{line}`")
    return "".join(f"{line}\n" for line in lines)


if __name__ == "__main__":
    sys.exit(main())
