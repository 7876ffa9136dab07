"""Fast Downward on PDDL texts: how large its translator grounds a task, and what is optimal."""

import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path


@dataclass(frozen=True, slots=True)
class TaskSize:
    """A grounded task: values of its variables, operators, and rules for derived predicates."""

    facts: int
    operators: int
    axioms: int


class TranslatorError(Exception):
    """The translator refused the task; the message is the end of what it printed."""


def task_size(domain: str, problem: str) -> TaskSize:
    """The size that the task of two PDDL texts is grounded to. Raises TranslatorError."""
    command = [sys.executable, "-P", "-m", "fast_downward.translate"]
    done = _run([*command, "domain.pddl", "problem.pddl"], domain, problem)
    if done.returncode != 0:
        raise TranslatorError((done.stdout + done.stderr)[-2000:])
    printed = re.findall(r"^Translator (facts|operators|axioms): (\d+)$", done.stdout, re.MULTILINE)
    counts = dict(printed)
    return TaskSize(*(int(counts[name]) for name in ("facts", "operators", "axioms")))


_UNSUPPORTED = 34
"""The exit code for a heuristic that does not take the task."""


def optimal_cost(domain: str, problem: str, seconds: int, memory: str = "3G") -> int | None:
    """The cost of an optimal plan, by A*; None where it was not found within the limits.

    With LM-cut, or blindly where that heuristic does not take the task.
    """
    script = files("up_fast_downward") / "downward" / "fast-downward.py"
    limits = ["--overall-time-limit", str(seconds), "--overall-memory-limit", memory]
    command = [sys.executable, str(script), *limits, "domain.pddl", "problem.pddl", "--search"]
    done = _run([*command, "astar(lmcut())"], domain, problem)
    if done.returncode == _UNSUPPORTED:
        done = _run([*command, "astar(blind())"], domain, problem)
    found = re.search(r"Plan cost: (\d+)", done.stdout)
    return None if found is None else int(found[1])


def _run(command: list[str], domain: str, problem: str) -> subprocess.CompletedProcess[str]:
    """Run a command beside two PDDL files."""
    with tempfile.TemporaryDirectory(prefix="translator-") as name:
        folder = Path(name)
        (folder / "domain.pddl").write_text(domain, "utf-8")
        (folder / "problem.pddl").write_text(problem, "utf-8")
        return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
