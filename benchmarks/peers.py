"""Other planners, run on PDDL in a process of their own, where they are installed."""

import importlib.util
import resource
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.table import Figure

_FILES = ("domain.pddl", "problem.pddl")
COMMANDS = {
    "pyperplan": ("-m", "pyperplan", "-H", "hff", "-s", "gbf", *_FILES),
    "up_fast_downward": ("{folder}/downward/fast-downward.py", "--alias", "lama-first", *_FILES),
}
"""Packages of planners with what Python is to run; `{folder}` is where the package is."""


def cpu_seconds(name: str, pddl: tuple[str, str], limit: float) -> Figure:
    """CPU seconds of a planner on a task, start-up included; text where it has no plan."""
    found = importlib.util.find_spec(name)
    if found is None or found.origin is None:
        return "not installed"
    command = [part.format(folder=Path(found.origin).parent) for part in COMMANDS[name]]
    with TemporaryDirectory() as folder:
        for file, text in zip(("domain.pddl", "problem.pddl"), pddl, strict=True):
            (Path(folder) / file).write_text(text, "utf-8")
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        try:
            done = subprocess.run(
                [sys.executable, *command],
                cwd=folder, check=False, capture_output=True, timeout=limit,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            return f"none in {limit:.0f} s"
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        return f"failed: {done.returncode}"
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
